/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The simulated lidar on the stand-in's Serial1, in virtual time; the judge keeps its points. A
 * test program includes this once. */

#ifndef VIRTUAL_LIDAR_H
#define VIRTUAL_LIDAR_H

#include <Arduino.h>

#include <vector>

extern "C" {
#include "sim_judge.h"
}

unsigned long arduino_millis;
HardwareSerial Serial;
SerialPort Serial1;
SerialPort Serial2;
uint8_t arduino_pins[64];

class VirtualLidar
{
  public:
    VirtualLidar()
    {
        sim_observer_t observer = sim_observer_t();
        const sim_config_t config = sim_default_config();
        observer.context = this;
        observer.on_packet = notePacket;
        sim_judge_begin(&judge);
        sim_init(&sim, &config);
        sim_observe(&sim, &observer);
    }

    /* Lets a millisecond pass: bytes are transferred in both directions. */
    void pass()
    {
        uint8_t byte = 0;
        nowUs += 1000;
        arduino_millis++;
        for (; !Serial1.sent.empty(); Serial1.sent.pop_front()) {
            byte = Serial1.sent.front();
            sim_receive(&sim, &byte, 1, nowUs);
        }
        while (sim_transmit(&sim, nowUs, &byte, 1) > 0) {
            if (isPlugged) {
                Serial1.take(byte);
            }
        }
    }

    /* An obstacle 10 degrees wide, in front or at another angle. */
    void placeObstacle(uint16_t distance_mm, uint16_t angle_q6 = 0)
    {
        sim_place_obstacle(&sim, angle_q6, 640, distance_mm);
    }

    /* What has been sent: points from one of them on, all points of a revolution. */
    std::vector<reference_point_t> points(size_t from, size_t count)
    {
        std::vector<reference_point_t> sent;
        for (size_t place = from; place < from + count; place++) {
            sent.push_back(sim_judge_sample(&judge, place)->point);
        }
        return sent;
    }

    std::vector<reference_point_t> revolution(uint32_t number)
    {
        std::vector<reference_point_t> sent;
        for (uint32_t place = 0; place < judge.sent; place++) {
            if (sim_judge_sample(&judge, place)->turn == number) {
                sent.push_back(sim_judge_sample(&judge, place)->point);
            }
        }
        return sent;
    }

    sim_t sim;
    sim_judge_t judge;
    bool isPlugged = true;

  private:
    static void notePacket(void *context, const sim_packet_t *packet)
    {
        sim_judge_sent(&static_cast<VirtualLidar *>(context)->judge, packet);
    }

    uint64_t nowUs = 0;
};

#endif

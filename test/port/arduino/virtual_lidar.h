/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The simulated lidar on the stand-in's Serial1, in virtual time, with a record of its points. A
 * test program includes this once. */

#ifndef VIRTUAL_LIDAR_H
#define VIRTUAL_LIDAR_H

#include <Arduino.h>

#include <map>
#include <vector>

extern "C" {
#include "reference_decoder.h"
#include "simulator.h"
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

    sim_t sim;
    bool isPlugged = true;

    /* Points by revolution and by packet. */
    std::map<uint32_t, std::vector<reference_point_t>> revolutions;
    std::vector<std::vector<reference_point_t>> packets;

  private:
    static void notePacket(void *context, const sim_packet_t *packet)
    {
        VirtualLidar *const self = static_cast<VirtualLidar *>(context);
        const unsigned count = packet->bytes[3]; /* LSN */
        std::vector<reference_point_t> points;
        for (unsigned i = 0; i < count; i++) {
            points.push_back(reference_point(packet->bytes, i));
        }
        self->packets.push_back(points);
        std::vector<reference_point_t> &revolution = self->revolutions[packet->revolution];
        revolution.insert(revolution.end(), points.begin(), points.end());
    }

    uint64_t nowUs = 0;
};

#endif

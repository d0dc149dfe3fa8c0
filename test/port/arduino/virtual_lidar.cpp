/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "virtual_lidar.h"

unsigned long arduino_millis;
HardwareSerial Serial;
SerialPort Serial1;
SerialPort Serial2;
uint8_t arduino_pins[64];

VirtualLidar::VirtualLidar() : now_us_(0), plugged_(true)
{
    sim_observer_t observer = sim_observer_t();
    const sim_config_t config = sim_default_config();
    observer.context = this;
    observer.on_packet = notePacket;
    sim_init(&sim_, &config);
    sim_observe(&sim_, &observer);
}

void VirtualLidar::notePacket(void *context, const sim_packet_t *packet)
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

void VirtualLidar::pass()
{
    uint8_t bytes[64];
    size_t count = 0;
    now_us_ += 1000;
    arduino_millis++;
    for (; !Serial1.sent.empty(); Serial1.sent.pop_front()) {
        const uint8_t byte = Serial1.sent.front();
        sim_receive(&sim_, &byte, 1, now_us_);
    }
    while ((count = sim_transmit(&sim_, now_us_, bytes, sizeof bytes)) > 0) {
        for (size_t i = 0; i < count && plugged_; i++) {
            Serial1.take(bytes[i]);
        }
    }
}

void VirtualLidar::unplug()
{
    plugged_ = false;
}

void VirtualLidar::placeObstacle(uint16_t distance_mm, uint16_t angle_q6)
{
    sim_place_obstacle(&sim_, angle_q6, 640, distance_mm);
}

void VirtualLidar::clearObstacles()
{
    sim_clear_obstacles(&sim_);
}

void VirtualLidar::setHealth(uint8_t bits)
{
    sim_set_health(&sim_, bits);
}

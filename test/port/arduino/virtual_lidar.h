/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The simulated lidar on the stand-in's Serial1, in virtual time, with a record of its points. */

#ifndef VIRTUAL_LIDAR_H
#define VIRTUAL_LIDAR_H

#include <Arduino.h>

#include <map>
#include <vector>

extern "C" {
#include "reference_decoder.h"
#include "simulator.h"
}

class VirtualLidar
{
  public:
    VirtualLidar();
    /* Lets a millisecond pass: bytes are transferred in both directions. */
    void pass();
    /* After this call no byte arrives. */
    void unplug();
    /* An obstacle 10 degrees wide, in front or at another angle. */
    void placeObstacle(uint16_t distance_mm, uint16_t angle_q6 = 0);
    void clearObstacles();
    /* The lidar reports these faults (section 4), but still measures. */
    void setHealth(uint8_t bits);

    /* Points by revolution and by packet. */
    std::map<uint32_t, std::vector<reference_point_t>> revolutions;
    std::vector<std::vector<reference_point_t>> packets;

  private:
    static void notePacket(void *context, const sim_packet_t *packet);
    sim_t sim_;
    uint64_t now_us_;
    bool plugged_;
};

#endif

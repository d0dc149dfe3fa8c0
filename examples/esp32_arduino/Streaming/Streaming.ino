/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Boards with little RAM, such as the Arduino Mega 2560: packet by packet, nothing is kept but the
 * nearest distance of the revolution. Lidar on Serial1; what 16 MHz boards can and cannot do with
 * it is in README.md, one folder up. */

#include <TMiniLidar.h>

static TMiniLidarStreaming lidar;
static uint16_t nearest; /* Of the revolution under way; 0: nothing yet. */

static void endRevolution()
{
    Serial.println(nearest);
    nearest = 0;
}

static void lookAtPacket()
{
    if (tmini_packet_is_start(tmini_packet(lidar.driver()))) {
        endRevolution();
    }
    for (TMiniPoint point : lidar.points()) {
        if (point.isValid() && (nearest == 0 || point.distanceMm() < nearest)) {
            nearest = point.distanceMm();
        }
    }
}

void setup()
{
    Serial.begin(115200);
    lidar.begin(Serial1);
    lidar.start();
}

void loop()
{
    while (tmini_event_t event = lidar.loop()) {
        if (event == TMINI_EVENT_PACKET) {
            lookAtPacket();
        }
    }
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Boards with little RAM, from an Arduino Mega 2560 on: takes packet by packet, and keeps only the
 * nearest distance of the revolution, which it prints at the end. Lidar on Serial1. README.md, one
 * folder up, explains what is possible with 16 MHz. */

#include <TMiniLidar.h>
#include <TMiniPins.h>

static TMiniLidarStreaming lidar;
static unsigned scans;
static unsigned complete; /* How many of the scans were complete. */
static uint16_t nearest;  /* Of the current revolution; 0: nothing yet. */
static bool whole;        /* Nothing of the current revolution has been lost. */

static void print()
{
    Serial.print(scans);
    Serial.print(" scans, ");
    Serial.print(complete);
    Serial.print(" complete, nearest ");
    Serial.print(nearest);
    Serial.println(" mm");
}

/* Packets before the first start packet are not a revolution. */
static void endRevolution()
{
    static bool begun;
    if (begun) {
        scans++;
        complete += whole ? 1 : 0;
        print();
    }
    begun = true;
    whole = true;
    nearest = 0;
}

static void lookAtPacket()
{
    if (lidar.packet().gap > 1) { /* One byte may be LastCRC, which ends a revolution. */
        whole = false;
    }
    if (tmini_packet_is_start(&lidar.packet())) {
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
    lidar.begin(TMINI_SERIAL1);
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

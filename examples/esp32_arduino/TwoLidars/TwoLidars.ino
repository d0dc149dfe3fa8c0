/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Two lidars, on Serial1 and Serial2: takes each packet as it comes, and once a second prints the
 * nearest thing that each has seen. Boards with three serial ports, from an Arduino Mega 2560
 * on. */

#include <TMiniLidar.h>
#include <TMiniPins.h>

struct Unit {
    TMiniLidarStreaming lidar;
    unsigned scans;
    unsigned complete;
    uint16_t nearest; /* Of the current revolution; 0: nothing yet. */
    uint16_t last;    /* Of the previous revolution. */
    bool begun;
    bool whole;
};

static Unit left;
static Unit right;

static void endRevolution(Unit &unit)
{
    if (unit.begun) {
        unit.scans++;
        unit.complete += unit.whole ? 1 : 0;
        unit.last = unit.nearest;
    }
    unit.begun = true;
    unit.whole = true;
    unit.nearest = 0;
}

static void lookAtPacket(Unit &unit, Unit &other)
{
    uint8_t done = 0;
    if (unit.lidar.packet().gap > 1) {
        unit.whole = false;
    }
    if (tmini_packet_is_start(&unit.lidar.packet())) {
        endRevolution(unit);
    }
    for (TMiniPoint point : unit.lidar.points()) {
        if (point.isValid() && (unit.nearest == 0 || point.distanceMm() < unit.nearest)) {
            unit.nearest = point.distanceMm();
        }
        if (++done % 8 == 0) {
            other.lidar.receive(); /* Otherwise its buffer would overflow. */
        }
    }
}

/* Handles one event at a time, so that neither lidar waits for the other. */
static void work(Unit &unit, Unit &other)
{
    const tmini_event_t event = unit.lidar.loop();
    other.lidar.receive();
    if (event == TMINI_EVENT_PACKET) {
        lookAtPacket(unit, other);
    }
}

/* Printing a whole line at once would take half the time that the buffers last. */
static void print(unsigned number, const char *text)
{
    Serial.print(number);
    Serial.print(text);
    left.lidar.receive();
    right.lidar.receive();
}

static void report()
{
    static unsigned long reportedMs;
    if (millis() - reportedMs < 1000) {
        return;
    }
    reportedMs = millis();
    print(left.scans + right.scans, " scans, ");
    print(left.complete + right.complete, " complete, nearest ");
    print(left.last, " and ");
    print(right.last, " mm\r\n");
}

void setup()
{
    Serial.begin(115200);
    left.lidar.begin(TMINI_SERIAL1);
    right.lidar.begin(TMINI_SERIAL2);
    left.lidar.start();
    right.lidar.start();
}

void loop()
{
    work(left, right);
    work(right, left);
    report();
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Whole revolutions from a T-mini Plus on Serial1. Once a second, prints the nearest thing in
 * front, and STOP if it is nearer than STOP_MM or the lidar sees nothing. Any board with 8 KB of
 * RAM and a second serial port, from an Arduino Mega 2560 on; wiring: README.md, one folder up. */

#include <TMiniLidar.h>
#include <TMiniPins.h>

static const uint16_t STOP_MM = 400;
static const uint16_t FRONT_Q6 = 30 * 64;  /* To either side of 0 degrees, in 1/64 degree. */
static const unsigned long BLIND_MS = 500; /* Without a complete scan for this long, stop. */

static TMiniLidar lidar;
static unsigned scans;
static unsigned complete; /* How many of the scans were complete. */
static uint16_t nearest;     /* The nearest thing in front, in the last usable scan; 0: none. */
static unsigned long seenMs; /* When a complete scan came. */
static bool seen;

/* Integers, because an AVR needs ten microseconds per float: ten milliseconds per scan. */
static bool isInFront(const TMiniPoint &point)
{
    return point.angle_q6 <= FRONT_Q6 || point.angle_q6 >= TMINI_FULL_CIRCLE_Q6 - FRONT_Q6;
}

static bool isNear(uint16_t distance)
{
    return distance != 0 && distance < STOP_MM;
}

/* A scan with gaps may have missed an obstacle, and one without any range has seen nothing: they
 * can stop the robot, but not release it. */
static void lookAhead()
{
    uint16_t ahead = 0;
    bool any = false;
    scans++;
    for (TMiniPoint point : lidar.points()) {
        any = any || point.isValid();
        if (point.isValid() && isInFront(point) && (ahead == 0 || point.distanceMm() < ahead)) {
            ahead = point.distanceMm();
        }
    }
    const bool sees = any && lidar.scan().complete;
    if (sees || isNear(ahead)) {
        nearest = ahead;
    }
    if (sees) {
        complete++;
        seenMs = millis();
        seen = true;
    }
}

static bool isBlind()
{
    return !seen || millis() - seenMs >= BLIND_MS || !lidar.isScanning() || lidar.faults() != 0;
}

static void handle(tmini_event_t event)
{
    switch (event) {
    case TMINI_EVENT_SCAN:
        lookAhead();
        break;
    case TMINI_EVENT_INFO:
        Serial.print("lidar model ");
        Serial.println(lidar.info().model);
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        Serial.print("lidar faults ");
        Serial.println(lidar.faults());
        break;
    case TMINI_EVENT_COMMAND_FAILED:
        Serial.print("no lidar: ");
        Serial.println(lidar.error());
        break;
    default:
        break;
    }
}

static void report()
{
    static unsigned long reported;
    if (millis() - reported < 1000) {
        return;
    }
    reported = millis();
    Serial.print(scans);
    Serial.print(" scans, ");
    Serial.print(complete);
    if (isBlind()) {
        Serial.println(" complete, blind: STOP");
        return;
    }
    Serial.print(" complete, nearest in front ");
    Serial.print(nearest);
    Serial.println(isNear(nearest) ? " mm: STOP" : " mm");
}

void setup()
{
    Serial.begin(115200);
    lidar.begin(TMINI_SERIAL1); /* Serial1; on an ESP32 with its pins. */
    lidar.requestInfo();
    lidar.start(); /* After the answer; holds until stop(). */
}

void loop()
{
    while (tmini_event_t event = lidar.loop()) {
        handle(event);
    }
    report();
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ESP32: whole revolutions from a T-mini Plus. Once a second a line with the nearest thing in front,
 * and STOP when it is nearer than STOP_MM, or when the lidar sees nothing. Wiring: README.md, one
 * folder up. */

#include <TMiniLidar.h>

static const int8_t RX_PIN = 26; /* To the lidar's TX. */
static const int8_t TX_PIN = 27; /* To the lidar's RX. */
static const uint16_t STOP_MM = 400;
static const float FRONT_DEGREES = 30.0f;  /* To either side of 0 degrees. */
static const unsigned long BLIND_MS = 500; /* Without a complete scan for so long, stop. */

static TMiniLidar lidar;
static unsigned scans;
static uint16_t nearest;     /* In front, in the last scan that could tell; 0: nothing. */
static unsigned long seenMs; /* When a complete scan came. */
static bool seen;

static bool isInFront(const TMiniPoint &point)
{
    return point.angleDegrees() <= FRONT_DEGREES || point.angleDegrees() >= 360.0f - FRONT_DEGREES;
}

static bool isNear(uint16_t distance)
{
    return distance != 0 && distance < STOP_MM;
}

/* A scan with gaps may have missed what is in front, and one without any range has seen nothing: they
 * can stop, but do not let go on. */
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
    const bool complete = any && tmini_scan(lidar.driver())->complete;
    if (complete || isNear(ahead)) {
        nearest = ahead;
    }
    if (complete) {
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
        lidar.start();
        break;
    case TMINI_EVENT_FAULT:
        Serial.print("lidar faults ");
        Serial.println(lidar.faults());
        break;
    case TMINI_EVENT_FAILED:
        Serial.print("no lidar: ");
        Serial.println(lidar.error());
        lidar.start(); /* Tried again until there is one. */
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
    if (isBlind()) {
        Serial.println(" scans, blind: STOP");
        return;
    }
    Serial.print(" scans, nearest in front ");
    Serial.print(nearest);
    Serial.println(isNear(nearest) ? " mm: STOP" : " mm");
}

void setup()
{
    Serial.begin(115200);
    lidar.begin(Serial1, RX_PIN, TX_PIN);
    lidar.requestInfo();
}

void loop()
{
    while (tmini_event_t event = lidar.loop()) {
        handle(event);
    }
    report();
}

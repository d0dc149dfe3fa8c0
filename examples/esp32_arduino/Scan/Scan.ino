/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ESP32: whole revolutions from a T-mini Plus. Once a second a line with the nearest thing in front,
 * and the built-in warning when it is nearer than STOP_MM. Wiring: README.md, one folder up. */

#include <TMiniLidar.h>

static const int8_t RX_PIN = 26; /* To the lidar's TX. */
static const int8_t TX_PIN = 27; /* To the lidar's RX. */
static const uint16_t STOP_MM = 400;
static const float FRONT_DEGREES = 30.0f; /* To either side of 0 degrees. */

static TMiniLidar lidar;
static unsigned scans;
static uint16_t nearest; /* In front, in the last scan; 0: nothing. */

static bool isInFront(const TMiniPoint &point)
{
    return point.angleDegrees() <= FRONT_DEGREES || point.angleDegrees() >= 360.0f - FRONT_DEGREES;
}

static void lookAhead()
{
    nearest = 0;
    for (TMiniPoint point : lidar.points()) {
        if (point.isValid() && isInFront(point) && (nearest == 0 || point.distanceMm() < nearest)) {
            nearest = point.distanceMm();
        }
    }
    scans++;
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
    Serial.print(" scans, nearest in front ");
    Serial.print(nearest);
    Serial.println(nearest != 0 && nearest < STOP_MM ? " mm: STOP" : " mm");
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

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A sketch that pauses for PAUSE_US in each loop(). */

#include <TMiniLidar.h>

static TMiniLidar lidar;
static unsigned scans;
static unsigned complete;

static void report()
{
    static unsigned long reportedMs;
    if (millis() - reportedMs >= 1000) {
        reportedMs = millis();
        Serial.print(scans);
        Serial.print(" scans, ");
        Serial.print(complete);
        Serial.println(" complete");
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
    while (lidar.loop()) {
        if (lidar.available()) {
            scans++;
            complete += lidar.scan().complete ? 1 : 0;
        }
    }
    report();
    delayMicroseconds(PAUSE_US);
}

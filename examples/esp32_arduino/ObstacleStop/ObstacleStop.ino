/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A robot that must not hit anything. Its lidar is mounted upside down, turns at 10 Hz, and sees a
 * mast at the back. STOP_PIN is high unless the way ahead is seen and free. Lidar on Serial1; any
 * board with 8 KB of RAM, from an Arduino Mega 2560 on. */

#include <TMiniLidar.h>
#include <tmini/tmini_sectors.h>

static const uint8_t STOP_PIN = LED_BUILTIN;
static const uint16_t STOP_MM = 300;
static const uint16_t GO_MM = 350;         /* More than STOP_MM, to avoid stop and go. */
static const unsigned long BLIND_MS = 400; /* Without a complete scan for this long, stop. */

/* Angles are the robot's: 0 is its front, clockwise. */
static const tmini_arc_t MASTS[] = {{170, 190}};
static const tmini_mount_t MOUNT = {
    .front_q6 = 0,
    .upside_down = true,
    .offset_mm = 0,
    .min_mm = 60, /* The robot's own edge. */
    .max_mm = 0,
    .masked = MASTS,
    .masked_count = 1,
};

/* 10 Hz: 400 points per revolution. */
static TMiniLidarWith<1024, 450> lidar;
static tmini_sector_t sector[8]; /* 0 ahead, 2 right, 4 back, 6 left. */
static tmini_sectors_t sectors;
static unsigned scans;
static unsigned complete;
static bool isFree;          /* As of the last scans. */
static unsigned long seenMs; /* When a complete scan ended. */

/* A scan with gaps may have missed an obstacle: it can stop the robot, but not release it. */
static void lookAhead()
{
    tmini_sectors_clear(&sectors);
    for (TMiniPoint point : lidar.points()) { /* Receives meanwhile; tmini_sectors_add_scan() would
                                               * not. */
        tmini_sectors_add(&sectors, &point);
    }
    scans++;
    if (!tmini_sector_is_free(&sector[0], STOP_MM)) { /* True also if the sector is blind. */
        isFree = false;
    } else if (lidar.scan().complete && tmini_sector_is_free(&sector[0], GO_MM)) {
        isFree = true;
    }
    if (lidar.scan().complete) {
        complete++;
        seenMs = lidar.scan().end_ms;
    }
}

/* A lidar that is lost or faulty sees nothing, whatever the last scans showed. */
static bool mustStop()
{
    if (!lidar.isScanning() || lidar.faults() != 0 || millis() - seenMs >= BLIND_MS) {
        isFree = false;
    }
    return !isFree;
}

static void report()
{
    static unsigned long reportedMs;
    if (millis() - reportedMs < 1000) {
        return;
    }
    reportedMs = millis();
    Serial.print(scans);
    Serial.print(" scans, ");
    Serial.print(complete);
    Serial.print(" complete, ahead ");
    Serial.print(sector[0].nearest_mm);
    Serial.println(isFree ? " mm: go" : " mm: STOP");
}

void setup()
{
    digitalWrite(STOP_PIN, HIGH); /* Set before the pin is an output, because low means go. */
    pinMode(STOP_PIN, OUTPUT);
    Serial.begin(115200);
    lidar.setMount(MOUNT);
    /* On an ESP32 begin() needs pins, as in Scan. */
    if (!lidar.begin(Serial1, 10) || tmini_sectors_init(&sectors, sector, 8, 0) != TMINI_OK) {
        Serial.println(lidar.error());
        return;
    }
    lidar.start(); /* Holds until stop(), also after a power failure. */
}

void loop()
{
    while (lidar.loop()) {
        if (lidar.available()) {
            lookAhead();
        }
    }
    digitalWrite(STOP_PIN, mustStop() ? HIGH : LOW);
    report();
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* This is no safety function: where people can be hurt, use a certified scanner or a bumper.
 *
 * A robot that must not hit anything. Its lidar is mounted upside down, turns at 10 Hz, and sees a
 * mast at the back. STOP_PIN is high unless the field before it is seen and free. Lidar on Serial1;
 * any board with 8 KB of RAM, from an Arduino Mega 2560 on. */

#include <TMiniLidar.h>
#include <TMiniPins.h>
#include <tmini/tmini_fields.h>

#if defined(LED_BUILTIN)
static const uint8_t STOP_PIN = LED_BUILTIN;
#else
static const uint8_t STOP_PIN = 2; /* "ESP32 Dev Module" names no LED; many have it here. */
#endif

/* The box that stops it, in mm: x ahead, y to the left. */
static const tmini_xy_t BOX[] = {{0, -150}, {300, 150}};

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
static tmini_field_t field;
static tmini_fields_t fields;
static unsigned scans;
static unsigned complete;

/* A scan with gaps may have missed an obstacle: it can stop the robot, but not release it. */
static void lookAhead()
{
    tmini_fields_begin(&fields);
    for (TMiniPoint point : lidar.points()) { /* Receives meanwhile; tmini_fields_add_scan() would
                                               * not. */
        tmini_fields_add(&fields, &point);
    }
    tmini_fields_end(&fields, lidar.scan().complete, lidar.scan().end_ms);
    scans++;
    complete += lidar.scan().complete ? 1 : 0;
}

/* A lidar that is faulty sees nothing, whatever the last scans showed. One that is lost ages. */
static bool mustStop()
{
    if (lidar.faults() != 0) {
        tmini_fields_clear(&fields);
    }
    return tmini_field_state(&field, millis()) != TMINI_FIELD_FREE;
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
    Serial.print(" complete, in the box ");
    Serial.print(field.inside);
    Serial.println(mustStop() ? ": STOP" : ": go");
}

void setup()
{
    digitalWrite(STOP_PIN, HIGH); /* Set before the pin is an output, because low means go. */
    pinMode(STOP_PIN, OUTPUT);
    Serial.begin(115200);
    field.corners = BOX;
    field.corner_count = 2; /* Three turns at 10 Hz without a scan: it is blind. */
    fields.list = &field;
    fields.count = 1;
    lidar.setMount(MOUNT);
    if (!lidar.begin(TMINI_SERIAL1, 10) || tmini_fields_init(&fields) != TMINI_OK) {
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

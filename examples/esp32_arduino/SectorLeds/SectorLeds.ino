/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* LEDs in a ring, eight on most boards, each on while something in its direction is nearer than a
 * metre, or while its direction is unknown. Packet by packet, in 1.5 KB of RAM; lidar on Serial1;
 * from an Arduino Mega 2560 on. */

#include <TMiniLidar.h>
#include <TMiniPins.h>
#include <tmini/tmini_sectors.h>

static const uint8_t PINS[] = {TMINI_LED_PINS}; /* Clockwise from the front. */
static const uint8_t LEDS = sizeof PINS;
static const uint16_t NEAR_MM = 1000;

static TMiniLidarStreaming lidar;
static tmini_sector_t sector[LEDS];
static tmini_sectors_t sectors;
static unsigned scans;
static unsigned complete;
static bool begun; /* A start packet has come. */
static bool whole;

static void endRevolution()
{
    for (uint8_t i = 0; i < LEDS; i++) {
        digitalWrite(PINS[i], tmini_sector_is_free(&sector[i], NEAR_MM) ? LOW : HIGH);
    }
    scans += begun ? 1 : 0;
    complete += begun && whole ? 1 : 0;
    begun = true;
    whole = true;
    tmini_sectors_clear(&sectors);
}

/* A lidar that is lost or faulty sees nothing. */
static void showNothing()
{
    for (uint8_t i = 0; i < LEDS; i++) {
        digitalWrite(PINS[i], HIGH);
    }
}

static void lookAtPacket()
{
    if (lidar.packet().gap > 1) { /* One byte may be LastCRC, which ends a revolution. */
        whole = false;
    }
    if (tmini_packet_is_start(&lidar.packet())) {
        endRevolution();
    }
    for (TMiniPoint point : lidar.points()) { /* This loop also receives. */
        tmini_sectors_add(&sectors, &point);
    }
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
    Serial.println(" complete");
}

void setup()
{
    for (uint8_t i = 0; i < LEDS; i++) {
        pinMode(PINS[i], OUTPUT);
    }
    showNothing();
    Serial.begin(115200);
    if (tmini_sectors_init(&sectors, sector, LEDS, 0) != TMINI_OK || !lidar.begin(TMINI_SERIAL1)) {
        Serial.println(lidar.error());
        return;
    }
    lidar.start();
}

void loop()
{
    while (tmini_event_t event = lidar.loop()) {
        if (event == TMINI_EVENT_PACKET) {
            lookAtPacket();
        }
    }
    if (!lidar.isScanning() || lidar.faults() != 0) {
        showNothing();
    }
    report();
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A sketch's surroundings: what Arduino's core does around setup() and loop(), for a while. */

#include <Arduino.h>

unsigned long arduino_millis;
HardwareSerial Serial;
HardwareSerial Serial1;

void setup();
void loop();

int main()
{
    setup();
    for (int i = 0; i < 5000; i++) {
        arduino_millis++;
        loop();
    }
    return Serial1.sent.empty() ? 1 : 0; /* The sketch has asked its lidar for something. */
}

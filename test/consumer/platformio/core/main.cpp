/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Does what Arduino's core does: calls setup(), and then loop(), but only for a while. */

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
    return Serial1.sent.empty() ? 1 : 0; /* The sketch must have sent a command to its lidar. */
}

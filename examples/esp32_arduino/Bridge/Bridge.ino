/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The board as the lidar's USB adapter: it forwards every byte, in both directions. Then run `tmini
 * check -p PORT` or `tmini view -p PORT` on the computer to check the lidar, its supply and its
 * wiring. Lidar on Serial1; any board with a second serial port, from an Arduino Mega 2560 on. */

static const unsigned long BAUD_RATE = 230400;

static void forward(Stream &from, Stream &to)
{
    while (from.available() > 0 && to.availableForWrite() > 0) {
        to.write(static_cast<uint8_t>(from.read()));
    }
}

void setup()
{
    Serial.begin(BAUD_RATE);
    Serial1.begin(BAUD_RATE);
}

void loop()
{
    forward(Serial1, Serial);
    forward(Serial, Serial1);
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The board as the lidar's USB adapter: it forwards every byte, in both directions. Then run `tmini
 * check -p PORT` or `tmini view -p PORT` on the computer to check the lidar, its supply and its
 * wiring. Lidar on Serial1; any board with a second serial port, from an Arduino Mega 2560 on. */

#include <TMiniPins.h>

static const unsigned long BAUD_RATE = 230400;

/* Only what has come before, so that the other direction has its turn. write() waits for room; how
 * much there is, not every board can say. */
static void forward(Stream &from, Stream &to)
{
    for (int count = from.available(); count > 0; count--) {
        to.write(static_cast<uint8_t>(from.read()));
    }
}

void setup()
{
    Serial.begin(BAUD_RATE);
#if defined(ESP32)
    Serial1.begin(BAUD_RATE, SERIAL_8N1, TMINI_RX1_PIN, TMINI_TX1_PIN);
#else
    Serial1.begin(BAUD_RATE);
#endif
}

void loop()
{
    forward(Serial1, Serial);
    forward(Serial, Serial1);
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Build systems that know frameworks beside Arduino compile this file for all of them. */
#if defined(ARDUINO)

#include "TMiniLidar.h"

#include "tmini/tmini_names.h"

/* The protocol's section 1. */
static const unsigned long BAUD_RATE = 230400;

#if defined(ESP32) || defined(ESP8266) || TMINI_LIDAR_ON_RP2040
/* The core's own receive buffer: 44 ms of a busy line, instead of 11 with 256 bytes, or 1 with
 * 32. */
static const size_t SERIAL_RX_SIZE = 1024;
#endif

/* Where the core's receive buffer can be chosen, that is before the port is opened. On the ESP32 an
 * open port refuses: closing it here would lose the pins that the sketch may have chosen. */
static void enlarge(TMiniSerial &serial)
{
#if defined(ESP32) || defined(ESP8266)
    serial.setRxBufferSize(SERIAL_RX_SIZE);
#elif TMINI_LIDAR_ON_RP2040
    serial.end(); /* If the sketch has opened it: refused then. */
    serial.setFIFOSize(SERIAL_RX_SIZE);
#else
    (void)serial;
#endif
}

/* Where the UART's FIFO interrupts at a level that can be chosen, that is after the port is opened.
 * Of 128 bytes the core leaves 8 for delays, 0.35 ms; this half of them. */
static void quicken(TMiniSerial &serial)
{
#if defined(ESP_ARDUINO_VERSION_MAJOR) && ESP_ARDUINO_VERSION_MAJOR >= 3
    serial.setRxFIFOFull(64);
#else
    (void)serial;
#endif
}

static bool isOpen(TMiniSerial &serial)
{
#if defined(ESP32)
    return static_cast<bool>(serial); /* Not without memory, for one. */
#else
    (void)serial;
    return true;
#endif
}

const tmini_port_t TMiniLidarBase::port_ = {writeBytes, nowMs, NULL, NULL};

TMiniPoint TMiniPoints::operator[](size_t index) const
{
    TMiniPoint point;
    static_cast<tmini_point_t &>(point) = tmini_point_t();
    if (scan_ != NULL) {
        static_cast<tmini_point_t &>(point) = scan_[index];
    } else {
        tmini_packet_point(packet_, index, &point);
    }
    return point;
}

TMiniLidarBase::TMiniLidarBase(uint8_t *rx, size_t rxSize, tmini_point_t *points, size_t maxPoints)
    : lidar_(), config_(), serial_(NULL), event_(TMINI_EVENT_NONE)
{
    config_.port = &port_;
    config_.port_context = this;
    config_.rx_buffer = rx;
    config_.rx_size = rxSize;
    config_.points = points;
    config_.max_points = maxPoints;
}

/* Two bytes always fit in the core's transmit buffer: nothing else is ever sent. */
int TMiniLidarBase::writeBytes(void *context, const uint8_t *bytes, size_t count)
{
    Stream *const serial = static_cast<TMiniLidarBase *>(context)->serial_;
    return static_cast<int>(serial->write(bytes, count));
}

uint32_t TMiniLidarBase::nowMs(void *)
{
    return static_cast<uint32_t>(millis());
}

bool TMiniLidarBase::listen(Stream &serial)
{
    serial_ = &serial;
    event_ = TMINI_EVENT_NONE;
    return tmini_init(&lidar_, &config_) == TMINI_OK;
}

bool TMiniLidarBase::begin(Stream &serial)
{
    return listen(serial);
}

bool TMiniLidarBase::begin(TMiniSerial &serial)
{
    enlarge(serial);
    serial.begin(BAUD_RATE);
    quicken(serial);
    return isOpen(serial) && listen(serial);
}

#if defined(ESP32)
bool TMiniLidarBase::begin(TMiniSerial &serial, int8_t rxPin, int8_t txPin)
{
    if (isOpen(serial)) {
        serial.end(); /* Open, it would keep its buffer. */
    }
    enlarge(serial);
    serial.begin(BAUD_RATE, SERIAL_8N1, rxPin, txPin);
    quicken(serial);
    return isOpen(serial) && listen(serial);
}
#elif TMINI_LIDAR_ON_RP2040
bool TMiniLidarBase::begin(TMiniSerial &serial, int8_t rxPin, int8_t txPin)
{
    serial.end(); /* Open, it would keep its pins. */
    return serial.setRX(static_cast<pin_size_t>(rxPin)) &&
           serial.setTX(static_cast<pin_size_t>(txPin)) && begin(serial);
}
#endif

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Only what is there is asked for, so that readBytes() has nothing to wait for; and only what the
 * lidar's ring has room for: the rest waits in the core's buffer. */
size_t TMiniLidarBase::receivable()
{
    const int waiting = serial_->available();
    return smaller(waiting > 0 ? static_cast<size_t>(waiting) : 0, tmini_feed_room(&lidar_));
}

bool TMiniLidarBase::receive()
{
    uint8_t chunk[64];
    size_t left = receivable();
    while (left > 0) {
        const size_t count = serial_->readBytes(chunk, smaller(left, sizeof chunk));
        if (count == 0) {
            return false;
        }
        tmini_feed(&lidar_, chunk, count);
        left -= count;
    }
    return true;
}

/* Polling makes room: nothing has happened only when nothing is left that could be received. */
tmini_event_t TMiniLidarBase::loop()
{
    event_ = TMINI_EVENT_NONE;
    bool can_receive = serial_ != NULL;
    while (can_receive && event_ == TMINI_EVENT_NONE) {
        can_receive = receive();
        event_ = tmini_poll(&lidar_);
        can_receive = can_receive && receivable() > 0;
    }
    return event_;
}

size_t TMiniLidarBase::available() const
{
    switch (event_) {
    case TMINI_EVENT_SCAN:
        return tmini_scan(&lidar_)->count;
    case TMINI_EVENT_PACKET:
        return tmini_packet(&lidar_)->count;
    default:
        return 0;
    }
}

TMiniPoints TMiniLidarBase::points() const
{
    const tmini_point_t *const scan =
        event_ == TMINI_EVENT_SCAN ? tmini_scan(&lidar_)->points : NULL;
    return TMiniPoints(scan, tmini_packet(&lidar_), available());
}

bool TMiniLidarBase::start()
{
    return tmini_start(&lidar_) == TMINI_OK;
}

bool TMiniLidarBase::stop()
{
    return tmini_stop(&lidar_) == TMINI_OK;
}

bool TMiniLidarBase::requestInfo()
{
    return tmini_request_info(&lidar_) == TMINI_OK;
}

bool TMiniLidarBase::requestHealth()
{
    return tmini_request_health(&lidar_) == TMINI_OK;
}

bool TMiniLidarBase::setFrequency(float hertz)
{
    if (!(hertz >= 6.0f && hertz <= 12.0f)) {
        return false;
    }
    const uint16_t tenths = static_cast<uint16_t>(hertz * 10.0f + 0.5f);
    return tmini_set_frequency(&lidar_, static_cast<uint16_t>(tenths * 10u)) == TMINI_OK;
}

bool TMiniLidarBase::reboot()
{
    return tmini_reboot(&lidar_) == TMINI_OK;
}

bool TMiniLidarBase::isScanning() const
{
    return tmini_state(&lidar_) == TMINI_STATE_SCANNING;
}

const tmini_info_t &TMiniLidarBase::info() const
{
    return *tmini_info(&lidar_);
}

const tmini_health_t &TMiniLidarBase::health() const
{
    return *tmini_health(&lidar_);
}

uint8_t TMiniLidarBase::faults() const
{
    return tmini_faults(&lidar_);
}

const char *TMiniLidarBase::error() const
{
    return tmini_status_name(tmini_command_error(&lidar_));
}

tmini_t *TMiniLidarBase::driver()
{
    return &lidar_;
}

#endif

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Some build systems compile this file for other frameworks, too. */
#if defined(ARDUINO)

#include "TMiniLidar.h"

#include "tmini/tmini_names.h"

/* The protocol's section 1. */
static const unsigned long BAUD_RATE = 230400;

#if defined(ESP32) || defined(ESP8266) || TMINI_LIDAR_ON_RP2040
/* Size of the core's receive buffer: it lasts 44 ms. 256 bytes last 11 ms, 32 bytes 1 ms. */
static const int SERIAL_RX_SIZE = 1024;
#elif defined(TMINI_LIDAR_MORE_FOR_TEENSY)
static const int SERIAL_RX_SIZE = 64 + TMINI_LIDAR_MORE_FOR_TEENSY;
#elif defined(SERIAL_RX_BUFFER_SIZE)
static const int SERIAL_RX_SIZE = SERIAL_RX_BUFFER_SIZE; /* As the core has it. */
#else
static const int SERIAL_RX_SIZE = 0x7FFF; /* Not known. */
#endif

/* Enlarges the core's receive buffer where the core allows it, before the port is opened. On the
 * ESP32 an open port refuses this. It is not closed here, because it would lose pins that the
 * sketch may have chosen. */
static void enlarge(TMiniSerial &serial)
{
#if defined(ESP32) || defined(ESP8266)
    serial.setRxBufferSize(SERIAL_RX_SIZE);
#elif TMINI_LIDAR_ON_RP2040
    /* An open port would refuse a new size. */
    serial.end();
    serial.setFIFOSize(SERIAL_RX_SIZE);
#else
    (void)serial;
#endif
}

/* Sets the level at which the UART's FIFO interrupts, where the core allows it, after the port is
 * opened. The core leaves 8 of 128 bytes (0.35 ms) for delays; this leaves 64. */
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
    return static_cast<bool>(serial); /* Opening may fail, for example for lack of memory. */
#else
    (void)serial;
    return true;
#endif
}

const tmini_port_t TMiniLidarBase::port_ = {writeBytes, nowMs, NULL, restart};

TMiniPoint TMiniPoints::operator[](size_t index) const
{
    TMiniPoint point;
    static_cast<tmini_point_t &>(point) = tmini_point_t();
    if (scan_ != NULL) {
        static_cast<tmini_point_t &>(point) = scan_[index];
    } else if (tmini_packet_point(&lidar_.packet(), index, &point) && lidar_.mount_ != NULL) {
        lidar_.mountPoint_(lidar_.mount_, &point);
    }
    return point;
}

TMiniLidarBase::TMiniLidarBase(uint8_t *rx, size_t rxSize, tmini_point_t *points,
                               tmini_point_t *spare, size_t maxPoints)
    : lidar_(), config_(), stream_(NULL), serial_(NULL), mount_(NULL), mountPoint_(NULL),
      event_(TMINI_EVENT_NONE), status_(TMINI_OK), overruns_(0), rxPin_(-1), txPin_(-1),
      beforeLoss_(0)
{
    config_.port = &port_;
    config_.port_context = this;
    config_.rx_buffer = rx;
    config_.rx_size = rxSize;
    config_.points = points;
    config_.spare_points = spare;
    config_.max_points = maxPoints;
}

/* Two bytes always fit in the core's transmit buffer, because nothing else is sent. */
int TMiniLidarBase::writeBytes(void *context, const uint8_t *bytes, size_t count)
{
    Stream *const stream = static_cast<TMiniLidarBase *>(context)->stream_;
    return static_cast<int>(stream->write(bytes, count));
}

uint32_t TMiniLidarBase::nowMs(void *)
{
    return static_cast<uint32_t>(millis());
}

static void open(TMiniSerial &serial)
{
    serial.begin(BAUD_RATE);
    quicken(serial);
}

#if defined(ESP32)
/* Closes an open port, because it would keep its small buffer. Early cores use other pins if none
 * are given. */
static void open(TMiniSerial &serial, int8_t rxPin, int8_t txPin)
{
    if (isOpen(serial)) {
        serial.end();
    }
    enlarge(serial);
    serial.begin(BAUD_RATE, SERIAL_8N1, rxPin, txPin);
    quicken(serial);
}
#endif

/* Opens the port again, whatever has stopped or changed it. */
void TMiniLidarBase::restart(void *context)
{
    TMiniLidarBase *const port = static_cast<TMiniLidarBase *>(context);
#if defined(ESP32)
    if (port->serial_ != NULL && port->rxPin_ >= 0) {
        open(*port->serial_, port->rxPin_, port->txPin_);
    }
#else
    if (port->serial_ != NULL) {
        open(*port->serial_);
    }
#endif
}

/* Does the work of tmini_mount_step() and receives meanwhile: on an 8-bit board this work takes
 * longer than the core's buffer lasts. */
void TMiniLidarBase::mountScan(const void *context, tmini_scan_t *scan)
{
    TMiniLidarBase *const port = static_cast<TMiniLidarBase *>(const_cast<void *>(context));
    scan->upside_down = port->mount_->upside_down;
    for (uint16_t i = 0; i < scan->count; i++) {
        port->mountPoint_(port->mount_, &scan->points[i]);
        if (i % 8 == 0) {
            port->receive();
        }
    }
}

bool TMiniLidarBase::succeeds(tmini_status_t status)
{
    status_ = status;
    return status == TMINI_OK;
}

/* Converts to 0.01 Hz. A value out of range, or not a number, becomes a frequency that is
 * refused. */
static uint16_t toHundredths(float hertz)
{
    if (!(hertz >= 6.0f && hertz <= 12.0f)) {
        return 1;
    }
    return static_cast<uint16_t>(static_cast<uint16_t>(hertz * 10.0f + 0.5f) * 10u);
}

#if defined(TMINI_LIDAR_MORE_FOR_TEENSY)
/* The port must be closed before it loses memory that it may be writing to. */
void TMiniLidarBase::leave()
{
    if (serial_ != NULL) {
        serial_->end();
        serial_->addMemoryForRead(NULL, 0);
    }
}

TMiniLidarBase::~TMiniLidarBase()
{
    leave();
}
#endif

bool TMiniLidarBase::listen(Stream &serial, TMiniSerial *port, float hertz)
{
#if defined(TMINI_LIDAR_MORE_FOR_TEENSY)
    if (serial_ != port) {
        leave();
    }
#endif
    stream_ = &serial;
    serial_ = port;
    event_ = TMINI_EVENT_NONE;
    overruns_ = 0;
    beforeLoss_ = 0;
    config_.frequency_chz = hertz == 0.0f ? 0 : toHundredths(hertz);
    if (mount_ != NULL && config_.step != NULL && config_.step != mountScan) {
        return succeeds(TMINI_ERROR_ARGUMENT); /* Only one step is possible. */
    }
    if (mount_ != NULL && config_.points != NULL) {
        config_.step = mountScan;
        config_.step_data = this;
    }
    return succeeds(tmini_init(&lidar_, &config_));
}

bool TMiniLidarBase::isReady(TMiniSerial &serial)
{
    return succeeds(isOpen(serial) ? TMINI_OK : TMINI_ERROR_WRITE);
}

bool TMiniLidarBase::begin(Stream &serial, float hertz)
{
    return listen(serial, NULL, hertz);
}

bool TMiniLidarBase::begin(TMiniSerial &serial, float hertz)
{
    enlarge(serial);
#if defined(TMINI_LIDAR_MORE_FOR_TEENSY)
    serial.addMemoryForRead(more_, sizeof more_);
#endif
    open(serial);
    rxPin_ = -1;
    return isReady(serial) && listen(serial, &serial, hertz);
}

#if defined(ESP32)
bool TMiniLidarBase::begin(TMiniSerial &serial, int8_t rxPin, int8_t txPin, float hertz)
{
    open(serial, rxPin, txPin);
    rxPin_ = rxPin;
    txPin_ = txPin;
    return isReady(serial) && listen(serial, &serial, hertz);
}
#elif TMINI_LIDAR_ON_RP2040
bool TMiniLidarBase::begin(TMiniSerial &serial, int8_t rxPin, int8_t txPin, float hertz)
{
    serial.end(); /* An open port would keep its pins. */
    const bool fit = serial.setRX(static_cast<pin_size_t>(rxPin)) &&
                     serial.setTX(static_cast<pin_size_t>(txPin));
    return succeeds(fit ? TMINI_OK : TMINI_ERROR_ARGUMENT) && begin(serial, hertz);
}
#endif

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* On an AVR readBytes() reads the clock for each byte, which takes three times as long as read().
 * On other boards it copies a whole block. */
static size_t readSome(Stream &stream, uint8_t *bytes, size_t count)
{
#if defined(ARDUINO_ARCH_AVR)
    size_t done = 0;
    for (int byte = 0; done < count && (byte = stream.read()) >= 0; done++) {
        bytes[done] = static_cast<uint8_t>(byte);
    }
    return done;
#else
    return stream.readBytes(bytes, count);
#endif
}

/* Asks only for bytes that are there, so that readBytes() does not wait. False if the stream
 * announces bytes and gives none. */
bool TMiniLidarBase::take(size_t count)
{
    uint8_t chunk[64];
    while (count > 0) {
        const size_t taken = readSome(*stream_, chunk, smaller(count, sizeof chunk));
        if (taken == 0) {
            return false;
        }
        tmini_feed(&lidar_, chunk, taken);
        count -= taken;
    }
    return true;
}

/* A full core buffer drops further bytes, so a gap is reported after the bytes that it held. True
 * if bytes were left because the lidar has no room. */
bool TMiniLidarBase::receiveSome()
{
    const int held = stream_->available();
    const size_t waiting = held > 0 ? static_cast<size_t>(held) : 0;
    size_t count = smaller(waiting, tmini_feed_room(&lidar_));
    if (serial_ != NULL && held >= SERIAL_RX_SIZE - 1 && beforeLoss_ == 0) {
        beforeLoss_ = waiting;
    }
    const bool hasLoss = beforeLoss_ > 0;
    const size_t intact = hasLoss ? beforeLoss_ : waiting;
    count = smaller(count, intact);
    if (!take(count)) {
        return false;
    }
    tmini_feed_held(&lidar_, intact - count);
    beforeLoss_ -= hasLoss ? count : 0;
    if (hasLoss && beforeLoss_ == 0) {
        overruns_++;
        tmini_feed_gap(&lidar_);
    }
    return count < waiting;
}

void TMiniLidarBase::receive()
{
    if (stream_ != NULL) {
        receiveSome();
    }
}

/* Bytes that come meanwhile are left for the next call, so that this one ends. */
tmini_event_t TMiniLidarBase::loop()
{
    bool more = stream_ != NULL;
    event_ = TMINI_EVENT_NONE;
    while (more && event_ == TMINI_EVENT_NONE) {
        more = receiveSome();
        event_ = tmini_poll(&lidar_);
        more = more && tmini_feed_room(&lidar_) > 0;
    }
    if (event_ == TMINI_EVENT_COMMAND_FAILED) {
        status_ = TMINI_OK; /* error() now gives this command's reason. */
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

/* True if points() belongs to a scan, not to a packet. */
bool TMiniLidarBase::hasPoints() const
{
    return event_ == TMINI_EVENT_SCAN || config_.spare_points != NULL;
}

TMiniPoints TMiniLidarBase::points()
{
    return hasPoints() ? TMiniPoints(*this, scan().points, scan().count)
                       : TMiniPoints(*this, NULL, available());
}

const tmini_scan_t &TMiniLidarBase::scan() const
{
    return *tmini_scan(&lidar_);
}

const tmini_packet_t &TMiniLidarBase::packet() const
{
    return *tmini_packet(&lidar_);
}

bool TMiniLidarBase::start()
{
    return succeeds(tmini_start(&lidar_));
}

bool TMiniLidarBase::stop()
{
    return succeeds(tmini_stop(&lidar_));
}

bool TMiniLidarBase::requestInfo()
{
    return succeeds(tmini_request_info(&lidar_));
}

bool TMiniLidarBase::requestHealth()
{
    return succeeds(tmini_request_health(&lidar_));
}

bool TMiniLidarBase::setFrequency(float hertz)
{
    return succeeds(tmini_set_frequency(&lidar_, toHundredths(hertz)));
}

bool TMiniLidarBase::reboot()
{
    return succeeds(tmini_reboot(&lidar_));
}

tmini_state_t TMiniLidarBase::state() const
{
    return tmini_state(&lidar_);
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

tmini_status_t TMiniLidarBase::status() const
{
    return status_ != TMINI_OK ? status_ : tmini_command_error(&lidar_);
}

const char *TMiniLidarBase::error() const
{
    return tmini_status_name(status());
}

uint16_t TMiniLidarBase::overruns() const
{
    return overruns_;
}

tmini_t *TMiniLidarBase::driver()
{
    return &lidar_;
}

#endif

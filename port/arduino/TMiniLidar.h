/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The lidar for Arduino sketches, on any serial port that is a Stream:
 *
 *     TMiniLidar lidar;
 *
 *     void setup() {
 *         lidar.begin(Serial1, 26, 27);    // ESP32: RX pin, TX pin; elsewhere begin(Serial1)
 *         lidar.start();
 *     }
 *     void loop() {
 *         while (lidar.loop()) {           // as long as something happens
 *             if (lidar.available()) {
 *                 for (TMiniPoint point : lidar.points()) {
 *                     if (point.isValid()) { use(point.angleDegrees(), point.distanceMm()); }
 *                 }
 *             }
 *         }
 *     }
 *
 * Nothing waits, and nothing is allocated. TMiniLidar gathers whole revolutions (6 KB of RAM);
 * TMiniLidarStreaming hands over each packet of up to 40 points as it comes (0.8 KB). All that the
 * library can do besides is behind driver(). */

#ifndef TMINI_LIDAR_H
#define TMINI_LIDAR_H

#include <Arduino.h>

#include "tmini/tmini.h"

/* The class of the board's serial ports that begin() opens. That of Raspberry Pi's controllers (the
 * core of Earle Philhower) has a buffer of 32 bytes, 1.4 ms, and only its own class can enlarge
 * it. */
#if defined(ARDUINO_ARCH_RP2040) && !defined(ARDUINO_ARCH_MBED)
/** Whether Serial1 is a SerialUART, whose buffer can be enlarged. */
#define TMINI_LIDAR_ON_RP2040 1
/** The class of the board's serial ports that begin() opens. */
typedef SerialUART TMiniSerial;
#else
/** Whether Serial1 is a SerialUART, whose buffer can be enlarged. */
#define TMINI_LIDAR_ON_RP2040 0
/** The class of the board's serial ports that begin() opens. */
typedef HardwareSerial TMiniSerial;
#endif

/** One measurement. */
struct TMiniPoint : public tmini_point_t {
    /** False where the lidar saw nothing: the distance is 0. */
    bool isValid() const
    {
        return distance_mm != 0;
    }
    /** Millimetres; 0: no valid range. */
    uint16_t distanceMm() const
    {
        return distance_mm;
    }
    /** Clockwise seen from above, 0 to less than 360. */
    float angleDegrees() const
    {
        return static_cast<float>(angle_q6) / 64.0f;
    }
};

/** The points of a scan or of a packet, for a range-based for; valid until the next loop(). */
class TMiniPoints
{
  public:
    /** @cond private */
    class Iterator
    {
      public:
        Iterator(const TMiniPoints &points, size_t index) : points_(points), index_(index) {}
        TMiniPoint operator*() const
        {
            return points_[index_];
        }
        Iterator &operator++()
        {
            index_++;
            return *this;
        }
        bool operator!=(const Iterator &other) const
        {
            return index_ != other.index_;
        }

      private:
        const TMiniPoints &points_;
        size_t index_;
    };

    TMiniPoints(const tmini_point_t *scan, const tmini_packet_t *packet, size_t count)
        : scan_(scan), packet_(packet), count_(count)
    {
    }
    /** @endcond */
    /** How many there are. */
    size_t size() const
    {
        return count_;
    }
    /** Point `index`, from 0, below size(). */
    TMiniPoint operator[](size_t index) const;
    /** The first one, for a range-based for. */
    Iterator begin() const
    {
        return Iterator(*this, 0);
    }
    /** Behind the last one. */
    Iterator end() const
    {
        return Iterator(*this, count_);
    }

  private:
    const tmini_point_t *scan_;
    const tmini_packet_t *packet_;
    size_t count_;
};

/** Everything but the buffers. Use TMiniLidar or TMiniLidarStreaming, below. */
class TMiniLidarBase
{
  public:
    /** Opens the serial port at the lidar's 230400 baud; on an ESP32, ESP8266, RP2040 and RP2350
     * with a large receive buffer. (On an ESP32, a port that the sketch has opened already keeps
     * its pins, and its buffer.) False when something is wrong with the buffers' sizes; on an ESP32
     * also when the port could not be opened. */
    bool begin(TMiniSerial &serial);
#if defined(ESP32) || TMINI_LIDAR_ON_RP2040
    /** The same on these pins; a port that is open already is closed and opened again. */
    bool begin(TMiniSerial &serial, int8_t rxPin, int8_t txPin);
#endif
#if TMINI_LIDAR_ON_RP2040
    /** Name the port itself (Serial1): a HardwareSerial & to it cannot enlarge its buffer. Other
     * kinds of port with a buffer of their own, such as SerialPIO: open it, then
     * begin(static_cast<Stream &>(port)). */
    bool begin(HardwareSerial &serial) = delete;
#endif
    /** For any other Stream: the sketch has opened it, at 230400 baud. */
    bool begin(Stream &serial);

    /** Takes what has been received, and does what is due. Returns what has happened, or
     * TMINI_EVENT_NONE (0) when nothing has: call it until then. Never waits. */
    tmini_event_t loop();

    /** How many points the last loop() has brought: those of a whole revolution, or when streaming
     * those of a packet. They are there until the next loop(). */
    size_t available() const;
    /** The points of the last loop(); there until the next one. */
    TMiniPoints points() const;

    /** @name Commands
     * False: not possible now. How they end comes from loop(), as the event in brackets or as
     * TMINI_EVENT_COMMAND_FAILED; error() then says why. */
    /** @{ */
    bool start();                   /**< Starts scanning [STARTED]. */
    bool stop();                    /**< Stops scanning [STOPPED]. */
    bool requestInfo();             /**< Asks for info() [INFO]. */
    bool requestHealth();           /**< Asks for health() [HEALTH]. */
    bool setFrequency(float hertz); /**< Scans a second, 6 to 12 in steps of 0.1 [FREQUENCY]. */
    bool reboot();                  /**< Restarts the lidar [REBOOTED]. */
    /** @} */

    /** True while packets come. */
    bool isScanning() const;
    /** Model, versions, serial number; after TMINI_EVENT_INFO, for good. */
    const tmini_info_t &info() const;
    /** Faults by request; after TMINI_EVENT_HEALTH, until the next one. */
    const tmini_health_t &health() const;
    /** A combination of tmini_fault_t; see TMINI_EVENT_FAULTS_CHANGED. */
    uint8_t faults() const;
    /** Why the last failed command failed, as text. */
    const char *error() const;

    /** The library's own handle, for what has no method here: counters, CT information, states. */
    tmini_t *driver();

  protected:
    /** For the classes below, which bring the buffers. */
    TMiniLidarBase(uint8_t *rx, size_t rxSize, tmini_point_t *points, size_t maxPoints);

  private:
    TMiniLidarBase(const TMiniLidarBase &);
    TMiniLidarBase &operator=(const TMiniLidarBase &);
    bool listen(Stream &serial);
    size_t receivable();
    bool receive();
    static int writeBytes(void *context, const uint8_t *bytes, size_t count);
    static uint32_t nowMs(void *context);

    static const tmini_port_t port_;
    tmini_t lidar_;
    tmini_config_t config_;
    Stream *serial_;
    tmini_event_t event_;
};

/** A lidar with its buffers: RxSize received bytes (a power of two, from 256), MaxPoints points. */
template <size_t RxSize, size_t MaxPoints> class TMiniLidarWith : public TMiniLidarBase
{
  public:
    TMiniLidarWith() : TMiniLidarBase(rx_, RxSize, points_, MaxPoints) {}

  private:
    uint8_t rx_[RxSize];
    tmini_point_t points_[MaxPoints];
};

/** The same without room for points: each packet as it comes. */
template <size_t RxSize> class TMiniLidarWith<RxSize, 0> : public TMiniLidarBase
{
  public:
    TMiniLidarWith() : TMiniLidarBase(rx_, RxSize, NULL, 0) {}

  private:
    uint8_t rx_[RxSize];
};

/** Whole revolutions, in 6 KB of RAM. */
typedef TMiniLidarWith<1024, TMINI_SCAN_POINTS_TYPICAL> TMiniLidar;
/** Each packet of up to 40 points, in 0.8 KB of RAM. */
typedef TMiniLidarWith<512, 0> TMiniLidarStreaming;

#endif

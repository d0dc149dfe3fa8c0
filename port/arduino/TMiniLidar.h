/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The lidar for Arduino sketches, on any serial port that is a Stream:
 *
 *     TMiniLidar lidar;
 *
 *     void setup() {
 *         lidar.begin(Serial1, 10);        // 10 Hz. ESP32, own pins: begin(Serial1, 26, 27, 10)
 *         lidar.start();                   // holds until stop()
 *     }
 *     void loop() {
 *         while (lidar.loop()) {           // as long as something happens
 *             if (lidar.available()) {
 *                 for (TMiniPoint point : lidar.points()) {
 *                     if (point.isValid()) { use(point.angle_q6, point.distanceMm()); }
 *                 }
 *             }
 *         }
 *     }
 *
 * No call waits, and no memory is allocated. TMiniLidar collects whole revolutions (6 KB of RAM);
 * TMiniLidarStreaming hands over each packet of up to 40 points as it comes (0.8 KB). config(),
 * before begin(), and driver() give access to the rest of the library.
 *
 * Time. The lidar sends a byte every 43 us. Bytes that the sketch does not take in time are lost
 * when the core's receive buffer is full: after 2.7 ms with 64 bytes (most boards), after 44 ms
 * with 1024 (ESP32, ESP8266, RP2040, RP2350, Teensy). loop() takes them, and so does a loop over
 * points(). During longer work of your own call receive(). On an 8-bit board a float operation
 * takes 10 us, and print() waits while its own buffer (64 bytes) is full. */

#ifndef TMINI_LIDAR_H
#define TMINI_LIDAR_H

#include <Arduino.h>

#include "tmini/tmini.h"
#include "tmini/tmini_mount.h"

/** Whether Serial1 is a SerialUART (the core of Earle Philhower): it has a buffer of 32 bytes, 1.4
 * ms, which no other class of this core can enlarge. */
#if defined(ARDUINO_ARCH_RP2040) && !defined(ARDUINO_ARCH_MBED)
#define TMINI_LIDAR_ON_RP2040 1
#else
#define TMINI_LIDAR_ON_RP2040 0
#endif

/** The class of the board's serial ports that begin() opens. */
#if TMINI_LIDAR_ON_RP2040
typedef SerialUART TMiniSerial;
#elif defined(__IMXRT1062__) && defined(CORE_TEENSY)
typedef HardwareSerialIMXRT TMiniSerial;
#else
typedef HardwareSerial TMiniSerial;
#endif

/** On a Teensy a port has 64 bytes, 2.7 ms; the lidar gives it this many more. An LC has 8 KB of
 * RAM. */
#if defined(__MKL26Z64__)
#define TMINI_LIDAR_MORE_FOR_TEENSY 192
#elif defined(CORE_TEENSY)
#define TMINI_LIDAR_MORE_FOR_TEENSY 960
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

class TMiniLidarBase;

/** The points of a scan or of a packet, for a range-based for loop. The loop also receives what the
 * lidar sends meanwhile. */
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
            points_.keepUp(index_);
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

    TMiniPoints(TMiniLidarBase &lidar, const tmini_point_t *scan, size_t count)
        : lidar_(lidar), scan_(scan), count_(count)
    {
    }
    /** @endcond */
    /** How many points there are. */
    size_t size() const
    {
        return count_;
    }
    /** Point `index`, from 0, below size(). */
    TMiniPoint operator[](size_t index) const;
    /** The first point, for a range-based for loop. */
    Iterator begin() const
    {
        return Iterator(*this, 0);
    }
    /** After the last point. */
    Iterator end() const
    {
        return Iterator(*this, count_);
    }

  private:
    inline void keepUp(size_t index) const;

    TMiniLidarBase &lidar_;
    const tmini_point_t *scan_; /* NULL: the points of the packet. */
    size_t count_;
};

/** Everything except the buffers. Use TMiniLidar or TMiniLidarStreaming, below. */
class TMiniLidarBase
{
  public:
    /** Opens the serial port at the lidar's 230400 baud; on an ESP32, ESP8266, RP2040, RP2350 and
     * Teensy with a large receive buffer. (On an ESP32, a port that the sketch has opened already
     * keeps its pins, and its buffer.) `hertz`: scans per second, 6 to 12, also after a power
     * failure; 0: whatever the lidar has. Returns false, and error() gives the reason, if the
     * configuration is wrong (for example a buffer's size or the frequency); on an ESP32 also if
     * the port could not be opened. */
    bool begin(TMiniSerial &serial, float hertz = 0);
#if defined(ESP32) || TMINI_LIDAR_ON_RP2040
    /** The same on these pins; a port that is open already is closed and opened again. */
    bool begin(TMiniSerial &serial, int8_t rxPin, int8_t txPin, float hertz = 0);
#endif
#if TMINI_LIDAR_ON_RP2040
    /** Pass the port itself (Serial1): if it is passed as HardwareSerial, its buffer cannot be
     * enlarged. If the port is of another class, with its own buffer, such as SerialPIO: open it,
     * then call begin(static_cast<Stream &>(port)). */
    bool begin(HardwareSerial &serial, float hertz = 0) = delete;
#endif
    /** For any other Stream: the sketch has opened it, at 230400 baud. */
    bool begin(Stream &serial, float hertz = 0);

    /** @name Before begin() */
    /** @{ */

    /** How the lidar is mounted, and what is masked: points are then in the robot's directions.
     * `mount` must outlive the lidar. It cannot be combined with a `step` of your own. */
    void setMount(const tmini_mount_t &mount)
    {
        mount_ = &mount;
        mountPoint_ = tmini_mount_point; /* Here, so that it is linked only where it is used. */
    }
    /** A temporary object is refused: it would not outlive the call. */
    void setMount(const tmini_mount_t &&mount) = delete;

    /** All other settings of tmini_init(), such as `config().filter = TMINI_FILTER_BOTH` or
     * `config().listen_only = true`. begin() sets port, buffers and frequency. */
    tmini_config_t &config()
    {
        return config_;
    }
    /** @} */

    /** Takes received bytes and does what is due. Returns the next event, or TMINI_EVENT_NONE (0)
     * if there is none: call it until then. Never waits. */
    tmini_event_t loop();

    /** Takes received bytes and does nothing else: for use during work that takes longer than the
     * core's buffer lasts. The lidar's own buffer lasts 22 ms per 512 bytes. */
    void receive();

    /** How many points the last loop() has brought: those of a whole revolution or, with
     * TMiniLidarStreaming, of a packet. */
    size_t available() const;
    /** The points of the last loop(), valid until the next loop(). With a spare buffer, the points
     * of the last scan, valid until the next scan. */
    TMiniPoints points();
    /** The scan that points() belongs to, valid as long as they are. */
    const tmini_scan_t &scan() const;
    /** With TMiniLidarStreaming: the packet that points() belongs to, until the next loop(). */
    const tmini_packet_t &packet() const;

    /** @name Commands
     * They return false if the command is not possible now; error() gives the reason. Later loop()
     * returns the event in brackets, or TMINI_EVENT_COMMAND_FAILED, whose reason is in error(). */
    /** @{ */
    bool start();                   /**< Scans until stop(), whatever happens [STARTED]. */
    bool stop();                    /**< Stops scanning [STOPPED]. */
    bool requestInfo();             /**< Asks for info() [INFO]. */
    bool requestHealth();           /**< Asks for health() [HEALTH]. */
    bool setFrequency(float hertz); /**< Scans per second, 6 to 12 in steps of 0.1 [FREQUENCY]. */
    bool reboot();                  /**< Restarts the lidar [REBOOTED]. */
    /** @} */

    /** True while packets come. */
    bool isScanning() const;
    /** What the lidar does. */
    tmini_state_t state() const;
    /** Model, versions, serial number; valid from TMINI_EVENT_INFO on. */
    const tmini_info_t &info() const;
    /** The answer to requestHealth(); valid from one TMINI_EVENT_HEALTH to the next. */
    const tmini_health_t &health() const;
    /** A combination of tmini_fault_t; see TMINI_EVENT_FAULTS_CHANGED. */
    uint8_t faults() const;
    /** Why the last call returned false; if it returned true, why the last command failed.
     * TMINI_OK: neither has happened. */
    tmini_status_t status() const;
    /** The same as text. */
    const char *error() const;
    /** How often the core's receive buffer was found full, so that bytes may have been lost: the
     * sketch was too slow. Counted only where the buffer's size is known: begin() has set it, or
     * the core defines it (AVR, STM32). */
    uint16_t overruns() const;

    /** The library's tmini_t, for what has no method here: counters, CT information. */
    tmini_t *driver();

  protected:
    /** For the classes below, which add the buffers. */
    TMiniLidarBase(uint8_t *rx, size_t rxSize, tmini_point_t *points, tmini_point_t *spare,
                   size_t maxPoints);
#if defined(TMINI_LIDAR_MORE_FOR_TEENSY)
    /** Closes the port, which must not use this memory any longer. */
    ~TMiniLidarBase();
#endif

  private:
    friend class TMiniPoints;
    TMiniLidarBase(const TMiniLidarBase &);
    TMiniLidarBase &operator=(const TMiniLidarBase &);
    bool listen(Stream &serial, TMiniSerial *port, float hertz);
#if defined(TMINI_LIDAR_MORE_FOR_TEENSY)
    void leave();
#endif
    bool isReady(TMiniSerial &serial);
    bool succeeds(tmini_status_t status);
    bool take(size_t count);
    bool receiveSome();
    bool hasPoints() const;
    static int writeBytes(void *context, const uint8_t *bytes, size_t count);
    static uint32_t nowMs(void *context);
    static void restart(void *context);
    static void mountScan(const void *context, tmini_scan_t *scan);

    static const tmini_port_t port_;
    tmini_t lidar_;
    tmini_config_t config_;
    Stream *stream_;
    TMiniSerial *serial_; /* The same port, if begin() has opened it. */
    const tmini_mount_t *mount_;
    void (*mountPoint_)(const tmini_mount_t *mount, tmini_point_t *point);
    tmini_event_t event_;
    tmini_status_t status_;
    uint16_t overruns_;
    int8_t rxPin_; /* On an ESP32, the pins given to begin(); else -1. */
    int8_t txPin_;
    size_t beforeLoss_; /* Bytes in the core's buffer before a loss; 0: no loss. */
#if defined(TMINI_LIDAR_MORE_FOR_TEENSY)
    uint8_t more_[TMINI_LIDAR_MORE_FOR_TEENSY];
#endif
};

inline void TMiniPoints::keepUp(size_t index) const
{
    if (index % 16 == 0) { /* A few hundred microseconds of work on an 8-bit board. */
        lidar_.receive();
    }
}

/** A lidar with its buffers, for RxSize received bytes (a power of two, at least 256) and MaxPoints
 * points. With Spare there are two buffers for points, and a scan stays valid until the next
 * one. */
template <size_t RxSize, size_t MaxPoints, bool Spare = false>
class TMiniLidarWith : public TMiniLidarBase
{
  public:
    TMiniLidarWith() : TMiniLidarBase(rx_, RxSize, points_, Spare ? spare_ : NULL, MaxPoints) {}

  private:
    uint8_t rx_[RxSize];
    tmini_point_t points_[MaxPoints];
    tmini_point_t spare_[Spare ? MaxPoints : 1];
};

/** The same without room for points: each packet as it comes. */
template <size_t RxSize> class TMiniLidarWith<RxSize, 0, false> : public TMiniLidarBase
{
  public:
    TMiniLidarWith() : TMiniLidarBase(rx_, RxSize, NULL, NULL, 0) {}

  private:
    uint8_t rx_[RxSize];
};

/** Whole revolutions, in 6 KB of RAM; on an 8-bit board with smaller buffers, in 5.1 KB: room for
 * revolutions at 6 Hz and above. */
#if defined(ARDUINO_ARCH_AVR)
typedef TMiniLidarWith<512, 700> TMiniLidar;
#else
typedef TMiniLidarWith<1024, TMINI_SCAN_POINTS_TYPICAL> TMiniLidar;
/** The same with a spare buffer, in 11 KB: a scan stays valid until the next one. */
typedef TMiniLidarWith<1024, TMINI_SCAN_POINTS_TYPICAL, true> TMiniLidarSpare;
#endif
/** Each packet of up to 40 points, in 0.8 KB of RAM. */
typedef TMiniLidarWith<512, 0> TMiniLidarStreaming;

#endif

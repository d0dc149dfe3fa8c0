/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The part of Arduino's API that the port and its sketches use, written for the tests from the
 * public reference. It is the poorest of the cores: what one of them leaves out, it does not have
 * (LED_BUILTIN, a serial port's availableForWrite()). A test sets the clock, and fills and reads
 * the serial ports. The macros ESP32, ARDUINO_ARCH_RP2040 and CORE_TEENSY add the functions of
 * these cores. */

#ifndef ARDUINO_H
#define ARDUINO_H

#include <stddef.h>
#include <stdint.h>
#include <deque>
#include <string>

/* The real core also defines these names as macros. */
#define degrees(radians) ((radians)*57.29577951308232)
#define radians(degrees) ((degrees)*0.017453292519943295)

extern unsigned long arduino_millis;

inline unsigned long millis()
{
    return arduino_millis;
}

enum { INPUT, OUTPUT };
enum { LOW, HIGH };
extern uint8_t arduino_pins[64];

inline void pinMode(uint8_t, uint8_t) {}

inline void digitalWrite(uint8_t pin, uint8_t level)
{
    arduino_pins[pin] = level;
}

class Print
{
  public:
    virtual ~Print() {}
    virtual int availableForWrite()
    {
        return 0;
    }
    virtual size_t write(uint8_t byte) = 0;
    virtual size_t write(const uint8_t *bytes, size_t count)
    {
        size_t taken = 0;
        while (taken < count && write(bytes[taken]) == 1) {
            taken++;
        }
        return taken;
    }
    void print(const char *text)
    {
        write(reinterpret_cast<const uint8_t *>(text), std::string(text).size());
    }
    void print(unsigned long number)
    {
        print(std::to_string(number).c_str());
    }
    template <typename T> void println(T value)
    {
        print(value);
        print("\r\n");
    }
};

class Stream : public Print
{
  public:
    virtual int available() = 0;
    virtual int read() = 0;
    size_t readBytes(uint8_t *buffer, size_t length)
    {
        size_t count = 0;
        int byte = 0;
        while (count < length && available() > 0 && (byte = read()) >= 0) {
            buffer[count++] = static_cast<uint8_t>(byte);
        }
        waited = waited || count < length; /* The real function would wait up to a second. */
        return count;
    }
    bool waited = false;
};

#define SERIAL_8N1 0x800001cu

class HardwareSerial : public Stream
{
  public:
    using Print::write;
    int available() override
    {
        return static_cast<int>(received.size());
    }
    int read() override
    {
        if (received.empty()) {
            return -1;
        }
        const uint8_t byte = received.front();
        received.pop_front();
        return byte;
    }
    size_t write(uint8_t byte) override
    {
        sent.push_back(byte);
        return 1;
    }
    virtual void begin(unsigned long baud)
    {
        is_open = !refuses;
        baud_rate = baud;
        size_at_begin = rx_size;
        fifo_full = 120; /* The ESP32 core's default at this baud rate. */
    }
    /* A byte arrives from the line. It is lost if the buffer is full or the port is closed. */
    void take(uint8_t byte)
    {
        if (received.size() < rx_size && is_open) {
            received.push_back(byte);
        } else {
            lost++;
        }
    }
    /* On an ESP32, closing also releases the pins. */
    void end()
    {
        vain_ends += is_open ? 0 : 1;
        is_open = false;
#if defined(ESP32)
        rx_pin = tx_pin = -1;
#endif
    }
#if defined(ESP32)
    void begin(unsigned long baud, uint32_t config, int8_t rx, int8_t tx)
    {
        begin(baud);
        line = config;
        rx_pin = rx;
        tx_pin = tx;
    }
    operator bool() const
    {
        return is_open;
    }
    size_t setRxBufferSize(size_t size)
    {
        rx_size = is_open ? rx_size : size;
        return is_open ? 0 : size;
    }
    bool setRxFIFOFull(uint8_t bytes)
    {
        fifo_full = bytes;
        return true;
    }
#endif

    unsigned lost = 0;
    std::deque<uint8_t> received;
    std::deque<uint8_t> sent;
    unsigned long baud_rate = 0;
    uint32_t line = 0;
#if defined(SERIAL_RX_BUFFER_SIZE)
    size_t rx_size = SERIAL_RX_BUFFER_SIZE - 1; /* In a full ring, head and tail must differ. */
#else
    size_t rx_size = 256;
#endif
    size_t size_at_begin = 0;
    int rx_pin = -1;
    int tx_pin = -1;
    int fifo_full = 0;
    bool is_open = false;
    unsigned vain_ends = 0;
    bool refuses = false; /* True: begin() fails, as when memory is short. */
};

#if defined(ARDUINO_ARCH_RP2040)
typedef uint8_t pin_size_t;

/* While the port is open, its pins and its queue (32 bytes by default) cannot be changed. */
class SerialUART : public HardwareSerial
{
  public:
    SerialUART()
    {
        rx_size = 32;
    }
    bool setFIFOSize(size_t size)
    {
        rx_size = is_open ? rx_size : size;
        return !is_open;
    }
    bool setRX(pin_size_t pin)
    {
        rx_pin = is_open ? rx_pin : pin;
        return !is_open;
    }
    bool setTX(pin_size_t pin)
    {
        tx_pin = is_open ? tx_pin : pin;
        return !is_open;
    }
};

typedef SerialUART SerialPort;
#elif defined(__IMXRT1062__)
/* A Teensy 4: 64 bytes of its own, and what it is given. */
class HardwareSerialIMXRT : public HardwareSerial
{
  public:
    HardwareSerialIMXRT()
    {
        rx_size = 63;
    }
    void addMemoryForRead(void *buffer, size_t length)
    {
        more = buffer;
        more_while_open = more_while_open || (is_open && buffer == NULL);
        rx_size = 63 + (buffer != NULL ? length : 0);
    }
    void *more = NULL;
    bool more_while_open = false;
};

typedef HardwareSerialIMXRT SerialPort;
#else
typedef HardwareSerial SerialPort;
#endif

extern HardwareSerial Serial;
extern SerialPort Serial1;
extern SerialPort Serial2;

#endif

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* An emulated Arduino Mega 2560 that runs an unchanged sketch at the real speed: each instruction
 * takes its cycles, and each byte of the simulated lidar arrives at its time.
 *
 *     mega FIRMWARE.elf SCANS PORT…       PORT: 1 to 3, a lidar is on Serial1 to Serial3
 *
 * Runs until each lidar has sent SCANS whole revolutions and the sketch has then printed
 *
 *     N scans, N complete
 *
 * where N is the number of revolutions that all lidars have sent. A sketch may print one number per
 * scan instead: one more than revolutions means that a loss has divided one. A sketch may also be a
 * bridge, which prints the lidar's bytes: all must arrive in order, and the computer sends it a
 * start command. Exit status: 0 as expected, 1 not, 2 wrong usage, 77 the firmware does not exist.
 *
 * The emulator's own UART has a receive queue of 64 bytes, the chip's UART only two bytes and the
 * shift register. The lidars' ports are therefore modelled here: a byte that is complete while two
 * others wait is lost. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
#include <sim_io.h>

#include "simulator.h"

#define CLOCK_HZ 16000000u
#define CYCLES_PER_US (CLOCK_HZ / 1000000u)
#define PORTS 3u
#define QUEUE 2u
#define CORE_BUFFER 64u    /* Bytes that a bridge's core may hold. */
#define COMMAND_US 500000u /* When a bridge's computer starts the lidar. */
#define GRACE_US 1500000u  /* Time for the sketch to print its next line. */
#define LIMIT_US 60000000u

typedef struct {
    avr_t *avr;
    avr_uart_t *uart;
    sim_t lidar;
    uint8_t queue[QUEUE];
    unsigned queued;
    unsigned lost;  /* Bytes that found the chip's queue full. */
    unsigned turns; /* Whole revolutions sent. */
} port_t;

static port_t ports[PORTS];
static unsigned port_count;
static unsigned wanted;
static char line[200];
static bool said_so;
static uint8_t sent[4096]; /* Ring of the bytes that the first lidar has sent. */
static size_t sent_count;
static size_t forwarded; /* How many of them a bridge has printed, in order. */
static bool is_bridge;

static uint64_t now_us(const avr_t *avr)
{
    return avr->cycle / CYCLES_PER_US;
}

/* ---------------------------------------------------------------------------- the lidars' ports */

/* As in the data sheet: the interrupt stays pending while there is a byte in the queue. */
static uint8_t read_data(avr_t *avr, avr_io_addr_t address, void *context)
{
    port_t *const port = context;
    const uint8_t byte = port->queue[0];
    (void)address;
    if (port->queued > 0) {
        port->queued--;
        port->queue[0] = port->queue[1];
    }
    avr_clear_interrupt(avr, &port->uart->rxc);
    if (port->queued > 0) {
        avr_raise_interrupt(avr, &port->uart->rxc);
    }
    return byte;
}

static void receive(port_t *port, uint8_t byte)
{
    if (!avr_regbit_get(port->avr, port->uart->rxen)) {
        return;
    }
    if (port->queued == QUEUE) {
        port->lost++;
        return;
    }
    port->queue[port->queued++] = byte;
    avr_raise_interrupt(port->avr, &port->uart->rxc);
}

static void send(struct avr_irq_t *irq, uint32_t value, void *context)
{
    port_t *const port = context;
    const uint8_t byte = (uint8_t)value;
    (void)irq;
    sim_receive(&port->lidar, &byte, 1, now_us(port->avr));
}

static avr_cycle_count_t pass_bytes(avr_t *avr, avr_cycle_count_t when, void *context)
{
    port_t *const port = context;
    uint8_t byte;
    (void)when;
    while (sim_transmit(&port->lidar, now_us(avr), &byte, 1) == 1) {
        receive(port, byte);
        if (port == ports) {
            sent[sent_count++ % sizeof sent] = byte;
        }
    }
    return avr->cycle + CYCLES_PER_US;
}

static void note_packet(void *context, const sim_packet_t *packet)
{
    port_t *const port = context;
    port->turns = packet->revolution > 0 ? packet->revolution - 1 : 0;
}

static avr_uart_t *find_uart(avr_t *avr, char name)
{
    for (avr_io_t *io = avr->io_port; io != NULL; io = io->next) {
        if (strcmp(io->kind, "uart") == 0 && ((avr_uart_t *)io)->name == name) {
            return (avr_uart_t *)io;
        }
    }
    return NULL;
}

/* The lidar begins at full speed: slower revolutions have too many points for a Mega. */
static void start_lidar(port_t *port)
{
    sim_config_t config = sim_default_config();
    const sim_observer_t observer = {.context = port, .on_packet = note_packet};
    config.seed += port_count;
    config.spin_up_percent = 100;
    sim_init(&port->lidar, &config);
    sim_observe(&port->lidar, &observer);
}

static bool connect(avr_t *avr, char digit)
{
    port_t *const port = &ports[port_count];
    if (port_count == PORTS || digit < '1' || digit > '3') {
        return false;
    }
    port->avr = avr;
    port->uart = find_uart(avr, digit);
    start_lidar(port);
    avr->io[AVR_DATA_TO_IO(port->uart->r_udr)].r.c = read_data;
    avr->io[AVR_DATA_TO_IO(port->uart->r_udr)].r.param = port;
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ(digit), UART_IRQ_OUTPUT), send,
                            port);
    avr_cycle_timer_register(avr, CYCLES_PER_US, pass_bytes, port);
    port_count++;
    return true;
}

/* ---------------------------------------------------------------------------------- the console */

static unsigned turns_sent(void)
{
    unsigned turns = 0;
    for (unsigned i = 0; i < port_count; i++) {
        turns += ports[i].turns;
    }
    return turns;
}

static void judge(void)
{
    static unsigned numbers;
    unsigned scans = 0;
    unsigned complete = 0;
    char end = '\0';
    if (sscanf(line, "%u%c", &scans, &end) == 1) { /* A sketch that prints one number per scan. */
        scans = ++numbers;
        complete = ports[0].lost == 0 && numbers <= ports[0].turns ? numbers : 0;
    } else if (sscanf(line, "%u scans, %u complete", &scans, &complete) != 2) {
        return;
    }
    said_so =
        scans >= wanted * port_count && scans == complete && scans + port_count >= turns_sent();
}

/* The lidar's first byte is A5 or AA: no printed text contains these bytes. */
static bool forward(uint8_t byte)
{
    is_bridge = is_bridge || (forwarded == 0 && byte >= 0x80);
    if (is_bridge && forwarded < sent_count && byte == sent[forwarded % sizeof sent]) {
        forwarded++;
    }
    return is_bridge;
}

static void print(struct avr_irq_t *irq, uint32_t value, void *context)
{
    const size_t length = strlen(line);
    (void)irq, (void)context;
    if (forward((uint8_t)value)) {
        return;
    }
    if (value == '\n') {
        (void)printf("%s\n", line);
        judge();
        line[0] = '\0';
    } else if (value != '\r' && length + 1 < sizeof line) {
        line[length] = (char)value;
        line[length + 1] = '\0';
    }
}

static avr_cycle_count_t press_start(avr_t *avr, avr_cycle_count_t when, void *context)
{
    static const uint8_t command[] = {0xA5, SIM_COMMAND_START};
    (void)when, (void)context;
    for (unsigned i = 0; i < sizeof command; i++) {
        avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT), command[i]);
    }
    return 0;
}

static bool all_sent(void)
{
    for (unsigned i = 0; i < port_count; i++) {
        if (ports[i].turns < wanted) {
            return false;
        }
    }
    return true;
}

static void run(avr_t *avr)
{
    uint64_t end_us = LIMIT_US;
    while (now_us(avr) < end_us && !said_so) {
        const int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed) {
            (void)printf("the firmware has crashed\n");
            return;
        }
        if (end_us == LIMIT_US && all_sent()) {
            end_us = now_us(avr) + GRACE_US;
        }
        said_so = said_so || (is_bridge && all_sent() && forwarded + CORE_BUFFER >= sent_count);
    }
}

static avr_t *make_board(elf_firmware_t *firmware, const char *path)
{
    avr_t *const avr = avr_make_mcu_by_name("atmega2560");
    uint32_t flags = 0; /* For UART 0: simavr neither prints its output nor sleeps when polled. */
    if (avr == NULL || elf_read_firmware(path, firmware) != 0) {
        return NULL;
    }
    avr_init(avr);
    firmware->frequency = CLOCK_HZ;
    avr_load_firmware(avr, firmware);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), print,
                            NULL);
    avr_cycle_timer_register_usec(avr, COMMAND_US, press_start, NULL);
    return avr;
}

static void report(void)
{
    for (unsigned i = 0; i < port_count; i++) {
        (void)printf("Serial%c: %u revolutions, %u bytes lost\n", ports[i].uart->name,
                     ports[i].turns, ports[i].lost);
    }
    if (is_bridge) {
        (void)printf("%zu bytes sent, %zu forwarded\n", sent_count, forwarded);
    }
}

int main(int argc, char **argv)
{
    elf_firmware_t firmware = {0};
    if (argc < 4) {
        (void)fprintf(stderr, "usage: mega FIRMWARE.elf SCANS PORT...\n");
        return 2;
    }
    avr_t *const avr = make_board(&firmware, argv[1]);
    if (avr == NULL) {
        (void)printf("skipped: %s has not been built\n", argv[1]);
        return 77;
    }
    wanted = (unsigned)strtoul(argv[2], NULL, 10);
    for (int i = 3; i < argc; i++) {
        if (!connect(avr, argv[i][0])) {
            (void)fprintf(stderr, "there is no Serial%s\n", argv[i]);
            return 2;
        }
    }
    run(avr);
    report();
    return said_so ? 0 : 1;
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "play.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "known_packets.h"
#include "unity.h"

#define LAP_US 80000u /* Of a scanning lidar, in 1024 bytes. */

rig_way_t rig_way;

static uint32_t bytes_before;
static uint32_t overruns_before;
static uint32_t damage;
static uint32_t it;
static uint32_t marked;

/* -------------------------------------------------------------------------- as every_port wants */

static void use(rig_way_t way)
{
    rig_way = way;
    port_program.rx_dma = way == BY_DMA;
    init_lidar(1024);
}

static void by_dma(void)
{
    use(BY_DMA);
}

static void by_blocks(void)
{
    use(BY_BLOCKS);
}

void port_begin(const sim_observer_t *observer)
{
    rig_way = BY_BYTES;
    port_program.rx_dma = false;
    bytes_before = overruns_before = 0;
    rig_open();
    machine_new_lidar(observer);
}

int port_init(void)
{
    return 0; /* rig_open() has done it. */
}

static uint32_t bytes_accounted_for(void)
{
    tmini_counters_t c;
    tmini_counters(&lidar, &c);
    return c.bytes_in_packets + c.bytes_skipped + c.bytes_overrun + c.bytes_pending;
}

static uint32_t overruns_and_laps(void)
{
    const rig_counts_t errors = rig_counts();
    return errors.overruns + errors.laps;
}

/* The first interrupt may count an overrun from before. */
int port_start(void)
{
    const tmini_status_t status = rig_start();
    machine_step(0);
    bytes_before = bytes_accounted_for();
    overruns_before = overruns_and_laps();
    return status;
}

void port_assert_stopped(void)
{
    TEST_ASSERT_TRUE(rig_is_off());
}

port_counts_t port_counted(void)
{
    const rig_counts_t errors = rig_counts();
    return (port_counts_t){.bytes = bytes_accounted_for() - bytes_before,
                           .overruns = overruns_and_laps() - overruns_before,
                           .framing_errors = errors.framing_errors,
                           .breaks = errors.noise_errors};
}

static void hold(uint32_t us)
{
    model.held_until_ns = machine.now_ns + us * UINT64_C(1000);
}

static void hold_up(uint32_t us)
{
    hold(us);
    machine_pass(us);
}

/* One lap and a half, in which 20 ms would pass with a smaller buffer. */
static void hold_up_for_a_lap(uint32_t us)
{
    hold_up(us / 20000 * LAP_US * 3 / 2);
}

#define WAY .always_wired = true, .old = 16, .behind = 64, .break_reception = rig_break_reception

const port_way_t port_ways[] = {
    {.name = "by bytes",
     .without_fifo = true,
     .packets_per_loss = 4,
     .hold_up = hold_up,
     .loss = MODEL_ORE,
     .framing_error = MODEL_FE,
     .line_break = MODEL_NE,
     WAY},
    {.name = "by DMA",
     .choose = by_dma,
     .holds = 500,
     .packets_per_loss = 16,
     .hold_up = hold_up_for_a_lap,
     WAY},
    {.name = "by blocks", .choose = by_blocks, .packets_per_loss = 6, .hold_up = hold_up, WAY},
};

/* ------------------------------------------------------------------------------------ the words */

static void nothing(void) {}

static void send(const uint8_t *bytes, size_t count)
{
    machine_send(damage, bytes, count);
    damage = 0;
}

void play_send(uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        send(start_packet, sizeof start_packet);
    }
}

ACT(send_head, send(start_packet, 6))
ACT(send_tail, send(&start_packet[6], sizeof start_packet - 6))

static void send_zeros(uint32_t count)
{
    static const uint8_t zero = 0;
    for (uint32_t i = 0; i < count; i++) {
        send(&zero, 1);
    }
}

static void pass_ms(uint32_t ms)
{
    for (uint32_t i = 0; i < ms; i++) {
        machine_pass(1000);
        poll_all();
    }
}

static void run(void)
{
    while (!machine_has_sent()) {
        pass_ms(1);
    }
    pass_ms(1);
}

void play_receive(uint32_t count)
{
    play_send(count);
    run();
}

ACT(start_it, TEST_ASSERT_EQUAL_INT(0, port_start()))
ACT(restart_it, port_program.port->restart(port_program.context))
ACT(set_up_anew, init_lidar(1024))
ACT(break_it, port_way->break_reception())
ACT(mark, marked = play_packets())
ACT(damage_framing, damage = MODEL_FE)
ACT(damage_by_noise, damage = MODEL_NE)
ACT(set_overrun, model.flags |= MODEL_ORE)
ACT(let_overruns_hold_bytes_back, model.ore_holds_rxne = true)
ACT(let_errors_hold_dma_back, model_usart.CR3 |= MODEL_CR3_DDRE)

static void hold_and_pass(uint32_t us)
{
    hold_up(us);
    machine_pass(10);
}

static void disable_interrupts(void)
{
    irq.lines[MODEL_USART_IRQ].disabled = true;
    irq.lines[MODEL_DMA_IRQ].disabled = true;
}

ACT_ON(set_priority, irq.lines[MODEL_USART_IRQ].priority = number)
ACT_ON(set_dma_priority, irq.lines[MODEL_DMA_IRQ].priority = number)
ACT_ON(set_access, machine.access_ns = number)

/* ---------------------------------------------------------------------------------- the numbers */

static tmini_counters_t counters_after_poll(void)
{
    tmini_counters_t counters;
    poll_all();
    tmini_counters(&lidar, &counters);
    return counters;
}

uint32_t play_packets(void)
{
    return counters_after_poll().packets;
}

uint32_t play_accounted(void)
{
    poll_all();
    return bytes_accounted_for();
}

NUMBER(more, (play_packets() - marked))
NUMBER(skipped, counters_after_poll().bytes_skipped)
NUMBER(overrun, counters_after_poll().bytes_overrun)
NUMBER(served, irq.lines[0].served)
NUMBER(position, tmini_ring_head(&lidar.ring))
NUMBER(byte_waits, (model.flags & MODEL_RXNE) != 0)
NUMBER(overrun_stands, (model.flags & MODEL_ORE) != 0)
NUMBER(is_off, rig_is_off())
NUMBER(overruns, rig_counts().overruns)
NUMBER(framing_errors, rig_counts().framing_errors)
NUMBER(noise_errors, rig_counts().noise_errors)
NUMBER(laps, rig_counts().laps)
NUMBER(restarts, rig_counts().restarts)
NUMBER(other_errors, rig_counts().other_errors)

static const play_word_t words[] = {
    {.name = "for", .act = nothing},
    {.name = "P", .act_on = play_send},
    {.name = "head", .act = send_head},
    {.name = "tail", .act = send_tail},
    {.name = "x", .act_on = send_zeros},
    {.name = "run", .act = run},
    {.name = "+", .act_on = pass_ms},
    {.name = "~", .act_on = machine_pass},
    {.name = "poll", .act = poll_all},
    {.name = "start", .act = start_it},
    {.name = "stop", .act = port_stop},
    {.name = "restart", .act = restart_it},
    {.name = "anew", .act = set_up_anew},
    {.name = "break", .act = break_it},
    {.name = "mark", .act = mark},
    {.name = "packets", .count = play_packets},
    {.name = "more", .count = more},
    {.name = "skipped", .count = skipped},
    {.name = "overrun", .count = overrun},
    {.name = "accounted", .count = play_accounted},
    {.name = "served", .count = served},
    {.name = "position", .count = position},
    {.name = "FE", .act = damage_framing},
    {.name = "NE", .act = damage_by_noise},
    {.name = "ORE-stands", .act = set_overrun, .count = overrun_stands},
    {.name = "ORE-holds", .act = let_overruns_hold_bytes_back},
    {.name = "DDRE", .act = let_errors_hold_dma_back},
    {.name = "hold", .act_on = hold},
    {.name = "held", .act_on = hold_and_pass},
    {.name = "deaf", .act = disable_interrupts},
    {.name = "priority", .act_on = set_priority},
    {.name = "dma-priority", .act_on = set_dma_priority},
    {.name = "access", .act_on = set_access},
    {.name = "RXNE", .count = byte_waits},
    {.name = "off", .count = is_off},
    {.name = "ORE", .count = overruns},
    {.name = "FEs", .count = framing_errors},
    {.name = "NEs", .count = noise_errors},
    {.name = "laps", .count = laps},
    {.name = "restarts", .count = restarts},
    {.name = "others", .count = other_errors},
    {.name = NULL},
};

/* ------------------------------------------------------------------------------------- the play */

static const play_word_t *find(const play_word_t *among, const char *name, size_t length)
{
    while (among->name != NULL &&
           (strncmp(among->name, name, length) != 0 || among->name[length] != '\0')) {
        among++;
    }
    return among;
}

static uint32_t value_of(const char *text)
{
    if (*text == '\0') {
        return 1;
    }
    return strcmp(text, "it") == 0 ? it : (uint32_t)strtoul(text, NULL, 10);
}

static void check(const char *said, char relation, uint32_t wanted, uint32_t number)
{
    switch (relation) {
    case '<':
        TEST_ASSERT_LESS_THAN_UINT32_MESSAGE(wanted, number, said);
        break;
    case '>':
        TEST_ASSERT_GREATER_THAN_UINT32_MESSAGE(wanted, number, said);
        break;
    default:
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(wanted, number, said);
        break;
    }
}

static void tell(char *word)
{
    const size_t length = *word == '+' || *word == '~' ? 1 : strcspn(word, ":<>");
    const char relation = word[length];
    const char *const number = &word[length] + strspn(&word[length], ":<>");
    const play_word_t *found = find(words, word, length);
    if (found->name == NULL) {
        found = find(port_words, word, length);
    }
    if (found->count != NULL && relation != '\0') {
        check(word, relation, value_of(number), found->count());
    } else if (found->act_on != NULL) {
        found->act_on(value_of(number));
    } else {
        TEST_ASSERT_TRUE_MESSAGE(found->act != NULL, word);
        found->act();
    }
}

static void begin(bool is_idle)
{
    machine_power(false);
    damage = marked = 0;
    TEST_ASSERT_EQUAL_INT(0, port_init());
    if (!is_idle) {
        machine_pass(10000);
        start_it();
    }
}

void play_begin(unsigned way)
{
    begin_way(way);
    begin(true);
}

void play_start(unsigned way)
{
    begin_way(way);
    begin(false);
}

/* Whether one of the words before `end` is this one. */
static bool names(const char *text, const char *end, const char *word)
{
    const size_t length = strlen(word);
    for (; text < end; text += strcspn(text, " :") + 1) {
        if (strncmp(text, word, length) == 0 && strcspn(text, " :") == length) {
            return true;
        }
    }
    return false;
}

void play_row(const row_t *row)
{
    const char *const end = strstr(row->steps, ": ");
    TEST_ASSERT_NOT_NULL(end);
    while (next_way()) {
        const char *const space = strrchr(port_way->name, ' ');
        unsigned first = 0;
        unsigned limit = 1;
        unsigned step = 1;
        if (!names(row->steps, end, "all") && !names(row->steps, end, space + 1)) {
            continue;
        }
        (void)sscanf(end + 2, "for:%u:%u:%u", &first, &limit, &step);
        TEST_ASSERT_LESS_THAN_UINT(limit, first);
        for (it = first; it < limit; it += step) {
            if (it != first) {
                begin_again();
            }
            begin(names(row->steps, end, "idle"));
            row_tell(end + 2, tell);
        }
    }
}

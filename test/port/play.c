/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "play.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "every_port.h"
#include "irq_lines.h"
#include "known_packets.h"
#include "unity.h"

static uint32_t damage;
static uint32_t it;
static uint32_t marked;

/* ------------------------------------------------------------------------------------ the words */

static void nothing(void) {}

void play_damage(uint32_t errors)
{
    damage = errors;
}

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
    const tmini_counters_t c = counters_after_poll();
    return c.bytes_in_packets + c.bytes_skipped + c.bytes_overrun + c.bytes_pending;
}

NUMBER(more, (play_packets() - marked))
NUMBER(skipped, counters_after_poll().bytes_skipped)
NUMBER(overrun, counters_after_poll().bytes_overrun)
NUMBER(served, irq.lines[0].served)
NUMBER(position, tmini_ring_head(&lidar.ring))

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
    for (unsigned i = 0; found->name == NULL && port_words[i] != NULL; i++) {
        found = find(port_words[i], word, length);
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

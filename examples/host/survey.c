/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "survey.h"

#include <string.h>

#define MS 1000u
#define S 1000000u

#define REPLY_US (2 * S) /* Section 9.11. */
#define QUIET_US (300 * MS)
#define TAIL_US (3 * S)
#define BOOT_STEP_MS 100u
#define BOOT_FIRST_MS 500u /* The program that boots first is not disturbed. */
#define BOOT_MS 15000u
#define FAST_S 15u

#define STEPS_MAX 40u
#define BEYOND_CHZ 2500u /* Above this no step is tried. */

static bool is_over(const survey_t *survey)
{
    return survey->wire->is_over(survey->wire->context);
}

static uint64_t now_us(const survey_t *survey)
{
    return survey->wire->now_us(survey->wire->context);
}

static void say(const survey_t *survey, const char *text)
{
    survey->wire->say(survey->wire->context, text);
}

static void send(const survey_t *survey, tmini_command_code_t code)
{
    const uint8_t command[2] = {TMINI_COMMAND_SYNC, (uint8_t)code};
    survey->wire->send(survey->wire->context, command, sizeof command);
}

/* Receives bytes until that time; 0: no more came. */
static size_t receive(const survey_t *survey, uint8_t *bytes, size_t max, uint64_t until_us)
{
    return is_over(survey) ? 0 : survey->wire->receive(survey->wire->context, bytes, max, until_us);
}

/* Receives until the line has been quiet for a while. Returns how many bytes came. */
static uint32_t drain(const survey_t *survey)
{
    uint8_t bytes[256];
    uint32_t all = 0;
    const uint64_t end_us = now_us(survey) + TAIL_US;
    size_t count = 0;
    do {
        count = receive(survey, bytes, sizeof bytes, now_us(survey) + QUIET_US);
        all += (uint32_t)count;
    } while (count > 0 && now_us(survey) < end_us);
    return all;
}

/* -------------------------------------------------------------------------------------- replies */

static void take_reply(survey_reply_t *reply, const uint8_t *bytes, size_t count, uint64_t after_us)
{
    const size_t kept = reply->count < sizeof reply->bytes ? reply->count : sizeof reply->bytes;
    const size_t room = sizeof reply->bytes - kept;
    reply->after_us = reply->count == 0 ? after_us : reply->after_us;
    memcpy(reply->bytes + kept, bytes, count < room ? count : room);
    reply->count += count;
}

static bool is_whole(const survey_reply_t *reply)
{
    return reply->count >= 7 && reply->bytes[0] == 0xA5 && reply->bytes[1] == 0x5A &&
           reply->count >= 7u + reply->bytes[2];
}

static survey_reply_t ask(const survey_t *survey, tmini_command_code_t code, uint64_t timeout_us)
{
    survey_reply_t reply = {.count = 0};
    const uint64_t begun_us = now_us(survey);
    uint8_t bytes[256];
    size_t count = 0;
    send(survey, code);
    do {
        count = receive(survey, bytes, sizeof bytes, begun_us + timeout_us);
        take_reply(&reply, bytes, count, now_us(survey) - begun_us);
    } while (count > 0 && !is_whole(&reply));
    return reply;
}

const uint8_t *survey_content(const survey_reply_t *reply, uint8_t type, size_t size)
{
    const uint8_t *const bytes = reply->bytes;
    const bool is_it = is_whole(reply) && bytes[2] == size && bytes[3] == 0 && bytes[4] == 0 &&
                       bytes[5] == 0 && bytes[6] == type;
    return is_it ? bytes + 7 : NULL;
}

/* ------------------------------------------------------------------------------------ frequency */

static uint32_t step(survey_t *survey, tmini_command_code_t code)
{
    const survey_reply_t reply = ask(survey, code, REPLY_US);
    const uint8_t *const content = survey_content(&reply, 0x04, TMINI_FREQUENCY_SIZE);
    return content != NULL ? tmini_reply_frequency_chz(content) : 0;
}

/* Changes the frequency as far as possible by coarse steps, then by fine ones. */
static uint32_t push(survey_t *survey, tmini_command_code_t coarse, tmini_command_code_t fine)
{
    const tmini_command_code_t codes[2] = {coarse, fine};
    uint32_t reached = 0;
    for (size_t i = 0; i < 2; i++) {
        uint32_t before = reached;
        reached = step(survey, codes[i]);
        for (unsigned j = 0; j < STEPS_MAX && reached != before && reached < BEYOND_CHZ; j++) {
            before = reached;
            reached = step(survey, codes[i]);
        }
    }
    return reached;
}

static void set_frequency(survey_t *survey, uint32_t wanted_chz)
{
    uint32_t is_chz = step(survey, TMINI_COMMAND_GET_FREQUENCY);
    uint32_t before_chz = 0;
    for (unsigned i = 0; i < 2 * STEPS_MAX && is_chz != 0 && is_chz != wanted_chz; i++) {
        if (is_chz == before_chz) {
            return; /* It is refused. */
        }
        before_chz = is_chz;
        const uint32_t off_chz = is_chz < wanted_chz ? wanted_chz - is_chz : is_chz - wanted_chz;
        const bool is_far = off_chz >= 100;
        is_chz =
            step(survey, is_chz < wanted_chz
                             ? (is_far ? TMINI_COMMAND_FASTER_ONE : TMINI_COMMAND_FASTER_TENTH)
                             : (is_far ? TMINI_COMMAND_SLOWER_ONE : TMINI_COMMAND_SLOWER_TENTH));
    }
}

static void try_steps(survey_t *survey)
{
    const uint32_t set_chz = survey->frequency_chz;
    const uint32_t seen[4] = {
        step(survey, TMINI_COMMAND_FASTER_TENTH), step(survey, TMINI_COMMAND_SLOWER_TENTH),
        step(survey, TMINI_COMMAND_FASTER_ONE), step(survey, TMINI_COMMAND_SLOWER_ONE)};
    const bool comes_back = seen[1] == set_chz && seen[3] == set_chz;
    survey->steps = seen[0] == set_chz + 10 && seen[2] == set_chz + 100 && comes_back
                        ? SURVEY_STEPS_OBEYED
                    : seen[0] == set_chz && seen[2] == set_chz && comes_back ? SURVEY_STEPS_REFUSED
                                                                             : SURVEY_STEPS_OTHER;
    if (survey->steps == SURVEY_STEPS_OBEYED) {
        survey->max_chz = push(survey, TMINI_COMMAND_FASTER_ONE, TMINI_COMMAND_FASTER_TENTH);
        survey->min_chz = push(survey, TMINI_COMMAND_SLOWER_ONE, TMINI_COMMAND_SLOWER_TENTH);
        set_frequency(survey, set_chz);
    }
}

/* --------------------------------------------------------------------------------------- reboot */

/* Reboots the unit, then repeats a query until it is answered. */
static void reboot(survey_t *survey)
{
    const uint64_t begun_us = now_us(survey);
    const uint32_t usual_ms = (uint32_t)(survey->info.after_us / MS);
    const uint32_t late_ms = usual_ms - usual_ms % BOOT_STEP_MS; /* The answer is to an earlier
                                                                  * query. */
    send(survey, TMINI_COMMAND_REBOOT);
    for (uint32_t ms = BOOT_FIRST_MS; ms < BOOT_MS && survey->boot_ms == 0; ms += BOOT_STEP_MS) {
        uint8_t bytes[256];
        uint64_t until_us = begun_us + (uint64_t)ms * MS;
        size_t count = 0;
        while ((count = receive(survey, bytes, sizeof bytes, until_us)) > 0) {
            survey->unasked_bytes += (uint32_t)count;
        }
        const survey_reply_t reply = ask(survey, TMINI_COMMAND_GET_INFO, (BOOT_STEP_MS - 1) * MS);
        if (survey_content(&reply, 0x04, TMINI_INFO_SIZE) != NULL) {
            survey->boot_ms = ms - late_ms;
        } else {
            survey->unasked_bytes += (uint32_t)reply.count;
        }
        if (is_over(survey)) {
            return;
        }
    }
}

static void try_reboot(survey_t *survey)
{
    if (survey->steps == SURVEY_STEPS_OBEYED) {
        set_frequency(survey, survey->frequency_chz + 100);
        survey->changed_chz = step(survey, TMINI_COMMAND_GET_FREQUENCY);
    }
    reboot(survey);
    (void)drain(survey);
    if (survey->steps == SURVEY_STEPS_OBEYED && survey->boot_ms > 0) {
        survey->kept_chz = step(survey, TMINI_COMMAND_GET_FREQUENCY);
    }
}

/* ------------------------------------------------------------------------------------- scanning */

static void keep_sample(survey_scan_t *scan, const uint8_t *bytes, size_t count)
{
    const size_t room = sizeof scan->sample - scan->sample_count;
    const size_t kept = count < room ? count : room;
    memcpy(scan->sample + scan->sample_count, bytes, kept);
    scan->sample_count += kept;
}

/* Receives until `end_us`, or until the line has been quiet for `quiet_us`. */
static void listen(survey_t *survey, survey_scan_t *scan, uint64_t end_us, uint64_t quiet_us)
{
    uint8_t bytes[256];
    bool is_quiet = false;
    while (!is_quiet && now_us(survey) < end_us && !is_over(survey)) {
        const uint64_t silent_us = now_us(survey) + quiet_us;
        const size_t count =
            receive(survey, bytes, sizeof bytes, silent_us < end_us ? silent_us : end_us);
        const uint64_t at_us = now_us(survey);
        is_quiet = count == 0 && at_us >= silent_us;
        if (count > 0) {
            take_reply(&scan->reply, bytes, count, at_us - scan->start_us);
            keep_sample(scan, bytes, count);
            survey_scan_feed(scan, bytes, count, at_us);
            scan->last_us = at_us;
        }
    }
}

static void scan_at(survey_t *survey, survey_scan_t *scan, uint32_t chz, uint32_t seconds)
{
    if (is_over(survey)) {
        return;
    }
    if (survey->steps == SURVEY_STEPS_OBEYED) {
        set_frequency(survey, chz);
    }
    survey_scan_begin(scan, (uint16_t)step(survey, TMINI_COMMAND_GET_FREQUENCY), now_us(survey));
    send(survey, TMINI_COMMAND_START);
    listen(survey, scan, scan->start_us + (uint64_t)seconds * S, seconds * (uint64_t)S);
    scan->last_us = scan->stop_us = now_us(survey);
    send(survey, TMINI_COMMAND_STOP);
    listen(survey, scan, scan->stop_us + TAIL_US, QUIET_US);
}

void survey_restore(survey_t *survey)
{
    send(survey, TMINI_COMMAND_STOP);
    (void)drain(survey);
    if (survey->frequency_chz > 0) {
        set_frequency(survey, survey->frequency_chz);
    }
}

bool survey_run(survey_t *survey, const survey_wire_t *wire, uint32_t seconds)
{
    const uint32_t fast_s = seconds < FAST_S ? seconds : FAST_S;
    *survey = (survey_t){.wire = wire};
    say(survey, "asking it what it is");
    send(survey, TMINI_COMMAND_STOP);
    (void)drain(survey);
    survey->stop = ask(survey, TMINI_COMMAND_STOP, QUIET_US);
    survey->info = ask(survey, TMINI_COMMAND_GET_INFO, REPLY_US);
    survey->health = ask(survey, TMINI_COMMAND_GET_HEALTH, REPLY_US);
    survey->frequency = ask(survey, TMINI_COMMAND_GET_FREQUENCY, REPLY_US);
    if (survey->info.count + survey->health.count + survey->frequency.count == 0) {
        return false;
    }
    const uint8_t *const content = survey_content(&survey->frequency, 0x04, TMINI_FREQUENCY_SIZE);
    if (content != NULL) {
        survey->frequency_chz = tmini_reply_frequency_chz(content);
        say(survey, "stepping its frequency");
        try_steps(survey);
    }
    say(survey, "rebooting it (up to 15 s)");
    try_reboot(survey);
    say(survey, "scanning at 6 Hz");
    scan_at(survey, &survey->scans[SURVEY_SLOW], 600, seconds);
    say(survey, "scanning at 10 Hz");
    scan_at(survey, &survey->scans[SURVEY_MEDIUM], 1000, fast_s);
    say(survey, "scanning at 12 Hz");
    scan_at(survey, &survey->scans[SURVEY_FAST], 1200, fast_s);
    survey_restore(survey);
    return !is_over(survey);
}

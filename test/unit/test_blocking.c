/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The commands that wait. Each call of the port's `wait` lets a millisecond pass. They are told in
 * tales (tale.h), which here know these words as well:
 *
 *     in:5:info       5 ms from now this comes; turn: a turn; each:160: so do further turns or so
 *     answers:600     what a repeated question is answered, after a millisecond
 *     read-info:100 read-health:100 read-frequency:100 set-to:640:100 start:100 stop:100
 *                     the blocking command, for at most 100 ms
 *     waited:5        the calls of `wait` so far
 *     model:151 serial:4 error:0x10 code:0x1234 chz:640   the last results; at first 1 to 5
 *     no-lidar:1 no-result:1  commands are called with NULL for this
 *     no-wait runs    the port has no `wait`; its clock goes on whenever it is read
 *     half writes:2   the port takes A5, and then nothing; how often it was to write */

#include "tale.h"

#include "tmini/tmini_blocking.h"
#include "tmini_driver.h"

#include <stdlib.h>
#include <string.h>

#define COMING_MAX 3

static struct {
    uint32_t at_ms[COMING_MAX];
    char words[COMING_MAX][16];
    unsigned count;
    uint32_t every_ms; /* How often the last of these comes; 0: once. */
    bool no_lidar;
    bool no_result;
    uint32_t waited;
    unsigned writes;
    uint16_t answer_chz;
    tmini_info_t info;
    tmini_health_t health;
    uint16_t frequency_chz;
} script;

static void come(const char *word)
{
    if (strcmp(word, "turn") == 0 || strcmp(word, "turns") == 0) {
        rig_feed_plain_turn(1000);
    } else {
        tale_feed(word);
    }
    if (strcmp(word, "turns") == 0) {
        rig_feed_plain_turn(1000);
    }
}

static void wait(void *context)
{
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    script.waited++;
    rig.now_ms++;
    if (script.answer_chz > 0 && rig.lidar.command.phase == TMINI_PHASE_ASKING) {
        rig_feed_frequency(script.answer_chz);
    }
    for (unsigned i = 0; i < script.count; i++) {
        if (rig.now_ms == script.at_ms[i]) {
            come(script.words[i]);
            script.at_ms[i] += i == script.count - 1 ? script.every_ms : 0;
        }
    }
}

static void plan(const char *ms)
{
    const char *const word = strchr(ms, ':') + 1;
    TEST_ASSERT_TRUE(script.count < COMING_MAX && strlen(word) < sizeof script.words[0]);
    script.at_ms[script.count] = rig.now_ms + (uint32_t)atol(ms);
    memcpy(script.words[script.count++], word, strlen(word) + 1);
}

static uint32_t running_clock(void *context)
{
    (void)context;
    return rig.now_ms++;
}

static int take_one_byte(void *context, const uint8_t *bytes, size_t count)
{
    TEST_ASSERT_EQUAL_HEX8(script.writes == 0 ? 0xA5 : 0x90, bytes[0]);
    (void)context;
    (void)count;
    return script.writes++ == 0 ? 1 : 0;
}

/* Whether the word is a command; if it is, carries it out. */
static bool command(const char *word, int *status)
{
    tmini_t *const lidar = script.no_lidar ? NULL : &rig.lidar;
    const uint32_t ms = row_number(word);
    if (row_text(word)[0] == '\0') {
        return false;
    } else if (row_is(word, "read-info")) {
        *status = tmini_blocking_read_info(lidar, script.no_result ? NULL : &script.info, ms);
    } else if (row_is(word, "read-health")) {
        *status = tmini_blocking_read_health(lidar, script.no_result ? NULL : &script.health, ms);
    } else if (row_is(word, "read-frequency")) {
        *status = tmini_blocking_read_frequency(
            lidar, script.no_result ? NULL : &script.frequency_chz, ms);
    } else if (row_is(word, "set-to")) {
        *status = tmini_blocking_set_frequency(lidar, (uint16_t)ms, row_number(row_text(word)));
    } else if (row_is(word, "start")) {
        *status = tmini_blocking_start(lidar, ms);
    } else if (row_is(word, "stop")) {
        *status = tmini_blocking_stop(lidar, ms);
    } else {
        return false;
    }
    return true;
}

static bool tell(char *word)
{
    char *const wanted = strchr(word, '=');
    const row_number_t results[] = {
        {"waited", script.waited},          {"model", script.info.model},
        {"serial", script.info.serial[15]}, {"error", script.health.faults},
        {"code", script.health.error_code}, {"chz", script.frequency_chz},
        {"writes", script.writes},
    };
    const row_member_t members[] = {
        {"each", MEMBER(script.every_ms)},
        {"answers", MEMBER(script.answer_chz)},
        {"no-lidar", MEMBER(script.no_lidar)},
        {"no-result", MEMBER(script.no_result)},
    };
    int status;
    if (row_is(word, "in")) {
        tale_set_up();
        plan(row_text(word));
    } else if (row_is(word, "no-wait")) {
        rig.port.wait = NULL;
    } else if (row_is(word, "half")) {
        rig.port.write = take_one_byte;
    } else if (row_is(word, "runs")) {
        rig.port.now_ms = running_clock;
    } else if (command(word, &status)) {
        tale_expect_status(wanted != NULL ? wanted + 1 : NULL, status);
    } else {
        return row_stores(word, members) || row_expects(word, results);
    }
    return true;
}

void setUp(void)
{
    memset(&script, 0, sizeof script);
    script.info.model = 1;
    script.info.serial[15] = 2;
    script.health = (tmini_health_t){.faults = 3, .error_code = 4};
    script.frequency_chz = 5;
    tale_words = tell;
    tale_wait = wait;
    tale_begin();
}

void tearDown(void)
{
    tale_end();
}

static const row_t tales[] IN_FLASH = {
    ROW(info_is_read, "idle in:5:info read-info:100 >90 model:151 serial:4 waited:5 @IDLE"),
    ROW(health_is_read, "idle in:5:health:0x10 read-health:100 >92 error:0x10 code:0x1234"),
    ROW(the_frequency_is_read, "idle in:5:640 read-frequency:100 >0D chz:640"),
    ROW(the_frequency_is_set, "idle in:5:640 set-to:640:100 >0D #640"),
    ROW(an_idle_lidar_is_asked_in_any_case,
        "idle in:5:640 each:5 set-to:640:100 >0D set-to:640:100 >0D waited:10"),
    ROW(a_frequency_that_an_idle_lidar_does_not_take_says_why,
        "idle in:5:99 set-to:640:100=REPLY >0D waited:5"),
    ROW(a_frequency_that_is_there_already_is_not_waited_for_while_scanning,
        "idle in:5:640 set-to:640:100 >0D start >0D <640 !FREQUENCY >60 <P !STARTED set-to:640:100 "
        "waited:5 @SCANNING"),
    ROW(a_frequency_that_could_not_be_set_is_not_waited_for_while_scanning, /* It is not tried. */
        "wish:640 start >65 +50 >0D <99 >65 +50 >60 <P !STARTED set-to:640:100=STATE !FAILED "
        "waited:0 @SCANNING"),
    ROW(a_frequency_that_a_lost_lidar_refuses_is_waited_for_until_it_scans_again,
        "scans +1000 !LOST >65 in:55:99 in:115:S set-to:640:8000=REPLY >0D >65 >60 waited:115 "
        "@SCANNING !RECOVERED"),
    ROW(the_same_frequency_is_not_waited_for_once_it_has_been_set, /* It is still starting. */
        "wish:640 idle start >0D <640 !FREQUENCY set-to:640:100 waited:0 @STARTING >60"),
    ROW(the_same_frequency_is_waited_for_while_a_start_asks_for_it,
        "wish:640 idle start >0D in:5:640 set-to:640:100 waited:5 >60"),
    ROW(a_frequency_is_waited_for_though_an_attempt_to_start_fails,
        "idle start >0D <600 >60 in:2560:700 set-to:700:4000 >65 >0D >60 #700"),
    ROW(a_frequency_waits_for_the_end_of_another_command,
        "idle info >90 in:5:info answers:600 set-to:600:100 >0D @IDLE"),
    ROW(a_frequency_of_a_scanning_lidar_is_waited_for,
        "scans in:10:S each:100 answers:640 set-to:640:1000 >65 >0D @STARTING >60"),
    ROW(a_frequency_is_not_waited_for_when_nothing_recovers_the_lidar,
        "off scans +1000 !LOST set-to:640:100=STATE waited:0 @RECOVERING"),
    /* ---- Start and stop ---- */
    ROW(a_start_waits_for_the_first_scan,
        "idle in:10:turn each:160 answers:600 start:1000 >0D >60 waited:170 count:17 @SCANNING"),
    ROW(a_start_waits_for_a_scan_though_the_frequency_was_refused,
        "wish:640 idle in:55:99 in:115:turn each:60 start:8000 >0D >65 >60"),
    ROW(it_does_not_wait_while_there_are_events,
        "idle in:10:turns answers:600 start:1000 >0D >60 waited:10"),
    ROW(a_start_waits_for_the_first_packet_when_streaming, /* And again: it is wanted still. */
        "packets in:60:scan answers:600 start:100=TIMEOUT >65 >0D >60 in:60:turn start:100 drain"),
    ROW(a_start_that_times_out_during_a_recovery_is_kept, /* It is lost after a second. */
        "idle in:10:turn answers:600 start:1500=TIMEOUT >0D >60 >65 >0D >60 @RECOVERING"),
    ROW(a_start_of_a_lost_lidar_waits_for_a_scan_and_not_for_the_recovery,
        "scans +1000 !LOST >65 in:60:turn each:10 answers:600 start:1500 >0D >60 recoveries:1 "
        "scans:1"),
    ROW(a_start_that_times_out_does_not_end_an_earlier_query,
        "idle info >90 start:100=TIMEOUT @STARTING"),
    ROW(a_stop_waits_for_a_quiet_line, "idle stop:100 >65 waited:50 @IDLE"),
    ROW(a_stop_still_waits_after_the_end_of_the_command_that_it_aborts,
        "idle info >90 stop:100 >65 @IDLE"),
    ROW(events_that_do_not_belong_to_the_command_are_swallowed, /* A fault and a scan. */
        "starts 2( <blind drain ) <blind stop:100 >65 !NONE"),
    /* ---- Failures ---- */
    ROW(a_timeout_gives_the_command_up_and_the_next_one_stops_the_lidar_first,
        "idle read-info:100=TIMEOUT >90 waited:100 @UNKNOWN !NONE in:55:info read-info:100 >65 "
        ">90 / idle read-frequency:100=TIMEOUT >0D @UNKNOWN"),
    ROW(a_wait_may_be_longer_than_a_minute, /* 70,000 ms are 4464 in 16 bits. */
        "reply:0 idle read-info:70000=TIMEOUT >90 waited:70000"),
    ROW(time_runs_across_the_clocks_wrap_around,
        "idle clock:-51 read-info:100=TIMEOUT >90 waited:100"),
    ROW(with_a_timeout_of_0_it_polls_once, "no-wait idle read-info:0=TIMEOUT >90"),
    ROW(a_port_without_wait_is_polled_without_a_pause, "idle no-wait runs stop:1000 >65 waited:0"),
    ROW(a_stop_that_times_out_still_stands, "idle stop:10=TIMEOUT >65 @STOPPING"),
    ROW(a_question_that_waits_is_withdrawn_and_the_one_under_way_is_not,
        "idle health >92 read-info:10=TIMEOUT <health !HEALTH @IDLE"),
    ROW(after_a_question_that_is_withdrawn_the_next_one_is_asked,
        "stop >65 health read-info:60=TIMEOUT >90 >65 ~50 >92 <health !HEALTH"),
    ROW(a_result_is_not_touched_by_a_failure,
        "idle read-info:10=TIMEOUT >90 read-health:10=TIMEOUT >65 read-frequency:10=TIMEOUT >65 "
        "model:1 serial:2 error:3 code:4 chz:5"),
    ROW(a_command_that_fails_says_why, "idle takes:-1 read-info:100=WRITE"),
    ROW(a_command_that_uses_up_its_attempts_says_why,
        "idle read-info:8000=TIMEOUT >90 >65 >90 >65 >90 ?TIMEOUT"),
    ROW(a_stop_that_fails_after_aborting_says_why, "idle info >90 takes:-1 stop:100=WRITE"),
    ROW(a_command_that_cannot_be_begun_does_not_wait,
        "scans read-info:100=STATE read-health:100=STATE read-frequency:100=STATE waited:0 "
        "@SCANNING"),
    ROW(a_command_given_up_half_sent_is_not_sent_any_further,
        "idle half read-info:0=TIMEOUT drain writes:2"),
    ROW(every_command_needs_a_lidar,
        "idle no-lidar:1 read-info:100=ARGUMENT read-health:100=ARGUMENT "
        "read-frequency:100=ARGUMENT "
        "set-to:700:100=ARGUMENT start:100=ARGUMENT stop:100=ARGUMENT @IDLE"),
    ROW(a_question_needs_a_place_for_its_answer,
        "idle no-result:1 read-info:100=ARGUMENT read-health:100=ARGUMENT "
        "read-frequency:100=ARGUMENT @IDLE"),
};

void test_tales(void)
{
    run_rows(tales, tale_tell_row);
}

/* ---- Other clocks ---- */

static int looks_left; /* Clock readings until it steps back. */
static uint32_t back_ms;

static uint32_t jumping_clock(void *context)
{
    (void)context;
    return rig.now_ms - (looks_left-- > 0 ? 0 : back_ms);
}

static void open_with_clock_back(uint32_t ms, int looks)
{
    setUp();
    tale_tell("idle");
    back_ms = ms;
    looks_left = looks;
    rig.port.now_ms = jumping_clock;
}

void test_a_clock_that_steps_back_ends_no_waiting(void)
{
    static const uint32_t backs_ms[] = {2, 100, 5000};
    for (int i = 0; i < 24; i++) {
        open_with_clock_back(backs_ms[i / 8], 1 + i % 8);
        plan("55:info");
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&rig.lidar, &script.info, 70000));
        tale_tell(">90");
    }
}

void test_a_clock_set_back_by_an_hour_prolongs_a_waiting_by_its_own_length_at_most(void)
{
    for (int looks = 1; looks < 2000; looks += 100) {
        open_with_clock_back(3600000, looks);
        rig.timing.reply_timeout_ms = 0;
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT,
                              tmini_blocking_read_info(&rig.lidar, &script.info, 1000));
        TEST_ASSERT_UINT32_WITHIN(500, 1500, script.waited);
        tale_tell(">90");
    }
}

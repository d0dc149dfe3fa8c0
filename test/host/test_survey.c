/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The survey of the simulated lidar, in virtual time: a documented unit is as expected, each
 * deviation is reported, and a lidar simulated from a report gives the same report. */

#include "like.h"
#include "rows.h"
#include "survey.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define REPORT_FILE "test_survey.report"
#define LIKE_FILE "test_survey.like"

static unsigned lost_every; /* One in this many bytes is lost on the line; 0: none. */
static unsigned sent;
static sim_t device;
static uint64_t time_us;
static survey_t survey;
static char report[8192];
static char first[sizeof report];

void setUp(void)
{
    lost_every = 0;
}

void tearDown(void)
{
    (void)remove(REPORT_FILE);
    (void)remove(LIKE_FILE);
}

static uint64_t now_us(void *context)
{
    (void)context;
    return time_us;
}

static void send_bytes(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    sim_receive(&device, bytes, count, time_us);
}

static size_t lose_some(uint8_t *bytes, size_t count)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        if (lost_every == 0 || ++sent % lost_every != 0) {
            bytes[kept++] = bytes[i];
        }
    }
    return kept;
}

/* Returns at the microsecond at which bytes come, or at `until_us`. */
static size_t receive(void *context, uint8_t *bytes, size_t max, uint64_t until_us)
{
    size_t count = 0;
    (void)context;
    while (count == 0 && time_us < until_us) {
        const uint64_t next_us = sim_next_us(&device);
        const uint64_t soon_us = next_us < until_us ? next_us : until_us;
        time_us = soon_us > time_us ? soon_us : time_us;
        count = lose_some(bytes, sim_transmit(&device, time_us, bytes, max));
        time_us += count == 0 && soon_us == next_us ? 1 : 0;
    }
    return count;
}

static bool is_over(void *context)
{
    (void)context;
    return false;
}

static void say(void *context, const char *text)
{
    (void)context;
    (void)text;
}

static const survey_wire_t wire = {
    .now_us = now_us, .send = send_bytes, .receive = receive, .is_over = is_over, .say = say};

static void read_report(bool with_serial)
{
    FILE *const file = fopen(REPORT_FILE, "w+");
    TEST_ASSERT_NOT_NULL(file);
    survey_print_report(&survey, file, with_serial);
    rewind(file);
    report[fread(report, 1, sizeof report - 1, file)] = '\0';
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

/* Surveys a documented lidar, changed by this report; its own report is then in REPORT_FILE and in
 * `report`. */
static void survey_like(const char *path, bool is_covered, unsigned seed)
{
    options_t options = {.device = sim_default_config()};
    options.device.seed = seed;
    TEST_ASSERT_TRUE_MESSAGE(like_read(&options, path), path);
    time_us = 0;
    sim_init(&device, &options.device);
    sim_set_health(&device, options.health);
    sim_cover_window(&device, is_covered);
    TEST_ASSERT_TRUE(survey_run(&survey, &wire, SURVEY_SECONDS));
    read_report(false);
}

static void write_like(const char *text)
{
    FILE *const file = fopen(LIKE_FILE, "w");
    TEST_ASSERT_NOT_NULL(file);
    (void)fputs(text, file);
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

/* The same with the text before " > ". "lost_every" and "covered" are the line's and the window's,
 * and like_read() ignores them, as all that it does not know. Returns the text after " > ". */
static const char *survey_row(const row_t *row)
{
    char text[200];
    const char *const expected = strstr(row->steps, " > ") + 3;
    (void)snprintf(text, sizeof text,
                   "# as written by hand\n%.*s\nno_such_key = 1\nboot_ms = unknown\n",
                   (int)(expected - 3 - row->steps), row->steps);
    for (char *end = strstr(text, "; "); end != NULL; end = strstr(end, "; ")) {
        *end = '\n';
    }
    write_like(text);
    const char *const lost = strstr(text, "lost_every = ");
    lost_every = lost != NULL ? (unsigned)atoi(lost + 13) : lost_every;
    survey_like(LIKE_FILE, strstr(text, "covered") != NULL, sim_default_config().seed);
    return expected;
}

/* --------------------------------------------------------------------------------- one report */

/* "What the lidar is like > lines of the report": whole ones, but of those with # the beginning.
 * What begins with ! is not in the report. */
static void run_once(const row_t *row)
{
    const char *lines = survey_row(row);
    while (*lines != '\0') {
        char line[120];
        const size_t length = strcspn(lines, ";");
        (void)snprintf(line, sizeof line, "\n%.*s%s", (int)length, lines,
                       *lines == '#' ? "" : "\n");
        if (*lines == '!') {
            line[length + 1] = '\0';
            TEST_ASSERT_NULL_MESSAGE(strstr(report, line + 2), report);
        } else {
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(report, line), line);
        }
        lines += length + strspn(lines + length, "; ");
    }
}

/* clang-format off */
static const row_t reports[] = {
    ROW(a_documented_unit_is_reported_as_documented,
        "model = 151 > !# differs; model = 151; firmware = 1.2; frequency_hz = 6.00;"
        " min_frequency_hz = 5.00; max_frequency_hz = 12.00; reply_ms = 3; boot_ms = 2500;"
        " first_packet_ms = 200; spin_up_ms = 1000; spin_up_percent = 40; stop_tail_ms = 50;"
        " samples_per_second = 4000; points_slow = 670; flagged_permille = 5;"
        " reply_92 = A5 5A 03 00 00 00 06 00 00 00; reply_60 = A5 5A 05 00 00 40 81"),
    /* It is 2026031700012345. */
    ROW(the_serial_number_is_left_out,
        "model = 151 > reply_90 = A5 5A 14 00 00 00 04 97 02 01 01 ** ** ** ** ** ** ** ** ** **"
        " ** ** ** ** ** **; !12345"),
    /* A covered window is a live data fault (section 7): only the stream reports it. */
    ROW(a_live_fault_does_not_change_the_index_of_the_health,
        "model = 151; covered = yes > health = 0; health_index = 3"),
    /* The bytes are lost on the line, so the unit's properties are still found. Three turns of four
     * lack a packet. */
    ROW(a_damaged_line_does_not_look_like_another_unit,
        "model = 151; lost_every = 3001 > # differs     9.12  places with stray bytes ;"
        " motor_percent = 100; spin_up_ms = 1000; samples_per_second = 4000; points_slow = 670;"
        " points_medium = 400; points_fast = 330; last_crc = right"),
    /* Here each turn lacks two packets. */
    ROW(what_a_damaged_line_hides_is_unknown,
        "model = 151; lost_every = 997 > motor_percent = unknown; points_slow = unknown;"
        " last_crc = unknown; samples_per_second = 4000"),
    ROW(a_turn_that_begins_without_a_start_packet_is_reported,
        "first_packets = unmarked; first_angle_deg = 330 > first_packets = unmarked;"
        " first_angle_deg = 330"),
    ROW(without_lone_packets_it_says_so, "lone_packets = no > lone_packets = unknown"),
    ROW(without_an_answer_after_the_reboot, "boot_ms = 60000 > frequency_survives = unknown"),
};
/* clang-format on */

void test_reports(void)
{
    run_rows(reports, run_once);
}

void test_the_serial_number_is_reported_if_it_is_wanted(void)
{
    write_like("model = 151\n");
    survey_like(LIKE_FILE, false, 1);
    read_report(true);
    TEST_ASSERT_NOT_NULL(strstr(report, "\nserial = 2026031700012345\n"));
    TEST_ASSERT_NOT_NULL(strstr(report, " 01 02 03 04 05\n"));
}

/* --------------------------------------------------------------------------------- deviations */

/* Removes lines that depend on chance: whether one of the LastCRC bytes is AA. */
static void remove_chance(char *text)
{
    static const char *const marks[] = {"LastCRC of AA", "last_crc_aa"};
    for (size_t i = 0; i < 2; i++) {
        char *const at = strstr(text, marks[i]);
        TEST_ASSERT_NOT_NULL(at);
        char *begin = at;
        while (begin[-1] != '\n') {
            begin--;
        }
        const char *const next = strchr(at, '\n') + 1;
        memmove(begin, next, strlen(next) + 1);
    }
}

/* "What the lidar is like > the line that reports it": the deviation is seen, and a lidar simulated
 * from that report gives the same report. */
static void run_twice(const row_t *row)
{
    char line[100];
    (void)snprintf(line, sizeof line, "\n# differs     %s ", survey_row(row));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(report, line), report);
    memcpy(first, report, sizeof first);
    remove_chance(first);
    survey_like(REPORT_FILE, false, 7);
    remove_chance(report);
    TEST_ASSERT_EQUAL_STRING(first, report);
}

/* clang-format off */
static const row_t deviations[] = {
    ROW(another_model_is_reported, "model = 150 > 9.15  model                          150"),
    ROW(the_order_of_the_firmwares_bytes_is_reported,
        "firmware_order = major-first > 9.4   firmware's bytes               major-first"),
    ROW(the_form_of_the_serial_number_is_reported,
        "serial_digits = ascii > 9.5   serial number's digits         ascii"),
    ROW(a_unit_that_is_not_well_is_reported,
        "health = 16 > 4     health, 0 is well              16"),
    ROW(late_replies_are_reported, "reply_ms = 400 > 9.11  time to a reply, ms            400"),
    ROW(another_first_frequency_is_reported,
        "frequency_hz = 7 > 1     frequency at first, Hz         7.00"),
    ROW(refused_steps_are_reported,
        "steps = refused > 3     frequency commands             refused"),
    ROW(a_lower_lowest_frequency_is_reported,
        "min_frequency_hz = 4 > 1     lowest frequency, Hz           4.00"),
    ROW(a_higher_highest_frequency_is_reported,
        "max_frequency_hz = 15 > 1     highest frequency, Hz          15.00"),
    ROW(a_frequency_that_survives_a_reboot_is_reported,
        "frequency_survives = yes > 3     frequency survives reboot      yes"),
    ROW(a_slow_reboot_is_reported, "boot_ms = 8000 > 9.11  time of a reboot, ms           8000"),
    ROW(late_first_packets_are_reported,
        "first_packet_ms = 2500 > 9.11  first packet after reply, ms   2500"),
    ROW(a_start_packet_that_comes_first_is_reported,
        "first_packets = start > 9.8   first packets begin            start"),
    ROW(a_slow_spin_up_is_reported,
        "spin_up_ms = 6000 > 9.8   spin-up, ms                    6000"),
    ROW(a_slow_motor_is_reported, "motor_percent = 80 > 9.7   measured of set speed, percent 80"),
    ROW(a_long_tail_is_reported, "stop_tail_ms = 500 > 9.10  tail after a stop, ms          500"),
    ROW(small_packets_are_reported,
        "samples_per_packet = 32 > 9.6   samples of a full packet       32"),
    ROW(another_angle_of_start_packets_is_reported,
        "start_angle_deg = 116 > 9.8   start packet's angle, degrees  116"),
    ROW(flagged_samples_are_reported,
        "flagged_permille = 1000 > 9.9   samples flagged, permille      1000"),
    ROW(no_ct_information_is_reported,
        "ct_information = no > 9.1   CT information                 no"),
    ROW(no_last_crc_is_reported,
        "ct_information = no > 9.1   LastCRC                        absent"),
    ROW(another_version_of_the_protocol_is_reported,
        "user_version = 2.1 > 7     protocol's version             2.1"),
};
/* clang-format on */

void test_deviations(void)
{
    run_rows(deviations, run_twice);
}

/* "key=value" */
static void refuse_like(char *word)
{
    options_t options = {.device = sim_default_config()};
    char line[ROW_WORD_MAX + 4];
    char *const value = strchr(word, '=');
    *value = '\0';
    (void)snprintf(line, sizeof line, "%s = %s\n", word, value + 1);
    write_like(line);
    TEST_ASSERT_FALSE_MESSAGE(like_read(&options, LIKE_FILE), line);
}

void test_a_file_that_is_no_report_is_refused(void)
{
    options_t options = {.device = sim_default_config()};
    row_tell("boot_ms=soon model=256 hardware=256 health=64 health=-1 frequency_hz=20.1 "
             "min_frequency_hz=20.1 max_frequency_hz=20.1 reply_ms=10001 boot_ms=60001 "
             "first_packet_ms=60001 spin_up_ms=60001 spin_up_percent=101 motor_percent=201 "
             "stop_tail_ms=60001 first_angle_deg=360 start_angle_deg=360 samples_per_packet=41 "
             "flagged_permille=1001",
             refuse_like);
    TEST_ASSERT_FALSE(like_read(&options, "no/such/report"));
    TEST_ASSERT_FALSE(like_read(&options, "/dev/null"));
    TEST_ASSERT_FALSE(like_read(&options, "/"));
}

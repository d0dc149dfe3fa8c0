/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The survey of the simulated lidar, in virtual time: a documented unit is as expected, each
 * deviation is reported, and a lidar simulated from a report gives the same report. */

#define _POSIX_C_SOURCE 200809L

#include "like.h"
#include "rows.h"
#include "survey.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Temporary files. */
static char report_file[] = "/tmp/tmini-report.XXXXXX";
static char like_file[] = "/tmp/tmini-like.XXXXXX";

static unsigned lost_every; /* One in this many bytes is lost on the line; 0: none. */
static unsigned sent;
static sim_t device;
static uint64_t time_us;
static survey_t survey;
static char report[8192];
static char first[sizeof report];

static void make_file(char *name)
{
    memcpy(name + strlen(name) - 6, "XXXXXX", 6);
    const int fd = mkstemp(name);
    TEST_ASSERT_TRUE(fd >= 0);
    TEST_ASSERT_EQUAL_INT(0, close(fd));
}

void setUp(void)
{
    lost_every = 0;
    make_file(report_file);
    make_file(like_file);
}

void tearDown(void)
{
    (void)remove(report_file);
    (void)remove(like_file);
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

static options_t documented(void)
{
    options_t options = {.device = sim_default_config()};
    return options;
}

static void read_report(bool with_serial)
{
    FILE *const file = fopen(report_file, "w+");
    TEST_ASSERT_NOT_NULL(file);
    survey_print_report(&survey, file, with_serial);
    rewind(file);
    report[fread(report, 1, sizeof report - 1, file)] = '\0';
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

/* Surveys a lidar with these options; the report is then in report_file and in `report`. */
static void survey_of(const options_t *options)
{
    time_us = 0;
    sim_init(&device, &options->device);
    sim_set_health(&device, options->health);
    sim_cover_window(&device, options->covered);
    TEST_ASSERT_TRUE(survey_run(&survey, &wire, SURVEY_SECONDS));
    read_report(false);
}

/* The report has these lines; between them is "; ". */
static void expect(const char *lines)
{
    while (*lines != '\0') {
        char line[120];
        const char *const end = strstr(lines, "; ");
        const size_t length = end != NULL ? (size_t)(end - lines) : strlen(lines);
        (void)snprintf(line, sizeof line, "\n%.*s\n", (int)length, lines);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(report, line), line);
        lines += end != NULL ? length + 2 : length;
    }
}

void test_a_documented_unit_is_as_expected(void)
{
    const options_t options = documented();
    survey_of(&options);
    TEST_ASSERT_NULL_MESSAGE(strstr(report, "# differs"), report);
    expect("model = 151; firmware = 1.2; frequency_hz = 6.00; min_frequency_hz = 5.00; "
           "max_frequency_hz = 12.00; reply_ms = 3; boot_ms = 2500; first_packet_ms = 200; "
           "spin_up_ms = 1000; spin_up_percent = 40; stop_tail_ms = 50; samples_per_second = 4000; "
           "points_slow = 670; flagged_permille = 5; reply_92 = A5 5A 03 00 00 00 06 00 00 00; "
           "reply_60 = A5 5A 05 00 00 40 81");
}

/* The number is 2026031700012345. */
void test_the_serial_number_is_left_out_unless_it_is_wanted(void)
{
    const options_t options = documented();
    survey_of(&options);
    expect("reply_90 = A5 5A 14 00 00 00 04 97 02 01 01 ** ** ** ** ** ** ** ** ** ** ** ** ** ** "
           "** **");
    TEST_ASSERT_NULL(strstr(report, "12345"));
    read_report(true);
    expect("serial = 2026031700012345");
    TEST_ASSERT_NOT_NULL(strstr(report, " 01 02 03 04 05\n"));
}

/* A covered window is a live data fault (section 7): only the stream reports it. */
void test_a_live_fault_does_not_change_the_index_of_the_health(void)
{
    options_t options = documented();
    options.covered = true;
    survey_of(&options);
    expect("health = 0; health_index = 3");
}

/* The bytes are lost on the line, so the unit's properties are still found. Three turns of four
 * lack a packet. */
void test_a_damaged_line_does_not_look_like_another_unit(void)
{
    const options_t options = documented();
    lost_every = 3001;
    survey_of(&options);
    TEST_ASSERT_NOT_NULL(strstr(report, "\n# differs     9.12  places with stray bytes "));
    expect("motor_percent = 100; spin_up_ms = 1000; samples_per_second = 4000; points_slow = 670; "
           "points_medium = 400; points_fast = 330; last_crc = right");
}

/* Here each turn lacks two packets. */
void test_what_a_damaged_line_hides_is_unknown(void)
{
    const options_t options = documented();
    lost_every = 997;
    survey_of(&options);
    expect("motor_percent = unknown; points_slow = unknown; last_crc = unknown; "
           "samples_per_second = 4000");
}

/* ----------------------------------------------------------------------------------- deviations */

static options_t like(const char *text)
{
    options_t options = documented();
    FILE *const file = fopen(like_file, "w");
    TEST_ASSERT_NOT_NULL(file);
    (void)fprintf(file, "# as written by hand\n%s\nno_such_key = 1\nboot_ms = unknown\n", text);
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
    TEST_ASSERT_TRUE_MESSAGE(like_read(&options, like_file), text);
    return options;
}

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
static void run(const row_t *row)
{
    char text[100];
    char line[100];
    const char *const expected = strstr(row->steps, " > ") + 3;
    (void)snprintf(text, sizeof text, "%.*s", (int)(expected - 3 - row->steps), row->steps);
    options_t options = like(text);
    survey_of(&options);
    (void)snprintf(line, sizeof line, "\n# differs     %s ", expected);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(report, line), report);
    memcpy(first, report, sizeof first);
    remove_chance(first);
    options = documented();
    options.device.seed = 7;
    TEST_ASSERT_TRUE(like_read(&options, report_file));
    survey_of(&options);
    remove_chance(report);
    TEST_ASSERT_EQUAL_STRING(first, report);
}

/* clang-format off */
static const row_t rows[] = {
    ROW(another_model, "model = 150 > 9.15  model                          150"),
    ROW(the_order_of_the_firmwares_bytes,
        "firmware_order = major-first > 9.4   firmware's bytes               major-first"),
    ROW(the_form_of_the_serial_number,
        "serial_digits = ascii > 9.5   serial number's digits         ascii"),
    ROW(a_unit_that_is_not_well, "health = 16 > 4     health, 0 is well              16"),
    ROW(late_replies, "reply_ms = 400 > 9.11  time to a reply, ms            400"),
    ROW(another_first_frequency, "frequency_hz = 7 > 1     frequency at first, Hz         7.00"),
    ROW(refused_steps, "steps = refused > 3     frequency commands             refused"),
    ROW(a_lower_lowest_frequency,
        "min_frequency_hz = 4 > 1     lowest frequency, Hz           4.00"),
    ROW(a_higher_highest_frequency,
        "max_frequency_hz = 15 > 1     highest frequency, Hz          15.00"),
    ROW(a_frequency_that_survives_a_reboot,
        "frequency_survives = yes > 3     frequency survives reboot      yes"),
    ROW(a_slow_reboot, "boot_ms = 8000 > 9.11  time of a reboot, ms           8000"),
    ROW(late_first_packets, "first_packet_ms = 2500 > 9.11  first packet after reply, ms   2500"),
    ROW(a_start_packet_that_comes_first,
        "first_packets = start > 9.8   first packets begin            start"),
    ROW(a_slow_spin_up, "spin_up_ms = 6000 > 9.8   spin-up, ms                    6000"),
    ROW(a_slow_motor, "motor_percent = 80 > 9.7   measured of set speed, percent 80"),
    ROW(a_long_tail, "stop_tail_ms = 500 > 9.10  tail after a stop, ms          500"),
    ROW(small_packets, "samples_per_packet = 32 > 9.6   samples of a full packet       32"),
    ROW(another_angle_of_start_packets,
        "start_angle_deg = 116 > 9.8   start packet's angle, degrees  116"),
    ROW(flagged_samples, "flagged_permille = 1000 > 9.9   samples flagged, permille      1000"),
    ROW(no_ct_information, "ct_information = no > 9.1   CT information                 no"),
    ROW(no_last_crc, "ct_information = no > 9.1   LastCRC                        absent"),
    ROW(another_version_of_the_protocol,
        "user_version = 2.1 > 7     protocol's version             2.1"),
};
/* clang-format on */

void test_rows(void)
{
    run_rows(rows, run);
}

void test_a_turn_that_begins_without_a_start_packet_is_reported(void)
{
    const options_t options = like("first_packets = unmarked\nfirst_angle_deg = 330");
    survey_of(&options);
    expect("first_packets = unmarked; first_angle_deg = 330");
}

void test_without_lone_packets_the_report_says_unknown(void)
{
    const options_t options = like("lone_packets = no");
    survey_of(&options);
    expect("lone_packets = unknown");
}

void test_a_file_that_is_no_report_is_refused(void)
{
    options_t options = documented();
    FILE *const file = fopen(like_file, "w");
    TEST_ASSERT_NOT_NULL(file);
    (void)fputs("boot_ms = soon\n", file);
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
    TEST_ASSERT_FALSE(like_read(&options, like_file));
    TEST_ASSERT_FALSE(like_read(&options, "no/such/report"));
    TEST_ASSERT_FALSE(like_read(&options, "/dev/null"));
    TEST_ASSERT_FALSE(like_read(&options, "/"));
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The survey of the simulated lidar, in virtual time: a documented unit is as expected, each
 * deviation is reported, and a lidar simulated from a report gives the same report. */

#define _POSIX_C_SOURCE 200809L

#include "like.h"
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

/* Surveys a lidar with these options; the report is then in report_file and in `report`. */
static void survey_of(const options_t *options)
{
    time_us = 0;
    sim_init(&device, &options->device);
    sim_set_health(&device, options->health);
    sim_cover_window(&device, options->covered);
    TEST_ASSERT_TRUE(survey_run(&survey, &wire, SURVEY_SECONDS));
    FILE *const file = fopen(report_file, "w+");
    TEST_ASSERT_NOT_NULL(file);
    survey_print_report(&survey, file, false);
    rewind(file);
    report[fread(report, 1, sizeof report - 1, file)] = '\0';
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

static void expect(const char *line)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(report, line), report);
}

void test_a_documented_unit_is_as_expected(void)
{
    const options_t options = documented();
    survey_of(&options);
    TEST_ASSERT_NULL_MESSAGE(strstr(report, "# differs"), report);
    expect("\nmodel = 151\n");
    expect("\nfirmware = 1.2\n");
    expect("\nfrequency_hz = 6.00\n");
    expect("\nmin_frequency_hz = 5.00\n");
    expect("\nmax_frequency_hz = 12.00\n");
    expect("\nreply_ms = 3\n");
    expect("\nboot_ms = 2500\n");
    expect("\nfirst_packet_ms = 200\n");
    expect("\nspin_up_ms = 1000\n");
    expect("\nspin_up_percent = 40\n");
    expect("\nstop_tail_ms = 50\n");
    expect("\nsamples_per_second = 4000\n");
    expect("\npoints_slow = 670\n");
    expect("\nflagged_permille = 5\n");
    expect("\nreply_92 = A5 5A 03 00 00 00 06 00 00 00\n");
    expect("\nreply_60 = A5 5A 05 00 00 40 81\n");
}

/* The number is 2026031700012345. */
void test_the_serial_number_is_left_out_unless_it_is_wanted(void)
{
    const options_t options = documented();
    survey_of(&options);
    expect(
        "\nreply_90 = A5 5A 14 00 00 00 04 97 02 01 01 ** ** ** ** ** ** ** ** ** ** ** ** ** ** "
        "** **\n");
    TEST_ASSERT_NULL(strstr(report, "12345"));
    FILE *const file = fopen(report_file, "w+");
    survey_print_report(&survey, file, true);
    rewind(file);
    report[fread(report, 1, sizeof report - 1, file)] = '\0';
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
    expect("\nserial = 2026031700012345\n");
    expect(" 01 02 03 04 05\n");
}

/* For each deviation: the line expected in the report, and the simulated lidar's settings. */
static const struct {
    const char *line;
    const char *like;
} deviations[] = {
    {"9.15  model                          150", "model = 150"},
    {"9.4   firmware's bytes               major-first", "firmware_order = major-first"},
    {"9.5   serial number's digits         ascii", "serial_digits = ascii"},
    {"4     health, 0 is well              16", "health = 16"},
    {"9.11  time to a reply, ms            400", "reply_ms = 400"},
    {"1     frequency at first, Hz         7.00", "frequency_hz = 7"},
    {"3     frequency commands             refused", "steps = refused"},
    {"1     lowest frequency, Hz           4.00", "min_frequency_hz = 4"},
    {"1     highest frequency, Hz          15.00", "max_frequency_hz = 15"},
    {"3     frequency survives reboot      yes", "frequency_survives = yes"},
    {"9.11  time of a reboot, ms           8000", "boot_ms = 8000"},
    {"9.11  first packet after reply, ms   2500", "first_packet_ms = 2500"},
    {"9.8   first packets begin            start", "first_packets = start"},
    {"9.8   spin-up, ms                    6000", "spin_up_ms = 6000"},
    {"9.7   measured of set speed, percent 80", "motor_percent = 80"},
    {"9.10  tail after a stop, ms          500", "stop_tail_ms = 500"},
    {"9.6   samples of a full packet       32", "samples_per_packet = 32"},
    {"9.8   start packet's angle, degrees  116", "start_angle_deg = 116"},
    {"9.9   samples flagged, permille      1000", "flagged_permille = 1000"},
    {"9.1   CT information                 no", "ct_information = no"},
    {"9.1   LastCRC                        absent", "ct_information = no"},
    {"7     protocol's version             2.1", "user_version = 2.1"},
};

#define DEVIATIONS (sizeof deviations / sizeof deviations[0])

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

void test_each_deviation_is_seen(void)
{
    for (size_t i = 0; i < DEVIATIONS; i++) {
        char line[100];
        const options_t options = like(deviations[i].like);
        survey_of(&options);
        (void)snprintf(line, sizeof line, "\n# differs     %s ", deviations[i].line);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(report, line), report);
    }
}

void test_a_turn_that_begins_without_a_start_packet_is_reported(void)
{
    const options_t options = like("first_packets = unmarked\nfirst_angle_deg = 330");
    survey_of(&options);
    expect("\nfirst_packets = unmarked\nfirst_angle_deg = 330\n");
}

/* A covered window is a live data fault (section 7): only the stream reports it. */
void test_a_live_fault_does_not_change_the_index_of_the_health(void)
{
    options_t options = documented();
    options.covered = true;
    survey_of(&options);
    expect("\nhealth = 0\n");
    expect("\nhealth_index = 3\n");
}

/* The bytes are lost on the line, so the unit's properties are still found. Three turns of four
 * lack a packet. */
void test_a_damaged_line_does_not_look_like_another_unit(void)
{
    const options_t options = documented();
    lost_every = 3001;
    survey_of(&options);
    expect("\n# differs     9.12  places with stray bytes ");
    expect("\nmotor_percent = 100\n");
    expect("\nspin_up_ms = 1000\n");
    expect("\nsamples_per_second = 4000\n");
    expect("\npoints_slow = 670\n");
    expect("\npoints_medium = 400\n");
    expect("\npoints_fast = 330\n");
    expect("\nlast_crc = right\n");
}

/* Here each turn lacks two packets. */
void test_what_a_damaged_line_hides_is_unknown(void)
{
    const options_t options = documented();
    lost_every = 997;
    survey_of(&options);
    expect("\nmotor_percent = unknown\n");
    expect("\npoints_slow = unknown\n");
    expect("\nlast_crc = unknown\n");
    expect("\nsamples_per_second = 4000\n");
}

void test_without_lone_packets_the_report_says_unknown(void)
{
    const options_t options = like("lone_packets = no");
    survey_of(&options);
    expect("\nlone_packets = unknown\n");
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

/* For each deviation: surveys a lidar, then one simulated from that report, and compares both
 * reports. */
void test_a_lidar_like_the_one_surveyed_gives_the_same_report(void)
{
    static char first[sizeof report];
    for (size_t i = 0; i < DEVIATIONS; i++) {
        options_t options = like(deviations[i].like);
        survey_of(&options);
        memcpy(first, report, sizeof first);
        remove_chance(first);
        options = documented();
        options.device.seed = 7;
        TEST_ASSERT_TRUE(like_read(&options, report_file));
        survey_of(&options);
        remove_chance(report);
        TEST_ASSERT_EQUAL_STRING(first, report);
    }
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

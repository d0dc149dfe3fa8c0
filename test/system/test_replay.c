/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Recordings, from bytes to scans: those of the repository (test/recordings/README.md) and, if
 * there is one, that of a real unit. The expected counts come from the simulated lidar's own report
 * and, for the real unit, from the recording's description; none from the library. */

#include "receiver.h"
#include "rows.h"

#include "tmini/parts/tmini_decoder.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define RECORDING_MAX 40000u
#define SCANS_MAX 20u
#define PATH_SIZE 4096u /* Room for any path of the project. */

static uint8_t bytes[RECORDING_MAX];
static size_t size;
static uint8_t memory[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL + 200];
static receiver_t receiver;
static tmini_decoder_t decoder; /* Takes what the receiver finds. */

typedef struct {
    unsigned packets_before_first;
    unsigned starts;
    unsigned points;
    unsigned trusted; /* Revolutions whose CT information was confirmed. */
    unsigned scans;
    unsigned named; /* Scans that the row has named. */
    tmini_scan_t scan[SCANS_MAX];
} replay_t;

/* Section 1. */
#define BYTES_PER_MS 13u

static replay_t replay;

void setUp(void) {}

void tearDown(void) {}

static bool load(const char *path)
{
    FILE *const file = fopen(path, "rb");
    if (file == NULL) {
        return false;
    }
    size = fread(bytes, 1, sizeof bytes, file);
    TEST_ASSERT_TRUE(size > 0 && size < sizeof bytes);
    fclose(file);
    return true;
}

static void load_own(const char *name)
{
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, "%s%s", RECORDINGS, name);
    TEST_ASSERT_TRUE_MESSAGE(load(path), path);
}

/* --------------------------------------------------------------------------------------- replay */

static void handle_packet(uint32_t now_ms)
{
    const tmini_packet_t *const packet = &receiver.packet;
    replay.points += packet->count;
    replay.starts += tmini_packet_is_start(packet) ? 1 : 0;
    replay.packets_before_first += replay.starts == 0 ? 1 : 0;
    const bool is_end = tmini_decoder_take_packet(&decoder, packet, now_ms);
    replay.trusted += decoder.verdict == TMINI_CT_CONFIRMED ? 1 : 0;
    if (is_end) {
        TEST_ASSERT_TRUE(replay.scans < SCANS_MAX);
        replay.scan[replay.scans++] = decoder.builder.scan;
        TEST_ASSERT_FALSE(tmini_builder_add(&decoder.builder, packet, now_ms));
    }
}

/* Replays everything in chunks of `chunk` bytes, including the bytes left at the end. */
static void replay_in_chunks(size_t chunk)
{
    replay = (replay_t){0};
    decoder = (tmini_decoder_t){0};
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&decoder.builder, points,
                                                       sizeof points / sizeof points[0], 0));
    receiver_open(&receiver, memory, sizeof memory, 0);
    for (size_t fed = 0; fed < size; fed += chunk) {
        chunk = chunk < size - fed ? chunk : size - fed;
        receiver_feed(&receiver, &bytes[fed], chunk);
        while (receiver_next(&receiver) == TMINI_FRAME_PACKET) {
            handle_packet((uint32_t)(fed / BYTES_PER_MS));
        }
    }
    while (receiver_next_at_end(&receiver) == TMINI_FRAME_PACKET) {
        handle_packet((uint32_t)(size / BYTES_PER_MS));
    }
    TEST_ASSERT_EQUAL_UINT32(0, receiver_counters(&receiver).bytes_overrun);
}

static void load_real(void)
{
    if (!load(REAL_RECORDINGS "t-mini-plus-room.bin")) {
        TEST_IGNORE_MESSAGE("no recording of a real unit in TMINI_RECORDINGS_DIR");
    }
}

static void expect_number(const char *word)
{
    const tmini_parser_counters_t counters = receiver_counters(&receiver);
    tmini_ct_info_t info;
    tmini_ct_read(&decoder.ct, &info);
    const row_number_t numbers[] = {
        {"packets", counters.packets},
        {"starts", replay.starts},
        {"points", replay.points},
        {"skipped", counters.bytes_skipped},
        {"errors", counters.checksum_errors},
        {"before", replay.packets_before_first},
        {"trusted", replay.trusted},
        {"scans", replay.scans},
        {"faults", tmini_ct_faults(&decoder.ct)},
        {"has_serial", (info.known & TMINI_KNOWN_SERIAL) != 0 ? 1 : 0},
        {"year", info.year},
        {"month", info.month},
        {"day", info.day},
        {"number", info.number},
        {"major", info.firmware_major},
        {"minor", info.firmware_minor},
    };
    TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
}

/* The next scan is complete and has these points, packets and frequency in 0.1 Hz; */
static void expect_scan(unsigned count, unsigned packets, unsigned dhz)
{
    const tmini_scan_t *const scan = &replay.scan[replay.named++];
    TEST_ASSERT_EQUAL_UINT16(count, scan->count);
    TEST_ASSERT_EQUAL_UINT16(packets, scan->packets);
    TEST_ASSERT_EQUAL_UINT16(dhz * 10, scan->frequency_chz);
    TEST_ASSERT_TRUE(scan->complete);
    TEST_ASSERT_EQUAL_UINT16(0, scan->gaps);
    TEST_ASSERT_EQUAL_UINT16(0, scan->dropped);
    TEST_ASSERT_EQUAL_UINT16(0, scan->checksum_errors);
}

/* or it is a part, with these gaps. */
static void expect_part(unsigned gaps)
{
    const tmini_scan_t *const scan = &replay.scan[replay.named++];
    TEST_ASSERT_EQUAL_UINT16(gaps, scan->gaps);
    TEST_ASSERT_FALSE(scan->complete);
}

/* "file:NAME" or "real"; "by:64": replays it in chunks of 64 bytes; "873/23/46": the next scan;
 * "part:3"; numbers above. */
static void tell(char *word)
{
    unsigned count, packets, dhz;
    if (row_is(word, "file")) {
        load_own(row_text(word));
    } else if (row_is(word, "real")) {
        load_real();
    } else if (row_is(word, "by")) {
        replay_in_chunks(row_number(word));
    } else if (sscanf(word, "%u/%u/%u", &count, &packets, &dhz) == 3) {
        expect_scan(count, packets, dhz);
    } else if (row_is(word, "part")) {
        expect_part(row_number(word));
    } else {
        expect_number(word);
    }
}

/* Of the recording at 6 Hz. Skipped bytes: the start reply, eight LastCRC and the last packet,
 * which is cut. */
#define SIX_HERTZ                                                                         \
    " packets:190 starts:9 points:7133 skipped:101 errors:0 before:26 trusted:8 scans:8 " \
    "873/23/46 699/19/57 665/18/60 669/18/60 667/18/60 666/18/60 667/18/60 669/18/60 "

static const row_t rows[] IN_FLASH = {
    ROW(the_manuals_packet_is_replayed,
        "file:manual-packet.bin by:67 packets:1 starts:0 points:19 skipped:0 errors:0 scans:0"),
    ROW(a_recording_at_6_hz_is_replayed_whatever_the_chunks,
        "file:sim-6hz.bin by:1" SIX_HERTZ "by:2" SIX_HERTZ "by:13" SIX_HERTZ "by:64" SIX_HERTZ
        "by:130" SIX_HERTZ "by:131" SIX_HERTZ "by:512" SIX_HERTZ "by:894" SIX_HERTZ),
    ROW(a_recording_at_6_hz_has_all_ct_information,
        "file:sim-6hz.bin by:64 has_serial:1 year:2026 month:3 day:17 number:12345 major:1 minor:2 "
        "faults:0"),
    ROW(a_recording_at_10_hz_of_a_plain_unit_has_scans_but_no_ct_information,
        "file:sim-10hz-plain.bin by:100 packets:143 starts:11 points:5132 skipped:99 errors:0 "
        "scans:10 725/20/55 561/15/71 475/13/84 419/12/95 402/12/100 401/11/100 400/11/100 "
        "399/11/100 402/12/100 401/11/100 trusted:0 faults:256"),
    ROW(a_recording_at_12_hz_has_scans_and_the_beginning_of_the_ct_information,
        "file:sim-12hz.bin by:100 packets:149 starts:13 points:5149 skipped:19 errors:0 scans:12 "
        "553/15/72 457/13/88 398/11/101 358/10/112 335/10/119 334/10/120 332/11/120 334/10/120 "
        "334/10/120 332/10/120 333/10/120 332/10/120 trusted:12 faults:0"),
    /* 299 packets were sent; each of the 266 that arrived intact is delivered. No revolution
     * arrived intact. */
    ROW(on_a_bad_line_every_intact_packet_is_replayed,
        "file:sim-6hz-damaged.bin by:77 packets:266 starts:15 points:9832 skipped:4214 errors:32 "
        "trusted:0 scans:14 part:3 part:1 part:2 part:2 part:1 part:3 part:1 part:1 part:3 part:2 "
        "part:3 part:1 part:3 part:1"),
    ROW(a_real_units_recording_gives_four_complete_scans,
        "real by:64 packets:89 starts:5 points:3278 skipped:0 errors:0 before:20 scans:4 624/17/63 "
        "624/17/64 626/17/65 630/17/64 trusted:0 faults:256"),
};

void test_recordings(void)
{
    tell_rows(rows, tell);
}

/* ------------------------------------------------------------------------- what was really sent */

typedef struct {
    unsigned packet, revolution, index, angle_q6, distance_mm, intensity, flag, intact;
} truth_t;

static bool read_truth(FILE *file, truth_t *truth)
{
    return fscanf(file, "%u,%u,%u,%u,%u,%u,%u,%u", &truth->packet, &truth->revolution,
                  &truth->index, &truth->angle_q6, &truth->distance_mm, &truth->intensity,
                  &truth->flag, &truth->intact) == 8;
}

/* The next sample of a packet that arrived intact. */
static bool read_intact(FILE *file, truth_t *truth)
{
    do {
        if (!read_truth(file, truth)) {
            return false;
        }
    } while (truth->intact == 0);
    return true;
}

static void expect_true_points(FILE *file)
{
    for (unsigned i = 0; i < receiver.packet.count; i++) {
        tmini_point_t point;
        truth_t truth;
        TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, i, &point));
        TEST_ASSERT_TRUE(read_intact(file, &truth));
        TEST_ASSERT_EQUAL_UINT(truth.index, i);
        TEST_ASSERT_EQUAL_UINT(truth.angle_q6, point.angle_q6);
        TEST_ASSERT_EQUAL_UINT(truth.distance_mm, point.distance_mm);
        TEST_ASSERT_EQUAL_UINT(truth.intensity, point.intensity);
        TEST_ASSERT_EQUAL_UINT(truth.flag, point.flag);
    }
}

static void expect_truth(const char *name)
{
    char path[PATH_SIZE];
    char header[200];
    truth_t truth;
    (void)snprintf(path, sizeof path, "%s%s.csv", TRUTHS, name);
    FILE *const file = fopen(path, "r");
    if (file == NULL) {
        TEST_IGNORE_MESSAGE("what was sent is not here: the test `recordings` makes it");
    }
    TEST_ASSERT_NOT_NULL(fgets(header, sizeof header, file));
    receiver_open(&receiver, memory, sizeof memory, 0);
    for (size_t fed = 0; fed < size;) {
        const size_t left = size - fed;
        const size_t chunk = left < receiver_room(&receiver) ? left : receiver_room(&receiver);
        receiver_feed(&receiver, &bytes[fed], chunk);
        fed += chunk;
        while (receiver_next(&receiver) == TMINI_FRAME_PACKET) {
            expect_true_points(file);
        }
    }
    TEST_ASSERT_FALSE(read_intact(file, &truth));
    fclose(file);
}

void test_every_sample_is_as_it_was_sent(void)
{
    static const char *const names[] = {"sim-6hz", "sim-10hz-plain", "sim-12hz", "sim-6hz-damaged"};
    for (unsigned i = 0; i < 4; i++) {
        char file[100];
        (void)snprintf(file, sizeof file, "%s.bin", names[i]);
        load_own(file);
        expect_truth(names[i]);
    }
}

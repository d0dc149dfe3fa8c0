/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "survey.h"

#include <stdlib.h>
#include <string.h>

#include "tmini/tmini_names.h"

#define TEXT_SIZE 100

typedef struct {
    const char *key;
    const char *section; /* Of docs/protocol.md. */
    const char *statement;
    const char *expected; /* Words and ranges LOW..HIGH, with | between them; NULL: anything. */
    /* Returns false if the answer is unknown. */
    bool (*read)(const survey_t *survey, char text[TEXT_SIZE]);
} question_t;

static const survey_scan_t *slow(const survey_t *survey)
{
    return &survey->scans[SURVEY_SLOW];
}

static bool put(char text[TEXT_SIZE], bool is_known, double value, int decimals)
{
    (void)snprintf(text, TEXT_SIZE, "%.*f", decimals, value);
    return is_known;
}

static bool put_word(char text[TEXT_SIZE], const char *known)
{
    (void)snprintf(text, TEXT_SIZE, "%s", known != NULL ? known : "");
    return known != NULL;
}

/* Rounds to steps, so that two surveys of the same unit agree. */
static double rounded(double value, double step)
{
    return (double)(long)(value / step + 0.5) * step;
}

/* -------------------------------------------------------------------------------------- replies */

static const uint8_t *info_of(const survey_t *survey)
{
    return survey_content(&survey->info, 0x04, TMINI_INFO_SIZE);
}

static bool read_model(const survey_t *survey, char text[TEXT_SIZE])
{
    const uint8_t *const info = info_of(survey);
    return put(text, info != NULL, info != NULL ? info[0] : 0, 0);
}

/* Compares the two numbers with the CT information; known only if they differ. */
static bool is_major_first(const survey_t *survey)
{
    const tmini_ct_info_t *const ct = &slow(survey)->ct;
    const uint8_t *const info = info_of(survey);
    return info != NULL && (ct->known & TMINI_KNOWN_FIRMWARE) != 0 &&
           info[1] == ct->firmware_major && info[2] == ct->firmware_minor && info[1] != info[2];
}

static bool read_firmware(const survey_t *survey, char text[TEXT_SIZE])
{
    const uint8_t *const info = info_of(survey);
    const bool swaps = is_major_first(survey);
    if (info != NULL) {
        (void)snprintf(text, TEXT_SIZE, "%d.%d", info[swaps ? 1 : 2], info[swaps ? 2 : 1]);
    }
    return info != NULL;
}

static bool read_firmware_order(const survey_t *survey, char text[TEXT_SIZE])
{
    const tmini_ct_info_t *const ct = &slow(survey)->ct;
    const uint8_t *const info = info_of(survey);
    const bool is_minor_first = info != NULL && (ct->known & TMINI_KNOWN_FIRMWARE) != 0 &&
                                info[2] == ct->firmware_major && info[1] == ct->firmware_minor &&
                                info[1] != info[2];
    return put_word(text, is_minor_first           ? "minor-first"
                          : is_major_first(survey) ? "major-first"
                                                   : NULL);
}

static bool read_hardware(const survey_t *survey, char text[TEXT_SIZE])
{
    const uint8_t *const info = info_of(survey);
    return put(text, info != NULL, info != NULL ? info[3] : 0, 0);
}

static bool read_serial_digits(const survey_t *survey, char text[TEXT_SIZE])
{
    const uint8_t *const info = info_of(survey);
    unsigned numbers = 0;
    unsigned characters = 0;
    for (size_t i = 4; info != NULL && i < TMINI_INFO_SIZE; i++) {
        numbers += info[i] <= 9 ? 1 : 0;
        characters += info[i] >= '0' && info[i] <= '9' ? 1 : 0;
    }
    return put_word(text, info == NULL       ? NULL
                          : numbers == 16    ? "binary"
                          : characters == 16 ? "ascii"
                                             : "other");
}

static bool read_health(const survey_t *survey, char text[TEXT_SIZE])
{
    const uint8_t *const content = survey_content(&survey->health, 0x06, TMINI_HEALTH_SIZE);
    return put(text, content != NULL, content != NULL ? content[0] : 0, 0);
}

static bool read_stop_reply(const survey_t *survey, char text[TEXT_SIZE])
{
    return put_word(text, survey->stop.count == 0 ? "none" : "some");
}

static bool read_start_reply(const survey_t *survey, char text[TEXT_SIZE])
{
    static const uint8_t usual[7] = {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
    const survey_reply_t *const reply = &slow(survey)->reply;
    return put_word(text, reply->count < sizeof usual                      ? NULL
                          : memcmp(reply->bytes, usual, sizeof usual) == 0 ? "as-manual"
                                                                           : "other");
}

static bool read_reply_ms(const survey_t *survey, char text[TEXT_SIZE])
{
    const uint64_t ms = survey->info.after_us / 1000;
    return put(text, survey->info.count > 0, (double)ms, 0);
}

/* ------------------------------------------------------------------------------------ frequency */

static bool read_frequency(const survey_t *survey, char text[TEXT_SIZE])
{
    return put(text, survey->frequency_chz > 0, survey->frequency_chz / 100.0, 2);
}

static bool read_min(const survey_t *survey, char text[TEXT_SIZE])
{
    return put(text, survey->min_chz > 0, survey->min_chz / 100.0, 2);
}

static bool read_max(const survey_t *survey, char text[TEXT_SIZE])
{
    return put(text, survey->max_chz > 0, survey->max_chz / 100.0, 2);
}

static bool read_steps(const survey_t *survey, char text[TEXT_SIZE])
{
    static const char *const words[] = {NULL, "obeyed", "refused", "other"};
    return put_word(text, words[survey->steps]);
}

static bool read_survives(const survey_t *survey, char text[TEXT_SIZE])
{
    return put_word(text, survey->kept_chz == 0                       ? NULL
                          : survey->kept_chz == survey->changed_chz   ? "yes"
                          : survey->kept_chz == survey->frequency_chz ? "no"
                                                                      : "other");
}

static bool read_boot(const survey_t *survey, char text[TEXT_SIZE])
{
    return put(text, survey->boot_ms > 0, survey->boot_ms, 0);
}

static bool read_unasked(const survey_t *survey, char text[TEXT_SIZE])
{
    return put(text, survey->boot_ms > 0, survey->unasked_bytes, 0);
}

/* ------------------------------------------------------------------------------ start and stop */

static bool read_first_packet(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    const double ms = ((double)scan->first_us - (double)scan->start_us) / 1000 -
                      (double)scan->reply.after_us / 1000;
    return put(text, scan->packets > 0, rounded(ms > 0 ? ms : 0, 10), 0);
}

static bool read_beginning(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    return put_word(text, scan->start_packets == 0                      ? NULL
                          : scan->begins_with_start                     ? "start"
                          : scan->until_start_q6 > TMINI_FULL_CIRCLE_Q6 ? "unmarked"
                                                                        : "anywhere");
}

/* Unknown if the rotor may have stood there by chance. */
static bool read_first_angle(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    char beginning[TEXT_SIZE];
    return read_beginning(survey, beginning) && strcmp(beginning, "anywhere") != 0 &&
           put(text, true, (int)rounded(scan->first_q6 / 64.0, 1) % 360, 0);
}

static double share_of_speed(const survey_scan_t *scan, uint32_t i)
{
    const uint32_t last_chz = survey_scan_measured_chz(scan);
    return last_chz > 0 ? (double)scan->early[i].chz / last_chz : 0;
}

static bool read_spin_up_percent(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    const bool is_known = scan->early_count > 0 && scan->turns > 0;
    const double percent = rounded(100 * share_of_speed(scan, 0), 10);
    return put(text, is_known, percent < 100 ? percent : 100, 0);
}

/* The time from standstill to full speed, as if the speed rose evenly. */
static bool read_spin_up(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    const double first = share_of_speed(scan, 0);
    uint32_t i = 0;
    while (i + 1 < scan->early_count && share_of_speed(scan, i) < 0.9) {
        i++;
    }
    const double ms = (scan->early[i].us - scan->early[0].us) / 1000.0;
    const bool is_known = scan->early_count > 0 && scan->turns > 0;
    return put(text, is_known, first < 0.85 ? rounded(ms / (0.9 - first), 100) : 0, 0);
}

static bool read_tail(const survey_t *survey, char text[TEXT_SIZE])
{
    double longest = 0;
    for (size_t i = 0; i < SURVEY_SCANS; i++) {
        const survey_scan_t *const scan = &survey->scans[i];
        const double ms = (double)(scan->last_us - scan->stop_us) / 1000;
        longest = ms > longest ? ms : longest;
    }
    return put(text, slow(survey)->packets > 0, rounded(longest, 50), 0);
}

/* -------------------------------------------------------------------------------------- packets */

static bool read_longest(const survey_t *survey, char text[TEXT_SIZE])
{
    return put(text, slow(survey)->packets > 0, slow(survey)->longest, 0);
}

static bool read_lone(const survey_t *survey, char text[TEXT_SIZE])
{
    return put_word(text, slow(survey)->lone_packets > 0 ? "yes" : NULL);
}

static bool read_damages(const survey_t *survey, char text[TEXT_SIZE])
{
    uint32_t damages = 0;
    for (size_t i = 0; i < SURVEY_SCANS; i++) {
        damages += survey->scans[i].damages;
    }
    return put(text, slow(survey)->packets > 0, damages, 0);
}

static bool read_rate(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    const double seconds = (double)(scan->steady_end_us - scan->steady_us) / 1e6;
    return put(text, seconds > 1, seconds > 1 ? rounded(scan->steady_samples / seconds, 100) : 0,
               0);
}

static bool read_start_angle(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    if (scan->turns == 0) {
        return false;
    }
    const double mean_q6 = scan->start_q6 + (double)scan->start_sum_q6 / scan->turns;
    return put(text, true, (int)rounded(mean_q6 / 64 + 360, 1) % 360, 0);
}

static bool read_flagged(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    return put(text, scan->samples > 0,
               scan->samples > 0 ? rounded(1000.0 * scan->flagged / scan->samples, 1) : 0, 0);
}

static bool read_motor(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    const uint32_t measured_chz = survey_scan_measured_chz(scan);
    return put(text, measured_chz > 0 && scan->set_chz > 0,
               scan->set_chz > 0 ? rounded(100.0 * measured_chz / scan->set_chz, 1) : 0, 0);
}

static bool read_points(const survey_scan_t *scan, char text[TEXT_SIZE])
{
    return put(text, scan->turns > 0,
               scan->turns > 0 ? rounded((double)scan->turn_samples / scan->turns, 10) : 0, 0);
}

static bool read_points_slow(const survey_t *survey, char text[TEXT_SIZE])
{
    return read_points(slow(survey), text);
}

static bool read_points_medium(const survey_t *survey, char text[TEXT_SIZE])
{
    return read_points(&survey->scans[SURVEY_MEDIUM], text);
}

static bool read_points_fast(const survey_t *survey, char text[TEXT_SIZE])
{
    return read_points(&survey->scans[SURVEY_FAST], text);
}

/* ------------------------------------------------------------------------------- CT information */

static bool read_ct(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    return put_word(text, scan->start_packets == 0 ? NULL : scan->has_ct ? "yes" : "no");
}

static bool read_last_crc(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    return put_word(text, scan->start_packets < 2                ? NULL
                          : scan->last_crc_bytes == 0            ? "absent"
                          : scan->refuted < scan->confirmed      ? "right"
                          : scan->refuted + scan->confirmed == 0 ? NULL
                                                                 : "wrong");
}

/* Unknown if no LastCRC of AA occurred: a few hundred turns may have none. */
static bool read_aa(const survey_t *survey, char text[TEXT_SIZE])
{
    uint32_t seen = 0;
    for (size_t i = 0; i < SURVEY_SCANS; i++) {
        seen += survey->scans[i].last_crcs_aa;
    }
    return put_word(text, seen > 0 ? "seen" : NULL);
}

static bool read_user_version(const survey_t *survey, char text[TEXT_SIZE])
{
    const tmini_ct_info_t *const ct = &slow(survey)->ct;
    (void)snprintf(text, TEXT_SIZE, "%d.%d", ct->user_major, ct->user_minor);
    return (ct->known & TMINI_KNOWN_USER_VERSION) != 0;
}

/* Compares only faults that are tested once, at power-up (section 7): others may have come
 * since. */
static bool read_health_index(const survey_t *survey, char text[TEXT_SIZE])
{
    const tmini_ct_info_t *const ct = &slow(survey)->ct;
    const uint8_t *const info = info_of(survey);
    const uint8_t *const health = survey_content(&survey->health, 0x06, TMINI_HEALTH_SIZE);
    const unsigned needed = TMINI_KNOWN_FAULTS | TMINI_KNOWN_HARDWARE;
    const unsigned lasting = TMINI_FAULT_WIRELESS_POWER | TMINI_FAULT_PD | TMINI_FAULT_LD;
    if (info == NULL || health == NULL || (ct->known & needed) != needed) {
        return false;
    }
    const bool is_same = ((ct->faults ^ health[0]) & lasting) == 0;
    return put_word(text, is_same && ct->hardware == info[3] ? "3" : "other");
}

static bool read_ct_serial(const survey_t *survey, char text[TEXT_SIZE])
{
    const tmini_ct_info_t *const ct = &slow(survey)->ct;
    const uint8_t *const info = info_of(survey);
    char sent[40];
    char digits[TMINI_SERIAL_DIGITS + 1] = "";
    (void)snprintf(sent, sizeof sent, "%04d%02d%02d%08u", ct->year, ct->month, ct->day,
                   (unsigned)ct->number);
    for (size_t i = 0; info != NULL && i < TMINI_SERIAL_DIGITS; i++) {
        digits[i] = (char)('0' + info[4 + i] % 16);
    }
    return put_word(text, info == NULL || (ct->known & TMINI_KNOWN_SERIAL) == 0 ? NULL
                          : strcmp(sent, digits) == 0                           ? "as-in-reply"
                                                                                : "other");
}

static bool read_told(const survey_t *survey, char text[TEXT_SIZE])
{
    const survey_scan_t *const scan = slow(survey);
    const uint32_t before = scan->before_error;
    const uint32_t after = scan->after_error;
    return put_word(text, before + 3 < after   ? "turn-before"
                          : after + 3 < before ? "turn-after"
                                               : NULL);
}

/* ---------------------------------------------------------------------------------------- table */

static const question_t questions[] = {
    {"model", "9.15", "model", "151", read_model},
    {"firmware", "4", "firmware", NULL, read_firmware},
    {"firmware_order", "9.4", "firmware's bytes", "minor-first", read_firmware_order},
    {"hardware", "4", "hardware", NULL, read_hardware},
    {"serial_digits", "9.5", "serial number's digits", "binary", read_serial_digits},
    {"health", "4", "health, 0 is well", "0", read_health},
    {"reply_ms", "9.11", "time to a reply, ms", "0..100", read_reply_ms},
    {"stop_reply", "3", "reply to stop", "none", read_stop_reply},
    {"start_reply", "4", "reply to start", "as-manual", read_start_reply},
    {"frequency_hz", "1", "frequency at first, Hz", "6.00", read_frequency},
    {"steps", "3", "frequency commands", "obeyed", read_steps},
    {"min_frequency_hz", "1", "lowest frequency, Hz", "5..6", read_min},
    {"max_frequency_hz", "1", "highest frequency, Hz", "12.00", read_max},
    {"frequency_survives", "3", "frequency survives reboot", "no", read_survives},
    {"boot_ms", "9.11", "time of a reboot, ms", "500..5000", read_boot},
    {"unasked_bytes", "9.11", "bytes unasked while booting", "0", read_unasked},
    {"first_packet_ms", "9.11", "first packet after reply, ms", "0..2000", read_first_packet},
    {"first_packets", "9.8", "first packets begin", "anywhere", read_beginning},
    {"first_angle_deg", "9.8", "angle of the first, degrees", NULL, read_first_angle},
    {"spin_up_ms", "9.8", "spin-up, ms", "0..3000", read_spin_up},
    {"spin_up_percent", "9.8", "first speed, percent", NULL, read_spin_up_percent},
    {"motor_percent", "9.7", "measured of set speed, percent", "93..108", read_motor},
    {"stop_tail_ms", "9.10", "tail after a stop, ms", "0..300", read_tail},
    {"samples_per_packet", "9.6", "samples of a full packet", "40", read_longest},
    {"lone_packets", "9.6", "point packets of one sample", "yes", read_lone},
    {"damaged_places", "9.12", "places with stray bytes", "0", read_damages},
    {"samples_per_second", "1", "samples per second", "4000", read_rate},
    {"points_slow", "9.7", "points per turn, 6 Hz", "620..680", read_points_slow},
    {"points_medium", "9.7", "points per turn, 10 Hz", "390..410", read_points_medium},
    {"points_fast", "9.7", "points per turn, 12 Hz", "320..340", read_points_fast},
    {"start_angle_deg", "9.8", "start packet's angle, degrees", "0", read_start_angle},
    {"told_frequency", "9.8", "frequency in a start packet", "turn-before", read_told},
    {"flagged_permille", "9.9", "samples flagged, permille", "0..300", read_flagged},
    {"ct_information", "9.1", "CT information", "yes", read_ct},
    {"last_crc", "9.1", "LastCRC", "right", read_last_crc},
    {"last_crc_aa", "9.2", "LastCRC of AA", "seen", read_aa},
    {"user_version", "7", "protocol's version", "1.0", read_user_version},
    {"health_index", "9.3", "index of the health", "3", read_health_index},
    {"ct_serial", "7", "serial number in the stream", "as-in-reply", read_ct_serial},
};

#define QUESTIONS (sizeof questions / sizeof questions[0])

/* Whether `seen` matches the word or range `expected`, of that length. */
static bool is_one(const char *seen, const char *expected, size_t length)
{
    const char *const range = strstr(expected, "..");
    const double value = strtod(seen, NULL);
    if (range == NULL || range > expected + length) {
        return strlen(seen) == length && strncmp(seen, expected, length) == 0;
    }
    return value >= strtod(expected, NULL) && value <= strtod(range + 2, NULL);
}

static bool is_expected(const char *seen, const char *expected)
{
    const char *at = expected;
    while (*at != '\0') {
        const size_t length = strcspn(at, "|");
        if (is_one(seen, at, length)) {
            return true;
        }
        at += length + (at[length] == '|' ? 1 : 0);
    }
    return false;
}

static void print_answer(const question_t *question, const char *seen, FILE *file,
                         const char *before)
{
    const bool is_known = seen != NULL;
    const bool fits =
        is_known && (question->expected == NULL || is_expected(seen, question->expected));
    (void)fprintf(file, "%s%-11s %-5s %-30s %s", before,
                  !is_known                    ? "unknown"
                  : question->expected == NULL ? "seen"
                  : fits                       ? "as expected"
                                               : "differs",
                  question->section, question->statement, is_known ? seen : "?");
    if (!fits && question->expected != NULL) {
        (void)fprintf(file, " (expected %s)", question->expected);
    }
    (void)fputc('\n', file);
}

void survey_print_table(const survey_t *survey, FILE *file, const char *before)
{
    for (size_t i = 0; i < QUESTIONS; i++) {
        char text[TEXT_SIZE] = "";
        const bool is_known = questions[i].read(survey, text);
        print_answer(&questions[i], is_known ? text : NULL, file, before);
    }
}

/* Bytes from `hidden` on are the serial number, and not printed. */
static void print_reply(const survey_reply_t *reply, const char *key, size_t hidden, FILE *file)
{
    const size_t count = reply->count < sizeof reply->bytes ? reply->count : sizeof reply->bytes;
    (void)fprintf(file, "%s =%s", key, count == 0 ? " unknown" : "");
    for (size_t i = 0; i < count; i++) {
        (void)fprintf(file, i < hidden ? " %02X" : " **", reply->bytes[i]);
    }
    (void)fputc('\n', file);
}

static void print_serial(const survey_t *survey, FILE *file)
{
    const uint8_t *const info = info_of(survey);
    (void)fputs("serial = ", file);
    for (size_t i = 0; info != NULL && i < TMINI_SERIAL_DIGITS; i++) {
        (void)fprintf(file, "%d", info[4 + i] % 16);
    }
    (void)fputs(info != NULL ? "\n" : "unknown\n", file);
}

/* Of thousands of other packets a few have the right checksum by chance. */
#define FEW_PACKETS 9u

/* A unit that sends something else: its first bytes, but not its serial number, be it as in the
 * reply or in the CT bytes of ten packets in a row (section 7). */
static void print_sample(const survey_t *survey, FILE *file)
{
    const survey_scan_t *const scan = slow(survey);
    const uint8_t *const info = info_of(survey);
    size_t hidden = 0;
    unsigned headers = 0;
    if (scan->packets > FEW_PACKETS || scan->sample_count == 0) {
        return;
    }
    (void)fputs("not_understood =", file);
    for (size_t i = 0; i < scan->sample_count; i++) {
        const uint8_t *const at = scan->sample + i;
        const size_t left = scan->sample_count - i;
        headers += left > 1 && at[0] == 0xAA && at[1] == 0x55 ? 1 : 0;
        if (info != NULL && left >= TMINI_SERIAL_DIGITS &&
            memcmp(at, info + 4, TMINI_SERIAL_DIGITS) == 0) {
            hidden = TMINI_SERIAL_DIGITS;
        }
        if (headers > 9) {
            break;
        }
        (void)fprintf(file, hidden > 0 ? " **" : " %02X", *at);
        hidden -= hidden > 0 ? 1 : 0;
    }
    (void)fputc('\n', file);
}

void survey_print_report(const survey_t *survey, FILE *file, bool with_serial)
{
    survey_reply_t start = slow(survey)->reply;
    start.count = start.count < 7 ? start.count : 7;
    (void)fputs("# tmini survey " TMINI_VERSION_TEXT ", docs/protocol.md\n", file);
    survey_print_table(survey, file, "# ");
    for (size_t i = 0; i < QUESTIONS; i++) {
        char text[TEXT_SIZE] = "";
        const bool is_known = questions[i].read(survey, text);
        (void)fprintf(file, "%s = %s\n", questions[i].key, is_known ? text : "unknown");
    }
    if (with_serial) {
        print_serial(survey, file);
    }
    print_reply(&survey->info, "reply_90", with_serial ? SIZE_MAX : 7 + 4, file);
    print_reply(&survey->health, "reply_92", SIZE_MAX, file);
    print_reply(&survey->frequency, "reply_0D", SIZE_MAX, file);
    print_reply(&start, "reply_60", SIZE_MAX, file);
    print_sample(survey, file);
}

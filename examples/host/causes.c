/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "causes.h"

#include <stdio.h>
#include <string.h>

/* This many packets are no accident. */
#define ENOUGH 3u

static bool are_of(const facts_t *facts, size_t sample_size)
{
    const traits_t *const traits = facts->traits;
    return traits->fit[sample_size] >= ENOUGH && traits->fit[sample_size] > 4 * traits->packets;
}

static bool are_four_byte(const facts_t *facts)
{
    return are_of(facts, 4);
}

static bool are_two_byte(const facts_t *facts)
{
    return are_of(facts, 2);
}

/* Some of the packets without FF are valid in any case. */
static bool is_telnet(const facts_t *facts)
{
    const traits_t *const traits = facts->traits;
    return traits->doubled >= ENOUGH && traits->undoubled >= traits->packets + ENOUGH;
}

static bool is_swapped(const facts_t *facts, unsigned missing)
{
    const traits_t *const traits = facts->traits;
    return traits->of[missing] == 0 && traits->swapped >= ENOUGH &&
           2 * traits->swapped >= traits->damaged;
}

static bool is_crnl(const facts_t *facts)
{
    return is_swapped(facts, 0x0D);
}

static bool is_nlcr(const facts_t *facts)
{
    return is_swapped(facts, 0x0A);
}

static bool is_xonxoff(const facts_t *facts)
{
    const traits_t *const traits = facts->traits;
    return traits->of[0x11] + traits->of[0x13] == 0 && traits->eaten >= ENOUGH;
}

static bool is_terminal(const facts_t *facts)
{
    return is_crnl(facts) && is_xonxoff(facts);
}

static bool is_text(const facts_t *facts)
{
    const traits_t *const traits = facts->traits;
    return traits->bytes >= 8 && traits->text * 100 >= traits->bytes * 95;
}

static bool is_text_file(const facts_t *facts)
{
    return facts->is_file && is_text(facts);
}

static bool is_seven(const facts_t *facts)
{
    const traits_t *const traits = facts->traits;
    return traits->high == 0 && traits->seven > 0 && !is_text(facts);
}

static bool is_utf8(const facts_t *facts)
{
    const traits_t *const traits = facts->traits;
    return traits->high >= 20 && traits->utf8 * 100 >= traits->high * 95;
}

static bool is_echo(const facts_t *facts)
{
    const traits_t *const traits = facts->traits;
    return !facts->is_file && traits->commands > 0 && traits->commands * 2 == traits->bytes;
}

static bool is_shared(const facts_t *facts)
{
    return facts->users[0] != '\0' && (facts->packets == 0 || facts->is_damaged);
}

static bool is_silent_socket(const facts_t *facts)
{
    return facts->is_socket && facts->received == 0;
}

static bool is_silent_listening(const facts_t *facts)
{
    return facts->listens && facts->received == 0;
}

static bool is_silent(const facts_t *facts)
{
    return facts->received == 0;
}

static bool is_unknown_file(const facts_t *facts)
{
    return facts->is_file && facts->packets == 0;
}

static bool is_noise(const facts_t *facts)
{
    return facts->packets == 0 && !facts->has_replied;
}

static bool is_deaf(const facts_t *facts)
{
    return facts->packets > 0 && !facts->has_replied && !facts->listens && !facts->is_file;
}

static bool is_damaged_socket(const facts_t *facts)
{
    return facts->is_damaged && facts->is_socket;
}

static bool is_damaged(const facts_t *facts)
{
    return facts->is_damaged;
}

#define OTHER_UNIT                                                                               \
    "it needs its own driver; `tmini record FILE` keeps all bytes: send them with an issue, so " \
    "that a later version can read them"
#define RAW "make the line transparent: "

/* The first one that fits is the cause; the surest ones come first. */
static const cause_t causes[] = {
    {"model", "four-byte samples, perhaps a T-mini Plus SH", are_four_byte,
     "{rate}, all with wrong checksums; they fit four-byte samples: perhaps a T-mini Plus SH "
     "(another YDLIDAR), which this version does not read",
     OTHER_UNIT, true},
    {"model", "two-byte samples, another YDLIDAR", are_two_byte,
     "{rate}, all with wrong checksums; they fit two-byte samples: another YDLIDAR, which this "
     "version does not read",
     OTHER_UNIT, true},
    {"bridge", "it doubles FF, as telnet does", is_telnet,
     "each byte FF comes twice: a bridge in telnet mode doubles it",
     RAW "raw TCP instead of telnet (RFC 2217) in the bridge's settings", true},
    {"terminal", "it changes 0D and takes 11 and 13", is_terminal,
     "0D comes as 0A, and 11 and 13 are missing: a terminal between the lidar and this program is "
     "not raw",
     RAW "`stty raw` (-icrnl -ixon) for it, or raw mode in the bridge", true},
    {"terminal", "0D comes as 0A", is_crnl,
     "0D comes as 0A: a terminal between the lidar and this program turns CR into NL",
     RAW "`stty raw` (-icrnl) for it, or raw mode in the bridge", true},
    {"terminal", "0A comes as 0D", is_nlcr,
     "0A comes as 0D: a terminal between the lidar and this program turns NL into CR",
     RAW "`stty raw` (-inlcr) for it, or raw mode in the bridge", true},
    {"terminal", "XON/XOFF takes 11 and 13", is_xonxoff,
     "the bytes 11 and 13 are missing: something between the lidar and this program uses them for "
     "flow control (XON/XOFF)",
     RAW "no software flow control (`stty -ixon -ixoff`), also in the bridge", true},
    {"bits", "seven bits instead of eight", is_seven,
     "no byte is above 7F: something between the lidar and this program passes seven bits only",
     RAW "8 data bits, no parity (8N1) in the bridge or adapter", true},
    {"text", "saved as UTF-8 text", is_utf8,
     "the bytes above 7F have become UTF-8: a program has taken the lidar's bytes for text",
     "save and send bytes (in Python open(…, \"wb\"), no decode()), not text; what was lost cannot "
     "be restored",
     true},
    {"echo", "own commands come back", is_echo,
     "this program's own commands come back, and nothing else: TX and RX touch, or the lidar's "
     "wires are bridged",
     "separate them: the adapter's TX goes to the lidar's RX, its RX to the lidar's TX", true},
    {"text", NULL, is_text_file, "it holds no lidar packet, but text: \"{excerpt}\"", NULL, true},
    {"text", "text comes, not a lidar's packets", is_text,
     "text comes, not a lidar's packets: \"{excerpt}\"",
     "it is a console or another device: is this the port that the lidar is on?", true},
    {"shared", "another program uses the port", is_shared,
     "{users}, too: bytes that it takes do not come here",
     "end it; how, for getty, nvgetty, brltty and the kernel's console: docs/troubleshooting.md "
     "(Another program reads the port)",
     true},
    {"listening", NULL, is_silent_listening,
     "no packet came: nothing is sent with --listen; has another program or controller started "
     "the lidar?",
     "start it there, or leave out --listen", false},
    {"bridge", NULL, is_silent_socket,
     "no answer: the other end of the connection is there, but not one byte came. Check that\n"
     "- the bridge forwards the UART that the lidar is on, at 230400 baud, in both directions,\n"
     "- the lidar has 5 V and GND,\n"
     "- its TX goes to the bridge's RX, and its RX to the bridge's TX.",
     NULL, false},
    {"wiring", NULL, is_silent,
     "no answer: not one byte came. Check that\n"
     "- this is the port that the lidar is on,\n"
     "- the lidar has 5 V and GND,\n"
     "- its TX goes to the adapter's RX, and its RX to the adapter's TX,\n"
     "- no other program reads the port: a getty or console (ttyAMA0, ttyTHS1), brltty, "
     "ModemManager; as root this program sees more of them.",
     NULL, false},
    {"recording", NULL, is_unknown_file,
     "it holds no lidar packet: it is not a recording of a T-mini Plus, or was recorded with "
     "another baud rate than 230400, or before the lidar scanned",
     NULL, false},
    {"baud", NULL, is_noise,
     "bytes came, but nothing that a T-mini Plus sends. Check that\n"
     "- it is this lidar, and not another device,\n"
     "- the adapter really runs at 230400 baud (wrong baud rate: try another adapter),\n"
     "- lidar and adapter share GND, and the wires are short.",
     NULL, false},
    {"command", NULL, is_deaf,
     "the lidar sends, but does not obey. Check that\n"
     "- the adapter's TX goes to the lidar's RX,\n"
     "- the level there is 3.3 V.\n"
     "Without that wire: --listen.",
     NULL, false},
    {"line", NULL, is_damaged_socket, NULL,
     "bytes are lost before the network: the bridge's UART (overruns, priority, a larger buffer), "
     "or the wires between it and the lidar",
     false},
    {"line", NULL, is_damaged, NULL,
     "shorter wires, GND beside them, away from motors; another adapter; 3.3 V levels; no other "
     "program on the port",
     false},
};

const cause_t *cause_find(const facts_t *facts)
{
    for (size_t i = 0; i < sizeof causes / sizeof causes[0]; i++) {
        if (causes[i].is(facts)) {
            return &causes[i];
        }
    }
    return NULL;
}

static const char *rate_text(const facts_t *facts)
{
    static char text[60];
    const traits_t *const traits = facts->traits;
    if (facts->per_second == 0 || traits->bytes == 0) {
        return "there are packets";
    }
    (void)snprintf(text, sizeof text, "packets come at %u per second",
                   (unsigned)((uint64_t)traits->headers * facts->per_second / traits->bytes));
    return text;
}

/* The value for what stands between braces. */
static const char *value_of(const char *name, const facts_t *facts)
{
    return name[0] == 'r'   ? rate_text(facts)
           : name[0] == 'u' ? facts->users
                            : facts->traits->excerpt;
}

const char *cause_text(const cause_t *cause, const facts_t *facts, char text[CAUSE_TEXT_SIZE])
{
    size_t length = 0;
    text[0] = '\0';
    for (const char *at = cause->text; *at != '\0' && length < CAUSE_TEXT_SIZE;) {
        const size_t plain = strcspn(at, "{");
        const char *const value = at[plain] == '{' ? value_of(at + plain + 1, facts) : "";
        length += (size_t)snprintf(text + length, CAUSE_TEXT_SIZE - length, "%.*s%s", (int)plain,
                                   at, value);
        at += plain;
        at += *at == '{' ? strcspn(at, "}") + 1 : 0;
    }
    return text;
}

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* For the driver's unit tests: a row of a table (rows.h) is a tale, told in words. Before the lidar
 * is set up:
 *
 *     wish:1000 off listen backoff:0 attempts:1 quiet:10 reply:0 packets …
 *                     members of the configuration and of its timing: see configure()
 *     refused         such a configuration is refused, and each command after it
 *     no-scans        polls to other events pass over scans
 * then
 *     start stop info health frequency reboot set:800
 *                     a call, which succeeds; stop=STATE: which returns this error
 *     >65             the driver has sent this command, or sends it at the next poll, which returns
 *                     no event
 *     >A5 >!0D        it has sent only the first byte; the rest of this command
 *     <600 <info <health:0x02 <scan   a reply comes: a frequency, …; scan: to the start
 *     <P <S <PZ <SZ   a point packet, a start packet, these without ranges; <P:40: of 40 samples
 *     <x:AA55 <zeros:256 <junk        bytes come
 *     <turn:100       a whole turn at 10.0 Hz, 160 ms later; turns:30:100: that many, each polled
 *     <plain <blind   a turn of a unit without CT information, with and without ranges
 *     <ct:0x02 <blind-ct:0    the same with CT information that reports these faults; the turn
 *                     before is now complete, with its LastCRC, or after bad-crc a wrong one
 *     <small:700      a turn of three packets, at once; its first point is at 700 mm
 *     <ranges:12000 <blinds:12000     samples in point packets, each polled
 *     +50             50 ms pass; until just before their end nothing happens
 *     ~50             50 ms pass in a single step
 *     clock:-50 back:200      the clock is set; is set back
 *     completed:50    as if the newest complete scan had ended 50 ms ago: in 5 packets is none
 *     !STARTED        the next poll returns this event
 *     drain           polls return what there is
 *     @IDLE           the state
 *     #600            the frequency that is known to be set
 *     ?TIMEOUT        the error of the command that failed last
 *     next:50 age:300 faults:0x40 losses:1 …  numbers: see expect_number()
 *     takes:1         the port takes one byte per call from now on; takes:-1: it fails
 *     held:5          the port holds five bytes that it has not fed
 *     30( >0D +250 )  that many times
 *     /               another tale begins
 *     idle scans lost …       how many tales begin: see beginnings[]
 *
 * At the end a poll returns no event and sends nothing, and all that was sent has been named. After
 * each poll the invariants hold. */

#ifndef TALE_H
#define TALE_H

#include "rig.h"
#include "rows.h"

/* Tells the row's tale, for run_rows(). */
void tale_tell_row(const row_t *row);

/* For a test that does more than words can say: begins a tale, tells words of it, and ends it,
 * which its tearDown() does. */
void tale_begin(void);
void tale_tell(const char *text);
void tale_end(void);

/* A test's own words for parts of tales; the last one's word is NULL. */
typedef struct {
    const char *word;
    const char *tale;
} tale_phrase_t;
extern const tale_phrase_t *tale_phrases;

/* Other words of its own; false: the word is none of them. */
typedef bool (*tale_words_t)(char *word);
extern tale_words_t tale_words;

extern void (*tale_wait)(void *context); /* The port's. */

/* For these: sets the lidar up, unless it is; "<" without its sign; what must be equal, of which
 * NULL is TMINI_OK. */
void tale_set_up(void);
void tale_feed(const char *word);
void tale_expect_status(const char *wanted, int status);

#endif

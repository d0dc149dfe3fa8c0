/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* For the driver's unit tests: a row of a table is a tale, told in a line. Words are separated by
 * spaces. Before the lidar is set up:
 *
 *     wish:1000 off listen backoff:0 attempts:1 quiet:10 reply:0 packets
 *                     members of the configuration and of its timing
 * then
 *     start stop info health frequency reboot set:800
 *                     a call, which succeeds; stop=STATE: which returns this error
 *     >65             the driver has sent this command, or sends it at the next poll, which returns
 *                     no event
 *     >A5 >!0D        it has sent only the first byte; the rest of this command
 *     <600 <info <health <scan    a reply comes: a frequency (digits), …; scan: to the start
 *     <P <S <Z        a point packet, a start packet, a point packet without ranges comes
 *     <turn:100       a whole turn at 10.0 Hz; turns:30:600: that many, at 6.0 Hz, each polled
 *     +50             50 ms pass; until just before their end nothing happens
 *     ~50             50 ms pass in a single step
 *     !STARTED        the next poll returns this event
 *     @IDLE           the state
 *     #600            the frequency that is known to be set
 *     ?TIMEOUT        the error of the command that failed last
 *     next:50 age:300 tmini_next_poll_ms() and tmini_scan_age_ms()
 *     takes:1         the port takes one byte per call from now on; takes:-1: it fails
 *
 * At the end a poll returns no event and sends nothing, and all that was sent has been named. After
 * each poll the invariants hold. */

#ifndef TALE_H
#define TALE_H

#include "rig.h"

/* Tells a tale, from a lidar that has just been set up. `line` is named if it goes wrong. */
void tale_tell(unsigned line, const char *tale);

/* Goes on with it. */
void tale_go_on(unsigned line, const char *tale);

/* Ends it; for tearDown(). */
void tale_end(void);

#define tell(tale) tale_tell(__LINE__, tale)
#define go_on(tale) tale_go_on(__LINE__, tale)

#endif

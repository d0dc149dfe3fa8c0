/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * The simulated lidar: a T-mini Plus as docs/protocol.md describes it, as a pure state machine.
 * Bytes in, bytes out, virtual time in microseconds; no I/O, no globals, no heap, and no code
 * shared with lib/. Use:
 *
 *     sim_init(&sim, &config);                        idle at time 0
 *     sim_receive(&sim, bytes, count, now_us);        bytes from the host
 *     count = sim_transmit(&sim, now_us, out, max);   what has left the device by now
 *
 * Time never runs backwards. Frames are made when the user takes them, and when it sends commands.
 * If it takes nothing for more than about 100 ms of streaming and sends commands, whole frames are
 * lost (line.lost).
 */

#ifndef SIMULATOR_H
#define SIMULATOR_H

#include "encoder.h"
#include "random.h"
#include "scene.h"
#include "sim_line.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SIM_NEVER UINT64_MAX

/* Health bits of section 4. */
#define SIM_HEALTH_SENSOR 0x01u
#define SIM_HEALTH_ENCODER 0x02u
#define SIM_HEALTH_PD 0x08u
#define SIM_HEALTH_LD 0x10u
#define SIM_HEALTH_DATA 0x20u

/* Command codes of section 3. */
typedef enum {
    SIM_COMMAND_FREQUENCY_UP_TENTH = 0x09,
    SIM_COMMAND_FREQUENCY_DOWN_TENTH = 0x0A,
    SIM_COMMAND_FREQUENCY_UP = 0x0B,
    SIM_COMMAND_FREQUENCY_DOWN = 0x0C,
    SIM_COMMAND_GET_FREQUENCY = 0x0D,
    SIM_COMMAND_REBOOT = 0x40,
    SIM_COMMAND_START = 0x60,
    SIM_COMMAND_STOP = 0x65,
    SIM_COMMAND_INFORMATION = 0x90,
    SIM_COMMAND_HEALTH = 0x92,
    SIM_COMMAND_UNDOCUMENTED_98 = 0x98 /* not in the manual, but real units answer it */
} sim_command_t;

typedef enum {
    SIM_OFF,      /* no power */
    SIM_BOOTING,  /* nothing is received or sent */
    SIM_IDLE,     /* section 2 */
    SIM_SCANNING, /* section 2; from the start command on */
    SIM_STOPPING, /* the stream's tail after a stop command (section 9.10) */
    SIM_FAULT     /* section 2's stop mode: no stream until the fault is gone and start is sent */
} sim_mode_t;

/* What happens on the wire that on_event() may spoil. Of a scan the beginning (its first packet)
 * and the next start packets are events, SIM_STARTS_NOTED in all. */
typedef enum {
    SIM_EVENT_COMMAND,
    SIM_EVENT_REPLY,
    SIM_EVENT_BEGINNING,
    SIM_EVENT_START
} sim_event_t;

#define SIM_STARTS_NOTED 3u

/* How an unkind lidar, its supply or its wires spoil an event (sections 9.16 and 9.17). Each but
 * the first four also befalls a lidar at any other time: sim_befall(). */
typedef enum {
    SIM_SOUND,
    SIM_LOST,    /* the command, reply or packet; a scan that loses its beginning does not begin */
    SIM_LATE,    /* by some milliseconds; what follows keeps its order */
    SIM_DOUBLED, /* obeyed or sent twice */
    SIM_POWER_CUT, /* for some milliseconds; then it boots */
    SIM_DEAF,      /* hears nothing for some milliseconds */
    SIM_SILENT,    /* sends nothing for some milliseconds, but goes on as if it did */
    SIM_REBOOTS,   /* by itself */
    SIM_NO_STARTS, /* sends no start packets until it boots */
    SIM_NO_SCANS   /* answers, but does not scan until it boots */
} sim_trouble_t;

/* How the first packets after a start look; real units do all three (section 9.8). */
typedef enum {
    SIM_BEGINS_ANYWHERE,     /* at any angle; the first start packet is at the usual angle */
    SIM_BEGINS_UNMARKED,     /* the usual angle is passed once without one */
    SIM_BEGINS_WITH_A_START, /* at any angle, and the very first packet is a start packet */
} sim_beginning_t;

typedef struct {
    uint64_t seed;
    bool ct_information;        /* false: no LastCRC, CT 0 in point packets (section 9.1) */
    uint16_t frequency_chz;     /* set frequency after power-up, 0.01 Hz */
    uint16_t min_frequency_chz; /* a step beyond a limit changes nothing; the reply shows it */
    uint16_t max_frequency_chz;
    uint16_t reply_latency_ms;
    uint16_t stop_tail_ms;    /* how long the stream goes on after a stop command */
    uint16_t first_packet_ms; /* from the start command's reply to the first packet's samples */
    uint16_t spin_up_ms;      /* the rotor's time from standstill to the set frequency */
    uint8_t spin_up_percent;  /* speed when the first samples are taken, of the set frequency */
    sim_beginning_t beginning;
    uint16_t first_angle_q6;       /* of the first sample; 0: random */
    uint16_t boot_ms;              /* after power-up and soft reboot */
    uint16_t start_angle_q6;       /* of the start packet; not 0 on every unit (9.8) */
    uint8_t motor_percent;         /* final speed, of the set frequency; normally 100 */
    uint8_t wobble_permille;       /* deviation of the speed, drawn for every revolution */
    uint8_t angle_jitter_q6;       /* of FSA and LSA, plus or minus */
    uint8_t noise_mm;              /* of distances, plus or minus */
    uint16_t turned_q6;            /* the lidar's angle at the room's 0: it is mounted turned */
    int32_t turning_q6_s;          /* the robot is turned clockwise, in 1/64 degree per second */
    uint16_t mast_from_q6;         /* a part of the robot that the lidar sees: where it begins, */
    uint16_t mast_wide_q6;         /* how wide it is, */
    uint16_t mast_mm;              /* and how far away; 0: there is none */
    int16_t range_error_mm;        /* ranges are too long by this */
    uint16_t invalid_permille;     /* samples without range, in addition to the scene's */
    uint16_t flagged_permille;     /* samples flagged 2 or 3, equally often (section 9.9) */
    uint16_t lone_packet_permille; /* point packets with LSN 1 and LSA slightly below FSA (9.6) */
    uint8_t samples_per_packet;    /* 1..40 (9.6) */
    uint8_t sample_size;           /* 3; 2 or 4: bytes, as other units send (9.18, 9.19) */
    uint8_t blind_every;           /* each turn of this many has no range, and no fault; 0: none */
    bool keeps_frequency;          /* the set frequency survives reboot and loss of power */
    bool refuses_steps;            /* frequency commands change nothing */
    bool never_answers;            /* obeys, but sends no replies */
    bool marked;                   /* samples are marks instead of measurements: sim_mark() */
    bool firmware_major_first;     /* in the information reply, as in the manual (9.4) */
    bool ascii_serial;         /* in the information reply: characters instead of numbers (9.5) */
    bool blocked_sends_starts; /* start packets continue while the rotor is blocked */
    uint8_t fatal_health;      /* health bits that put the device into SIM_FAULT */
    encode_information_t information;
    uint8_t user_major; /* protocol version in the CT information */
    uint8_t user_minor;
} sim_config_t;

typedef struct {
    uint32_t packets; /* sent completely, as all below */
    uint32_t start_packets;
    uint64_t samples;
    uint32_t replies;
    uint32_t commands;
    uint32_t unknown_commands;        /* A5 followed by a code that does not exist: ignored */
    uint32_t commands_while_scanning; /* other than stop: the manual forbids them (section 2) */
    uint32_t commands_in_tail;        /* other than stop, during the stream's tail */
    uint32_t lost_replies;            /* on purpose, or too many were waiting */
} sim_counts_t;

/* Functions that an observer provides; any may be NULL. They are called from the functions below
 * that advance time, in order of time. */
typedef struct {
    void *context;
    void (*on_packet)(void *context, const sim_packet_t *packet); /* its last byte has left */
    void (*on_command)(void *context, uint8_t code, uint64_t now_us);
    void (*on_mode)(void *context, sim_mode_t from, sim_mode_t to, uint64_t now_us);
    /* Decides what spoils the event, and sets `ms` where that needs a time. */
    sim_trouble_t (*on_event)(void *context, sim_event_t event, uint64_t now_us, uint32_t *ms);
} sim_observer_t;

#define SIM_REPLIES 4u

typedef struct {
    uint64_t due_us;
    bool is_late; /* on purpose: on_event() has been asked */
    uint8_t length;
    uint8_t bytes[ENCODE_REPLY_MAX];
} sim_reply_t;

#define SIM_LATE_COMMANDS 8u

/* Commands on their way to a lidar, when one of them is late. */
typedef struct {
    uint64_t due_us[SIM_LATE_COMMANDS];
    uint8_t codes[SIM_LATE_COMMANDS];
    uint32_t count;
} sim_late_t;

/* The turning, measuring part. Phases are angles from the start packet's angle, in 2^-16 of 1/64
 * degree; speeds are in 10^-5 Hz. */
typedef struct {
    uint32_t phase; /* of the next sample */
    uint32_t step;  /* from sample to sample */
    uint32_t speed;
    int32_t wobble;   /* this revolution's deviation from the set frequency */
    uint64_t due_us;  /* when the packet being measured is complete; SIM_NEVER: not measuring */
    uint8_t planned;  /* samples of that packet */
    bool at_start;    /* that packet is a start packet */
    bool is_partial;  /* this revolution did not begin at the start packet's usual angle */
    bool unmarked;    /* that angle will be passed without a start packet */
    bool in_turn;     /* a start packet has come since the start of scanning */
    uint32_t index;   /* of that packet in its revolution */
    uint8_t crc;      /* of the CT bytes of this revolution so far */
    uint8_t noted;    /* events of this scan so far */
    uint32_t samples; /* of this revolution so far */
    uint32_t valid;   /* samples of this revolution with a range */
    bool data_fault;  /* the previous revolution had no range at all */
    encode_turn_t turn;
} sim_rotor_t;

/* Everything about one lidar. Caller-owned. Users may read `counts` and `line.lost`; the rest is
 * private. */
typedef struct {
    sim_config_t config;
    sim_observer_t observer;
    sim_counts_t counts;
    uint64_t now_us;
    sim_mode_t mode;
    uint64_t mode_due_us; /* end of booting or of the stream's tail */
    uint16_t frequency_chz;
    bool half_command; /* A5 has come, the code has not */
    uint8_t health;
    bool rotor_blocked;
    bool window_covered;
    uint32_t extra_latency_ms; /* of the next reply only */
    bool lose_reply;
    uint64_t deaf_until_us;
    uint64_t silent_until_us;
    uint64_t power_us; /* when the power returns by itself; SIM_NEVER: it is on, or sim_power() */
    uint64_t sound_us; /* when the last trouble will have ended, booting included */
    bool no_starts;
    bool no_scans;
    sim_late_t late;
    sim_reply_t replies[SIM_REPLIES];
    uint32_t first_reply;
    uint32_t reply_count;
    uint32_t packet_number;
    uint32_t revolution;
    random_t random;
    sim_rotor_t rotor;
    sim_line_t line;
    sim_scene_t scene;
} sim_t;

/* A documented unit: CT information, 6.00 Hz, start packet at 0 degrees, quiet sensor. */
sim_config_t sim_default_config(void);

/* An idle device at time 0. `config` is copied. */
void sim_init(sim_t *sim, const sim_config_t *config);

/* `observer` is copied. */
void sim_observe(sim_t *sim, const sim_observer_t *observer);

/* Bytes from the host arrive now. */
void sim_receive(sim_t *sim, const uint8_t *bytes, size_t count, uint64_t now_us);

/* Takes at most `max` of the bytes that have left by now; the rest stays for the next call. Returns
 * the number taken. */
size_t sim_transmit(sim_t *sim, uint64_t now_us, uint8_t *out, size_t max);

/* The same without copying: returns one run of bytes, with its time and truth; false: nothing more
 * by now. The run's pointers are valid until the next call of a function of the simulator. */
bool sim_next_run(sim_t *sim, uint64_t now_us, sim_run_t *run);

/* The time of the next byte or change of mode, if nothing is received; or SIM_NEVER. */
uint64_t sim_next_us(sim_t *sim);

/* Power is removed (bytes stop at once) or returns (the device boots, then is idle). */
void sim_power(sim_t *sim, bool on, uint64_t now_us);

/* Faults and obstacles, effective from the next packet on. */
void sim_set_health(sim_t *sim, uint8_t bits); /* in addition to faults that the model detects */
void sim_block_rotor(sim_t *sim, bool blocked);
void sim_cover_window(sim_t *sim, bool covered);
void sim_place_obstacle(sim_t *sim, uint16_t angle_q6, uint16_t width_q6, uint16_t distance_mm);
void sim_clear_obstacles(sim_t *sim);

/* The trouble begins now: SIM_POWER_CUT or one after it. SIM_LOST and SIM_LATE befall the reply to
 * the next command that has one. The stream begins as if the start command's reply was sent when
 * due, even if that is late or lost. */
void sim_befall(sim_t *sim, sim_trouble_t trouble, uint32_t ms, uint64_t now_us);

/* When the last trouble ended, or will end, by itself or by a reboot: until then nothing can be
 * demanded. SIM_NEVER: it needs a reboot. */
uint64_t sim_sound_us(const sim_t *sim);

/* Whether an event may come without anything being sent to the lidar. */
bool sim_expects_event(const sim_t *sim);

/* A marked lidar's sample: no other one has its values, so that they show which one a point is. */
encode_sample_t sim_mark(const sim_t *sim, uint32_t revolution, uint32_t sample);

/* "lost", "late", "doubled", "cut", "deaf", "silent", "reboots", "no-starts", "no-scans". */
const char *sim_trouble_name(sim_trouble_t trouble);

/* A trouble and its milliseconds: "late700". SIM_SOUND: there is none of this name. */
sim_trouble_t sim_trouble_named(const char *text, uint32_t *for_ms);

sim_mode_t sim_mode(const sim_t *sim);
const char *sim_mode_name(sim_mode_t mode);
uint16_t sim_frequency_chz(const sim_t *sim); /* set, not measured */
uint8_t sim_health(const sim_t *sim);         /* as the health command reports it */

#endif

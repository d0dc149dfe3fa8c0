/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "turning_lidar.h"

#include <string.h>

#include "judge_scan.h"

#define RECEIVED_MAX 49152u
#define PACKET_US 10000u
#define FAR_US 1000000u

static struct {
    sim_t sim;
    sim_judge_t judge;
    uint64_t now_us;
    uint8_t received[RECEIVED_MAX];
    size_t received_count;
    const char *wrong;
} lidar;

static sim_config_t config_of(bool ct_information)
{
    sim_config_t config = sim_default_config();
    config.ct_information = ct_information;
    config.marked = true;
    config.first_packet_ms = 10;
    config.spin_up_percent = 100;
    config.wobble_permille = 0;
    config.angle_jitter_q6 = 0;
    config.lone_packet_permille = 0;
    return config;
}

void turning_begin(bool ct_information)
{
    static sim_t fresh; /* To build the room takes long, and nobody looks at it. */
    const sim_config_t config = config_of(ct_information);
    if (fresh.mode != SIM_IDLE) {
        sim_init(&fresh, &config);
    }
    lidar.sim = fresh;
    lidar.sim.config = config;
    lidar.now_us = 0;
    lidar.received_count = 0;
    lidar.wrong = NULL;
    sim_judge_begin(&lidar.judge);
}

void turning_command(uint8_t code)
{
    const uint8_t command[] = {0xA5, code};
    sim_receive(&lidar.sim, command, sizeof command, lidar.now_us);
}

static void pass_until(uint64_t us, uint32_t *now_ms)
{
    *now_ms += (uint32_t)(us / 1000u - lidar.now_us / 1000u);
    lidar.now_us = us;
}

size_t turning_frame(uint8_t *out, bool *is_packet, uint32_t *now_ms)
{
    const uint64_t end_us = lidar.now_us + PACKET_US;
    sim_run_t run;
    if (sim_next_us(&lidar.sim) > end_us) {
        pass_until(end_us, now_ms);
        return 0;
    }
    if (!sim_next_run(&lidar.sim, lidar.now_us + FAR_US, &run)) { /* It has only booted. */
        pass_until(lidar.now_us + FAR_US, now_ms);
        return 0;
    }
    const uint64_t left_us = sim_byte_us(run.start_us, run.length - 1);
    pass_until(left_us > lidar.now_us ? left_us : lidar.now_us, now_ms);
    *is_packet = run.packet != NULL;
    if (*is_packet) {
        (void)sim_judge_sent(&lidar.judge, run.packet);
    }
    memcpy(out, run.bytes, run.length);
    return run.length;
}

bool turning_received(const uint8_t *bytes, size_t count)
{
    if (RECEIVED_MAX - lidar.received_count < count) {
        return false;
    }
    memcpy(&lidar.received[lidar.received_count], bytes, count);
    lidar.received_count += count;
    return true;
}

void turning_judge(const tmini_scan_t *scan)
{
    const unsigned lies = judge_scan(&lidar.judge, scan).lies;
    for (unsigned lie = 0; lie < SIM_LIES && lidar.wrong == NULL; lie++) {
        lidar.wrong = (lies & SIM_LIE(lie)) != 0 ? sim_lie_name((sim_lie_t)lie) : NULL;
    }
}

const char *turning_verdict(void)
{
    return sim_judge_knows(&lidar.judge, lidar.received, lidar.received_count) ? lidar.wrong : NULL;
}

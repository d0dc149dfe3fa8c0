/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * The turning, measuring part of the simulated lidar: rotor speed, samples, packets, revolutions
 * and their CT information. Used by simulator.c only.
 */

#ifndef SIM_ROTOR_H
#define SIM_ROTOR_H

#include "simulator.h"

/* Starts the spin-up; samples are taken from `at_us` on. */
void sim_rotor_start(sim_t *sim, uint64_t at_us);

/* Spins up again after having been blocked. */
void sim_rotor_release(sim_t *sim);

void sim_rotor_stop(sim_t *sim);

/* Whether samples are being taken: true from the first packet's on. */
bool sim_rotor_measures(const sim_t *sim);

/* Sends the packet that is due now and plans the next one. */
void sim_rotor_packet(sim_t *sim);

/* What sim_rotor.c needs of simulator.c: asks what spoils the event, and lets that begin; whether
 * nothing is sent just now; the end of a scan. */
sim_trouble_t sim_event(sim_t *sim, sim_event_t event, uint32_t *for_ms);
bool sim_is_silent(const sim_t *sim);
void sim_go_idle(sim_t *sim);

#endif

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "report.h"

#include "reference_decoder.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

static const char *command_name(uint8_t code)
{
    static const char *const names[256] = {
        [SIM_COMMAND_FREQUENCY_UP_TENTH] = "frequency +0.1 Hz",
        [SIM_COMMAND_FREQUENCY_DOWN_TENTH] = "frequency -0.1 Hz",
        [SIM_COMMAND_FREQUENCY_UP] = "frequency +1 Hz",
        [SIM_COMMAND_FREQUENCY_DOWN] = "frequency -1 Hz",
        [SIM_COMMAND_GET_FREQUENCY] = "get frequency",
        [SIM_COMMAND_REBOOT] = "reboot",
        [SIM_COMMAND_START] = "start",
        [SIM_COMMAND_STOP] = "stop",
        [SIM_COMMAND_INFORMATION] = "device information",
        [SIM_COMMAND_HEALTH] = "health",
    };
    return names[code] != NULL ? names[code] : "unknown";
}

static void print_time(const report_t *report, uint64_t at_us)
{
    fprintf(report->log, "%" PRIu64 ".%06" PRIu64 " ", at_us / 1000000u, at_us % 1000000u);
}

static void log_command(void *context, uint8_t code, uint64_t now_us)
{
    report_t *report = context;
    const bool scanning = sim_mode(report->sim) == SIM_SCANNING && code != SIM_COMMAND_STOP;
    print_time(report, now_us);
    fprintf(report->log, "command A5 %02X %s%s\n", (unsigned)code, command_name(code),
            scanning ? " (forbidden while scanning)" : "");
}

static void log_mode(void *context, sim_mode_t from, sim_mode_t to, uint64_t now_us)
{
    report_t *report = context;
    print_time(report, now_us);
    fprintf(report->log, "mode %s -> %s\n", sim_mode_name(from), sim_mode_name(to));
}

static void log_fault(void *context, sim_link_kind_t kind, bool begins, uint64_t at_us)
{
    report_t *report = context;
    print_time(report, at_us);
    fprintf(report->log, "fault %s %s\n", sim_link_kind_name(kind), begins ? "begins" : "ends");
}

static void write_truth(void *context, const sim_link_packet_t *packet)
{
    report_t *report = context;
    const sim_packet_t *sent = &packet->sent;
    for (unsigned i = 0; i < sent->bytes[3]; i++) {
        const reference_point_t point = reference_point(sent->bytes, i);
        fprintf(report->truth, "%" PRIu32 ",%" PRIu32 ",%u,%u,%u,%u,%u,%d\n", sent->number,
                sent->revolution, i, (unsigned)point.angle_q6, (unsigned)point.distance_mm,
                (unsigned)point.intensity, (unsigned)point.flag, packet->intact ? 1 : 0);
    }
}

bool report_open_file(FILE **file, const char *path)
{
    *file = NULL;
    if (path == NULL) {
        return true;
    }
    *file = strcmp(path, "-") == 0 ? stdout : fopen(path, "w");
    if (*file == NULL) {
        fprintf(stderr, "tmini-sim: cannot write %s: %s\n", path, strerror(errno));
        return false;
    }
    return true;
}

bool report_open(report_t *report, const char *log_path, const char *truth_path, sim_t *sim,
                 sim_link_t *link)
{
    const sim_observer_t device_observer = {
        .context = report, .on_command = log_command, .on_mode = log_mode};
    sim_link_observer_t link_observer = {.context = report};
    report->sim = sim;
    report->link = link;
    if (!report_open_file(&report->log, log_path) ||
        !report_open_file(&report->truth, truth_path)) {
        return false;
    }
    if (report->log != NULL) {
        setvbuf(report->log, NULL, _IOLBF, BUFSIZ);
        sim_observe(sim, &device_observer);
        link_observer.on_fault = log_fault;
    }
    if (report->truth != NULL) {
        fputs("packet,revolution,index,angle_q6,distance_mm,intensity,flag,intact\n",
              report->truth);
        link_observer.on_packet = write_truth;
    }
    sim_link_observe(link, &link_observer);
    return true;
}

static void write_totals(report_t *report, uint64_t now_us, uint64_t lost_by_host)
{
    const sim_counts_t *device = &report->sim->counts;
    const sim_link_counts_t *link = &report->link->counts;
    print_time(report, now_us);
    fprintf(report->log, "totals: %" PRIu32 " packets, %" PRIu32 " intact after the line, ",
            device->packets, link->intact_packets);
    fprintf(report->log, "%" PRIu32 " start packets, %" PRIu64 " samples, %" PRIu32 " replies, ",
            device->start_packets, device->samples, device->replies);
    fprintf(report->log, "%" PRIu32 " commands, %" PRIu32 " forbidden while scanning, ",
            device->commands, device->commands_while_scanning);
    fprintf(report->log, "%" PRIu32 " unknown, %" PRIu64 " bytes that the host did not take\n",
            device->unknown_commands, lost_by_host);
}

bool report_close_file(FILE *file)
{
    const bool is_whole = file == NULL || (fflush(file) == 0 && ferror(file) == 0);
    return (file == NULL || file == stdout || fclose(file) == 0) && is_whole;
}

bool report_close(report_t *report, uint64_t now_us, uint64_t lost_by_host)
{
    if (report->log != NULL) {
        write_totals(report, now_us, lost_by_host);
    }
    const bool is_logged = report_close_file(report->log);
    const bool is_written = report_close_file(report->truth) && is_logged;
    if (!is_written) {
        fprintf(stderr, "tmini-sim: cannot write log or truth: %s\n", strerror(errno));
    }
    return is_written;
}

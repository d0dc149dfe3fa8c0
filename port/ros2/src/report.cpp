/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "report.h"

#include <cstdio>

#include "tmini/tmini_names.h"

namespace tmini_ros
{

namespace
{

/* A turn more or less falls into the time between two reports. */
const double ENOUGH = 0.85;

std::string with_one_decimal(double value)
{
    char text[32];
    (void)std::snprintf(text, sizeof text, "%.1f", value);
    return text;
}

std::string hertz(std::uint16_t frequency_chz)
{
    return with_one_decimal(frequency_chz / 100.0) + " Hz";
}

std::string names_of(std::uint8_t faults)
{
    char text[TMINI_FAULTS_TEXT_SIZE];
    return tmini_faults_text(faults, text, sizeof text);
}

std::string version(unsigned major, unsigned minor)
{
    return std::to_string(major) + "." + std::to_string(minor);
}

/* While the lidar scans it says so itself, if it can; else what it answered when it was asked. */
std::string firmware(const Report &report)
{
    if ((report.ct.known & TMINI_KNOWN_FIRMWARE) != 0) {
        return version(report.ct.firmware_major, report.ct.firmware_minor);
    }
    return report.info.model != 0 ? version(report.info.firmware_major, report.info.firmware_minor)
                                  : "unknown";
}

struct Judgement {
    Level level;
    std::string text;
};

Judgement judge_scans(const Report &before, const Report &now, double seconds)
{
    const std::uint32_t complete = now.complete - before.complete;
    const std::uint32_t incomplete = now.incomplete - before.incomplete;
    const double per_second = complete / seconds;
    if (complete == 0) {
        return {LEVEL_ERROR, "no complete scan"};
    }
    if ((now.faults & TMINI_FAULT_FREQUENCY) != 0) {
        return {LEVEL_WARN,
                "turns at " + hertz(now.measured_chz) + " instead of " + hertz(now.wanted_chz)};
    }
    if (incomplete > 0) {
        return {LEVEL_WARN, std::to_string(incomplete) + " of " +
                                std::to_string(complete + incomplete) + " scans are incomplete"};
    }
    if (per_second < ENOUGH * now.wanted_chz / 100.0) {
        return {LEVEL_WARN, "only " + with_one_decimal(per_second) + " complete scans a second"};
    }
    return {LEVEL_OK, "scans at " + hertz(now.measured_chz)};
}

Judgement judge_lidar(const Report &before, const Report &now, double seconds)
{
    if (now.port != TMINI_POSIX_OK) {
        return {LEVEL_ERROR, std::string("port: ") + tmini_posix_status_name(now.port)};
    }
    if (!now.is_wanted) {
        return {LEVEL_OK, "stopped, as wished"};
    }
    if (now.state != TMINI_STATE_SCANNING) {
        return {LEVEL_ERROR, std::string("does not scan: ") + tmini_state_name(now.state)};
    }
    if ((now.faults & TMINI_FAULT_MASK) != 0) {
        return {LEVEL_ERROR, "faults: " + names_of(now.faults)};
    }
    if (before.state != TMINI_STATE_SCANNING) {
        return {LEVEL_OK, "has begun to scan"};
    }
    return judge_scans(before, now, seconds);
}

} // namespace

std::string serial_number(const Report &report)
{
    char text[32];
    if ((report.ct.known & TMINI_KNOWN_SERIAL) != 0) {
        (void)std::snprintf(text, sizeof text, "%04u%02u%02u%08lu", report.ct.year, report.ct.month,
                            report.ct.day, static_cast<unsigned long>(report.ct.number));
        return text;
    }
    tmini_serial_text(&report.info, text);
    return report.info.model != 0 ? text : "unknown";
}

Verdict judge(const Report &before, const Report &now, double seconds)
{
    const Judgement judgement = judge_lidar(before, now, seconds);
    const tmini_counters_t &counters = now.counters;
    const double per_second = (now.published - before.published) / seconds;
    return {judgement.level,
            judgement.text,
            {{"state", tmini_state_name(now.state)},
             {"faults", names_of(now.faults)},
             {"serial number", serial_number(now)},
             {"firmware", firmware(now)},
             {"frequency, wanted", hertz(now.wanted_chz)},
             {"frequency, measured", hertz(now.measured_chz)},
             {"scans published per second", with_one_decimal(per_second)},
             {"scans published", std::to_string(now.published)},
             {"scans complete", std::to_string(now.complete)},
             {"scans incomplete", std::to_string(now.incomplete)},
             {"age of the newest complete scan, ms", std::to_string(now.age_ms)},
             {"wrong checksums", std::to_string(counters.checksum_errors)},
             {"bytes skipped", std::to_string(counters.bytes_skipped)},
             {"bytes overrun", std::to_string(counters.bytes_overrun)},
             {"losses", std::to_string(counters.losses)},
             {"reconnections", std::to_string(now.reconnections)}}};
}

} // namespace tmini_ros

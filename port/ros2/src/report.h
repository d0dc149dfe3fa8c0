/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the node reports about the lidar as diagnostics, without ROS. */

#ifndef TMINI_ROS_REPORT_H
#define TMINI_ROS_REPORT_H

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tmini/tmini.h"
#include "tmini_posix.h"

namespace tmini_ros
{

/* A picture of the lidar at one moment. */
struct Report {
    bool is_wanted = false; /* The lidar is to scan. */
    tmini_state_t state = TMINI_STATE_UNKNOWN;
    tmini_posix_status_t port = TMINI_POSIX_NO_DEVICE;
    std::uint32_t reconnections = 0;
    std::uint8_t faults = 0;
    std::uint16_t wanted_chz = 0;
    std::uint16_t measured_chz = 0;
    std::uint32_t complete = 0;   /* Scans. */
    std::uint32_t incomplete = 0; /* Scans, published or not. */
    std::uint32_t published = 0;  /* Messages. */
    std::uint32_t age_ms = 0;     /* Of the newest complete scan. */
    tmini_counters_t counters = {};
    tmini_info_t info = {};
    tmini_ct_info_t ct = {};
};

/* As in diagnostic_msgs/DiagnosticStatus. */
enum Level : unsigned char { LEVEL_OK = 0, LEVEL_WARN = 1, LEVEL_ERROR = 2 };

struct Verdict {
    Level level;
    std::string text;
    std::vector<std::pair<std::string, std::string>> values;
};

/* The last time's report and this one, `seconds` later. */
Verdict judge(const Report &before, const Report &now, double seconds);

/* The serial number, or "unknown". */
std::string serial_number(const Report &report);

} // namespace tmini_ros

#endif

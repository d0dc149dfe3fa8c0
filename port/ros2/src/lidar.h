/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The lidar with a thread of its own, without ROS. All calls of the library are made in that
 * thread; wishes reach it as atomic values, and reports leave it under a lock. */

#ifndef TMINI_ROS_LIDAR_H
#define TMINI_ROS_LIDAR_H

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "report.h"
#include "settings.h"

namespace tmini_ros
{

/* Called from the lidar's thread. */
class Listener
{
  public:
    virtual ~Listener() = default;
    /* A scan to be published, that ended `age_ms` ago. */
    virtual void take(const tmini_scan_t &scan, std::uint32_t age_ms) = 0;
    virtual void tell(Level level, const std::string &text) = 0;
    virtual bool has_subscribers() = 0;
};

class Lidar
{
  public:
    /* Opens the port and starts the lidar, and keeps trying. */
    Lidar(const Settings &settings, Listener &listener);
    /* Stops the lidar. */
    ~Lidar();
    Lidar(const Lidar &) = delete;
    Lidar &operator=(const Lidar &) = delete;

    void want_scans(bool are_wanted);
    void want_frequency(std::uint16_t frequency_chz);
    Report report();

  private:
    void set_up();
    void run();
    void apply_wishes();
    void tell_of_port();
    void handle(tmini_event_t event);
    void take_scan(const tmini_scan_t &scan);
    void renew_report();

    const Settings settings_;
    Listener &listener_;

    std::atomic<bool> are_scans_wanted_{true};
    std::atomic<std::uint16_t> wanted_chz_;
    std::atomic<bool> is_ended_{false};
    std::mutex mutex_; /* Of the report. */
    Report report_;

    /* Used by the thread alone. */
    bool is_started_ = false;
    std::uint16_t frequency_chz_;
    int told_ = 1; /* The port's state that was told last; at first none of them. */
    tmini_posix_t port_ = {};
    tmini_t lidar_ = {};
    tmini_timing_t timing_ = tmini_timing_default;
    std::uint8_t rx_[4096];
    tmini_point_t points_[TMINI_SCAN_POINTS_TYPICAL];

    std::thread thread_; /* The last one: it uses the others. */
};

} // namespace tmini_ros

#endif

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "lidar.h"

#include <cstdlib>

#include "tmini/tmini_blocking.h"
#include "tmini/tmini_names.h"

namespace tmini_ros
{

Lidar::Lidar(const Settings &settings, Listener &listener)
    : settings_(settings), listener_(listener), wanted_chz_(settings.frequency_chz),
      frequency_chz_(settings.frequency_chz)
{
    set_up();
    thread_ = std::thread([this] { run(); });
}

Lidar::~Lidar()
{
    is_ended_ = true;
    thread_.join();
}

void Lidar::want_scans(bool are_wanted)
{
    are_scans_wanted_ = are_wanted;
}

void Lidar::want_frequency(std::uint16_t frequency_chz)
{
    wanted_chz_ = frequency_chz;
}

Report Lidar::report()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return report_;
}

void Lidar::set_up()
{
    /* On a computer bytes may come late, and in bursts; from a network even more so. */
    timing_.frame_timeout_ms = settings_.port.rfind("tcp:", 0) == 0 ? 1000 : 250;
    timing_.max_pause_ms = timing_.frame_timeout_ms;
    tmini_config_t config = {};
    config.port = &tmini_posix_port;
    config.port_context = &port_;
    config.rx_buffer = rx_;
    config.rx_size = sizeof rx_;
    config.points = points_;
    config.max_points = TMINI_SCAN_POINTS_TYPICAL;
    config.frequency_chz = frequency_chz_;
    config.timing = &timing_;
    tmini_posix_init(&port_, settings_.port.c_str());
    if (tmini_init(&lidar_, &config) != TMINI_OK) {
        std::abort(); /* Never: the settings have been checked. */
    }
}

void Lidar::run()
{
    (void)tmini_posix_start(&port_, &lidar_);
    tmini_posix_reconnect(&port_, true);
    (void)tmini_request_info(&lidar_);
    while (!is_ended_) {
        tell_of_port();
        apply_wishes();
        (void)tmini_posix_wait(&port_, 10);
        for (tmini_event_t event; (event = tmini_poll(&lidar_)) != TMINI_EVENT_NONE;) {
            handle(event);
        }
        renew_report();
    }
    (void)tmini_blocking_stop(&lidar_, 1000);
    tmini_posix_stop(&port_);
}

void Lidar::apply_wishes()
{
    const bool is_wanted = are_scans_wanted_ && (!settings_.standby || listener_.has_subscribers());
    if (is_wanted != is_started_) {
        is_started_ = is_wanted;
        (void)(is_wanted ? tmini_start(&lidar_) : tmini_stop(&lidar_));
    }
    if (wanted_chz_ != frequency_chz_) {
        frequency_chz_ = wanted_chz_;
        (void)tmini_set_frequency(&lidar_, frequency_chz_);
    }
}

void Lidar::tell_of_port()
{
    if (port_.state == told_) {
        return;
    }
    told_ = port_.state;
    const std::string text = settings_.port + ": " + tmini_posix_status_name(port_.state);
    if (told_ == TMINI_POSIX_OK) {
        listener_.tell(LEVEL_OK, text);
    } else {
        listener_.tell(LEVEL_ERROR, text + "; trying again until it can be opened");
    }
}

void Lidar::handle(tmini_event_t event)
{
    char faults[TMINI_FAULTS_TEXT_SIZE];
    switch (event) {
    case TMINI_EVENT_SCAN:
        take_scan(*tmini_scan(&lidar_));
        break;
    case TMINI_EVENT_COMMAND_FAILED:
        listener_.tell(LEVEL_WARN, std::string("the lidar does not obey: ") +
                                       tmini_status_name(tmini_command_error(&lidar_)));
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        (void)tmini_faults_text(tmini_faults(&lidar_), faults, sizeof faults);
        listener_.tell(LEVEL_WARN, std::string("the lidar's faults: ") + faults);
        break;
    case TMINI_EVENT_PAUSED:
    case TMINI_EVENT_LOST:
    case TMINI_EVENT_UNWANTED_SCANNING:
        listener_.tell(LEVEL_WARN, std::string("the lidar: ") + tmini_event_name(event));
        break;
    case TMINI_EVENT_STARTED:
    case TMINI_EVENT_STOPPED:
    case TMINI_EVENT_RECOVERED:
        listener_.tell(LEVEL_OK, std::string("the lidar: ") + tmini_event_name(event));
        break;
    default:
        break;
    }
}

void Lidar::take_scan(const tmini_scan_t &scan)
{
    const bool is_published = scan.complete || settings_.publish_incomplete;
    if (is_published) {
        listener_.take(scan, tmini_posix_port.now_ms(&port_) - scan.end_ms);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    report_.measured_chz = scan.frequency_chz;
    report_.complete += scan.complete ? 1 : 0;
    report_.incomplete += scan.complete ? 0 : 1;
    report_.published += is_published ? 1 : 0;
}

void Lidar::renew_report()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    report_.is_wanted = is_started_;
    report_.state = tmini_state(&lidar_);
    report_.port = port_.state;
    report_.reconnections = port_.reconnections;
    report_.age_ms = tmini_scan_age_ms(&lidar_);
    report_.faults = tmini_faults(&lidar_);
    report_.wanted_chz = frequency_chz_;
    report_.info = *tmini_info(&lidar_);
    tmini_ct_info(&lidar_, &report_.ct);
    tmini_counters(&lidar_, &report_.counters);
}

} // namespace tmini_ros

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The node's parameters, without ROS. They have the vendor's names where they mean the same. */

#ifndef TMINI_ROS_SETTINGS_H
#define TMINI_ROS_SETTINGS_H

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "tmini_laser.h"

namespace tmini_ros
{

/* A parameter's value; monostate stands for those of ROS's other types. */
using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

struct Settings {
    std::string port;
    std::string frame_id;
    std::uint16_t frequency_chz;
    tmini_laser_config_t laser;
    bool point_cloud;
    bool publish_incomplete;
    bool standby;
};

struct Parameter {
    const char *name;
    const char *description;
    std::variant<bool, std::int64_t, double, std::string> initial;
    std::string (*put)(Settings &settings, const Value &value); /* See put() below. */
};

const std::vector<Parameter> &parameters();

/* Puts a parameter's value into the settings. Returns why it is refused, or nothing. */
std::string put(Settings &settings, const std::string &name, const Value &value);

/* The initial value of each parameter. */
Settings initial_settings();

/* What two parameters that are right by themselves contradict, or nothing. */
std::string contradiction(const Settings &settings);

/* What to tell the user about a parameter that the node does not have: that it is unknown, or that
 * this value of one of the vendor's has no effect. Nothing if a T-mini needs just this value. */
std::string remark(const std::string &name, const Value &value);

} // namespace tmini_ros

#endif

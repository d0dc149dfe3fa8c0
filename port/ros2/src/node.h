/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#ifndef TMINI_ROS_NODE_H
#define TMINI_ROS_NODE_H

#include <memory>

#include <rclcpp/rclcpp.hpp>

namespace tmini_ros
{

/* The node; throws an exception that names a parameter whose value is wrong. */
__attribute__((visibility("default"))) std::shared_ptr<rclcpp::Node> make_node(
    const rclcpp::NodeOptions &options);

} // namespace tmini_ros

#endif

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The node as a program. SIGINT and SIGTERM end it, and its end stops the lidar. */

#include <exception>

#include <rclcpp/rclcpp.hpp>

namespace tmini_ros
{
std::shared_ptr<rclcpp::Node> make_node(const rclcpp::NodeOptions &options); /* node.cpp */
}

int main(int argc, char **argv)
{
    try {
        rclcpp::init(argc, argv);
        rclcpp::spin(tmini_ros::make_node(rclcpp::NodeOptions()));
        rclcpp::shutdown();
    } catch (const std::exception &error) {
        RCLCPP_FATAL(rclcpp::get_logger("tmini"), "%s", error.what());
        return 1;
    }
    return 0;
}

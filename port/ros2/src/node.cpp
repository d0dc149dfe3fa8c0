/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The node: what ROS hears of the lidar, and what the lidar hears of ROS. */

#include <chrono>
#include <cstring>
#include <stdexcept>

#include <diagnostic_updater/diagnostic_updater.hpp>
#include <rcl_yaml_param_parser/parser.h>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <sensor_msgs/point_cloud2_iterator.hpp>
#include <std_srvs/srv/empty.hpp>

#include "lidar.h"
#include "tmini_cloud.h"

namespace tmini_ros
{

using sensor_msgs::msg::LaserScan;
using sensor_msgs::msg::PointCloud2;
using sensor_msgs::msg::PointField;
using std_srvs::srv::Empty;

static Value value_of(const rclcpp::ParameterValue &value)
{
    switch (value.get_type()) {
    case rclcpp::PARAMETER_BOOL:
        return value.get<bool>();
    case rclcpp::PARAMETER_INTEGER:
        return value.get<std::int64_t>();
    case rclcpp::PARAMETER_DOUBLE:
        return value.get<double>();
    case rclcpp::PARAMETER_STRING:
        return value.get<std::string>();
    default:
        return {};
    }
}

class Node : public rclcpp::Node, private Listener
{
  public:
    explicit Node(const rclcpp::NodeOptions &options) : rclcpp::Node("tmini", options)
    {
        read_parameters();
        tmini_laser_init(&laser_, &settings_.laser);
        scans_ = create_publisher<LaserScan>("scan", rclcpp::SensorDataQoS());
        if (settings_.point_cloud) {
            clouds_ = create_publisher<PointCloud2>("point_cloud", rclcpp::SensorDataQoS());
        }
        lidar_ = std::make_unique<Lidar>(settings_, static_cast<Listener &>(*this));
        start_ = create_wish("start_scan", true);
        stop_ = create_wish("stop_scan", false);
        updater_ = std::make_unique<diagnostic_updater::Updater>(this);
        updater_->setHardwareID("tmini");
        updater_->add("lidar", [this](auto &status) { diagnose(status); });
        on_set_ = add_on_set_parameters_callback(
            [this](const std::vector<rclcpp::Parameter> &changes) { return change(changes); });
        warn_of_other_parameters();
        warn_of_files_for_others();
    }

    ~Node() override
    {
        lidar_.reset(); /* First: it calls what follows. */
    }

  private:
    /* ---------------------------------------------------------------------------- parameters */

    void read_parameters()
    {
        for (const Parameter &parameter : parameters()) {
            rcl_interfaces::msg::ParameterDescriptor descriptor;
            descriptor.description = parameter.description;
            descriptor.dynamic_typing = true; /* An integer is a number, too. */
            descriptor.read_only = std::strcmp(parameter.name, "frequency") != 0;
            const auto initial = std::visit(
                [](const auto &held) { return rclcpp::ParameterValue(held); }, parameter.initial);
            const auto value = declare_parameter(parameter.name, initial, descriptor);
            refuse_if(put(settings_, parameter.name, value_of(value)), parameter.name);
        }
        refuse_if(contradiction(settings_), "parameters:");
    }

    static void refuse_if(const std::string &reason, const char *what)
    {
        if (!reason.empty()) {
            throw std::invalid_argument(std::string(what) + " " + reason);
        }
    }

    /* All but the frequency are read-only, and refused before this is called. */
    rcl_interfaces::msg::SetParametersResult change(const std::vector<rclcpp::Parameter> &changes)
    {
        rcl_interfaces::msg::SetParametersResult result;
        Settings changed = {};
        for (const rclcpp::Parameter &one : changes) {
            if (one.get_name() == "frequency") {
                result.reason = put(changed, one.get_name(), value_of(one.get_parameter_value()));
            }
        }
        result.successful = result.reason.empty();
        if (result.successful && changed.frequency_chz != 0) {
            lidar_->want_frequency(changed.frequency_chz);
        }
        return result;
    }

    /* Those of ROS and of the diagnostics are declared by now. */
    void warn_of_other_parameters()
    {
        const auto &given = get_node_parameters_interface()->get_parameter_overrides();
        for (const auto &[name, value] : given) {
            const std::string text = has_parameter(name) ? "" : remark(name, value_of(value));
            if (!text.empty()) {
                RCLCPP_WARN(get_logger(), "parameter %s", text.c_str());
            }
        }
    }

    /* Of a file that begins with another node's name ROS reads nothing, and does not tell. */
    void warn_of_files_for_others()
    {
        const auto context = get_node_base_interface()->get_context()->get_rcl_context();
        const rcl_arguments_t &arguments = context->global_arguments;
        const rcl_allocator_t allocator = rcl_get_default_allocator();
        const int count = rcl_arguments_get_param_files_count(&arguments);
        char **files = nullptr;
        if (count <= 0 ||
            rcl_arguments_get_param_files(&arguments, allocator, &files) != RCL_RET_OK) {
            return;
        }
        for (int i = 0; i < count; i++) {
            const char *const name = get_fully_qualified_name();
            rcl_params_t *const params = rcl_yaml_node_struct_init(allocator);
            if (rcl_parse_yaml_file(files[i], params) &&
                rclcpp::parameter_map_from(params, name).empty()) {
                RCLCPP_WARN(get_logger(),
                            "%s has nothing for this node: let it begin with %s: or /**:", files[i],
                            name);
            }
            rcl_yaml_node_struct_fini(params);
            allocator.deallocate(files[i], allocator.state);
        }
        allocator.deallocate(files, allocator.state);
    }

    rclcpp::Service<Empty>::SharedPtr create_wish(const char *name, bool are_scans_wanted)
    {
        return create_service<Empty>(
            name, [this, are_scans_wanted](Empty::Request::SharedPtr, Empty::Response::SharedPtr) {
                lidar_->want_scans(are_scans_wanted);
            });
    }

    /* --------------------------------------------------------------------------- diagnostics */

    void diagnose(diagnostic_updater::DiagnosticStatusWrapper &status)
    {
        const Report report = lidar_->report();
        const auto now = std::chrono::steady_clock::now();
        const std::chrono::duration<double> passed = now - reported_;
        const Verdict verdict = judge(report_, report, passed.count());
        status.summary(verdict.level, verdict.text);
        for (const auto &[name, value] : verdict.values) {
            status.add(name, value);
        }
        updater_->setHardwareID("tmini " + serial_number(report));
        report_ = report;
        reported_ = now;
    }

    void tell(Level level, const std::string &text) override
    {
        if (level == LEVEL_OK) {
            RCLCPP_INFO(get_logger(), "%s", text.c_str());
        } else if (level == LEVEL_WARN) {
            RCLCPP_WARN(get_logger(), "%s", text.c_str());
        } else {
            RCLCPP_ERROR(get_logger(), "%s", text.c_str());
        }
    }

    /* ------------------------------------------------------------------------------ messages */

    bool has_subscribers() override
    {
        return scans_->get_subscription_count() > 0 ||
               (clouds_ != nullptr && clouds_->get_subscription_count() > 0);
    }

    void take(const tmini_scan_t &scan, std::uint32_t age_ms) override
    {
        const rclcpp::Time end = now() - rclcpp::Duration(std::chrono::milliseconds(age_ms));
        publish_scan(scan, end);
        if (clouds_ != nullptr) {
            publish_cloud(scan, end);
        }
    }

    void publish_scan(const tmini_scan_t &scan, const rclcpp::Time &end)
    {
        auto message = std::make_unique<LaserScan>();
        tmini_laser_fields_t fields;
        message->ranges.resize(settings_.laser.rays);
        message->intensities.resize(settings_.laser.rays);
        (void)tmini_laser_of_scan(&laser_, &scan, message->ranges.data(),
                                  message->intensities.data(), &fields);
        message->header.frame_id = settings_.frame_id;
        message->header.stamp = end + rclcpp::Duration(std::chrono::microseconds(fields.stamp_us));
        message->angle_min = fields.angle_min;
        message->angle_max = fields.angle_max;
        message->angle_increment = fields.angle_increment;
        message->time_increment = fields.time_increment;
        message->scan_time = fields.scan_time;
        message->range_min = fields.range_min;
        message->range_max = fields.range_max;
        scans_->publish(std::move(message));
    }

    void publish_cloud(const tmini_scan_t &scan, const rclcpp::Time &end)
    {
        const std::chrono::milliseconds taken(scan.end_ms - scan.start_ms);
        const int kind = PointField::FLOAT32;
        auto message = std::make_unique<PointCloud2>();
        sensor_msgs::PointCloud2Modifier modifier(*message);
        modifier.setPointCloud2Fields(5, "x", 1, kind, "y", 1, kind, "z", 1, kind, "intensity", 1,
                                      kind, "time", 1, kind);
        modifier.resize(tmini_cloud_of_scan(&settings_.laser, &scan, cloud_));
        std::memcpy(message->data.data(), cloud_, message->data.size());
        message->header.frame_id = settings_.frame_id;
        message->header.stamp = end - rclcpp::Duration(taken);
        message->is_bigendian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
        message->is_dense = true;
        clouds_->publish(std::move(message));
    }

    Settings settings_ = initial_settings();
    tmini_laser_t laser_;
    tmini_cloud_point_t cloud_[TMINI_SCAN_POINTS_TYPICAL];
    rclcpp::Publisher<LaserScan>::SharedPtr scans_;
    rclcpp::Publisher<PointCloud2>::SharedPtr clouds_;
    std::unique_ptr<Lidar> lidar_;
    rclcpp::Service<Empty>::SharedPtr start_;
    rclcpp::Service<Empty>::SharedPtr stop_;
    OnSetParametersCallbackHandle::SharedPtr on_set_;
    std::unique_ptr<diagnostic_updater::Updater> updater_;
    Report report_; /* The last one that was diagnosed. */
    std::chrono::steady_clock::time_point reported_ = std::chrono::steady_clock::now();
};

/* Throws an exception that names a parameter whose value is wrong. */
__attribute__((visibility("default"))) std::shared_ptr<rclcpp::Node> make_node(
    const rclcpp::NodeOptions &options)
{
    return std::make_shared<Node>(options);
}

} // namespace tmini_ros

RCLCPP_COMPONENTS_REGISTER_NODE(tmini_ros::Node)

/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "settings.h"

#include <cmath>
#include <locale>
#include <sstream>

namespace tmini_ros
{

namespace
{

const char OK[] = "";

/* ------------------------------------------------------------------------------------- values */

/* NAN if it is no number. In YAML `frequency: 10` is an integer. */
double number(const Value &value)
{
    if (const auto *integer = std::get_if<std::int64_t>(&value)) {
        return static_cast<double>(*integer);
    }
    const auto *real = std::get_if<double>(&value);
    return real != nullptr ? *real : NAN;
}

std::string put_bool(bool &to, const Value &value, bool is_opposite = false)
{
    const auto *given = std::get_if<bool>(&value);
    if (given == nullptr) {
        return "must be true or false";
    }
    to = *given != is_opposite;
    return OK;
}

std::string put_text(std::string &to, const Value &value)
{
    const auto *given = std::get_if<std::string>(&value);
    if (given == nullptr || given->empty()) {
        return "must be a text";
    }
    to = *given;
    return OK;
}

std::string put_degrees(float &to, const Value &value)
{
    const double given = number(value);
    if (!(given >= -180.0 && given <= 180.0)) {
        return "must be degrees, from -180 to 180";
    }
    to = static_cast<float>(given);
    return OK;
}

std::string put_metres(std::uint16_t &to_mm, const Value &value)
{
    const double given = number(value);
    if (!(given >= 0.0 && given <= 65.0)) {
        return "must be metres, from 0 to 65";
    }
    to_mm = static_cast<std::uint16_t>(std::lround(given * 1000.0));
    return OK;
}

std::string put_frequency(std::uint16_t &to_chz, const Value &value)
{
    const double given = number(value);
    if (!(given >= 6.0 && given <= 12.0)) {
        return "must be hertz, from 6 to 12";
    }
    to_chz = static_cast<std::uint16_t>(std::lround(given * 10.0) * 10);
    return OK;
}

std::string put_rays(std::uint16_t &to, const Value &value)
{
    const auto *given = std::get_if<std::int64_t>(&value);
    if (given == nullptr || *given < 36 || *given > 1440 || *given % 2 != 0) {
        return "must be an even number from 36 to 1440";
    }
    to = static_cast<std::uint16_t>(*given);
    return OK;
}

/* False if it is no list of numbers between commas. */
bool read_numbers(const std::string &text, std::vector<float> &numbers)
{
    std::istringstream in(text);
    in.imbue(std::locale::classic());
    char comma = ',';
    for (float read = 0.0f; comma == ',' && in >> read;) {
        numbers.push_back(read);
        in >> comma;
    }
    return in.eof();
}

std::string put_arcs(tmini_laser_config_t &laser, const Value &value)
{
    static const char WRONG[] = "must be at most 16 pairs of degrees from -180 to 180, the lower "
                                "one first: \"-90,-80,30,40\"";
    const auto *given = std::get_if<std::string>(&value);
    std::vector<float> degrees;
    if (given == nullptr || !read_numbers(*given, degrees) || degrees.size() % 2 != 0 ||
        degrees.size() > 2 * TMINI_LASER_MASKS_MAX) {
        return WRONG;
    }
    for (std::size_t i = 0; i < degrees.size(); i += 2) {
        if (degrees[i] < -180.0f || degrees[i] > degrees[i + 1] || degrees[i + 1] > 180.0f) {
            return WRONG;
        }
        laser.masked[i / 2] = {degrees[i], degrees[i + 1]};
    }
    laser.masked_count = degrees.size() / 2;
    return OK;
}

/* ------------------------------------------------------------ the vendor's, not needed here */

struct Needless {
    const char *name;
    Value fitting; /* monostate: any value. */
    const char *reason;
};

const std::vector<Needless> &needless()
{
    static const std::vector<Needless> all = {
        {"baudrate", std::int64_t{230400}, "a T-mini has 230400"},
        {"lidar_type", std::int64_t{1}, "the T-mini Plus is of type 1; others are not supported"},
        {"device_type", std::int64_t{0}, "for a network let port be tcp:HOST:PORT"},
        {"auto_reconnect", true, "the node always reconnects"},
        {"isSingleChannel", false, "a T-mini needs its RX wire"},
        {"sample_rate", {}, ""},
        {"intensity", {}, ""},
        {"intensity_bit", {}, ""},
        {"abnormal_check_count", {}, ""},
        {"fixed_resolution", {}, ""},
        {"support_motor_dtr", {}, ""},
        {"debug", {}, ""},
        {"m1_mode", {}, ""},
        {"m2_mode", {}, ""},
        {"m3_mode", {}, ""},
    };
    return all;
}

} // namespace

std::string remark(const std::string &name, const Value &value)
{
    for (const Needless &one : needless()) {
        if (name == one.name) {
            const bool fits =
                std::holds_alternative<std::monostate>(one.fitting) || one.fitting == value;
            return fits ? OK : name + " has no effect: " + one.reason;
        }
    }
    return name + " is unknown";
}

/* ----------------------------------------------------------------------------- the parameters */

const std::vector<Parameter> &parameters()
{
    static const std::vector<Parameter> all = {
        {"port", "serial device of the lidar, or tcp:HOST:PORT", std::string("/dev/ttyUSB0"),
         [](Settings &s, const Value &v) { return put_text(s.port, v); }},
        {"frame_id", "frame of the messages", std::string("laser_frame"),
         [](Settings &s, const Value &v) { return put_text(s.frame_id, v); }},
        {"frequency", "turns per second, 6 to 12; may be set at any time", 10.0,
         [](Settings &s, const Value &v) { return put_frequency(s.frequency_chz, v); }},
        {"rays", "rays of a LaserScan", std::int64_t{360},
         [](Settings &s, const Value &v) { return put_rays(s.laser.rays, v); }},
        {"reversion", "0 degrees is the lidar's back", false,
         [](Settings &s, const Value &v) { return put_bool(s.laser.is_turned, v); }},
        {"inverted", "angles count counter-clockwise; false for a lidar that hangs", true,
         [](Settings &s, const Value &v) { return put_bool(s.laser.is_mirrored, v, true); }},
        {"angle_min", "degrees; rays below are NaN", -180.0,
         [](Settings &s, const Value &v) { return put_degrees(s.laser.seen.from_deg, v); }},
        {"angle_max", "degrees; rays above are NaN", 180.0,
         [](Settings &s, const Value &v) { return put_degrees(s.laser.seen.to_deg, v); }},
        {"ignore_array", "pairs of degrees; rays between them are NaN", std::string(),
         [](Settings &s, const Value &v) { return put_arcs(s.laser, v); }},
        {"range_min", "metres; nearer ranges are NaN", 0.05,
         [](Settings &s, const Value &v) { return put_metres(s.laser.min_mm, v); }},
        {"range_max", "metres; farther ones are as if nothing was seen", 12.0,
         [](Settings &s, const Value &v) { return put_metres(s.laser.max_mm, v); }},
        {"invalid_range_is_inf", "a ray that saw nothing is inf, which means free", false,
         [](Settings &s, const Value &v) { return put_bool(s.laser.missing_inf, v); }},
        {"point_cloud", "publish a PointCloud2 as well", false,
         [](Settings &s, const Value &v) { return put_bool(s.point_cloud, v); }},
        {"publish_incomplete", "publish scans of which a part is missing", false,
         [](Settings &s, const Value &v) { return put_bool(s.publish_incomplete, v); }},
        {"standby", "stop the lidar while nobody subscribes", false,
         [](Settings &s, const Value &v) { return put_bool(s.standby, v); }},
    };
    return all;
}

std::string put(Settings &settings, const std::string &name, const Value &value)
{
    for (const Parameter &parameter : parameters()) {
        if (name == parameter.name) {
            return parameter.put(settings, value);
        }
    }
    return "is unknown";
}

Settings initial_settings()
{
    Settings settings = {};
    settings.laser = tmini_laser_default;
    for (const Parameter &parameter : parameters()) {
        const auto value = [](const auto &held) { return Value(held); };
        parameter.put(settings, std::visit(value, parameter.initial));
    }
    return settings;
}

std::string contradiction(const Settings &settings)
{
    if (settings.laser.seen.from_deg >= settings.laser.seen.to_deg) {
        return "angle_min must be below angle_max";
    }
    if (settings.laser.min_mm >= settings.laser.max_mm) {
        return "range_min must be below range_max";
    }
    return OK;
}

} // namespace tmini_ros

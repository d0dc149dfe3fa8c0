/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the reading of parameters, and what the diagnostics say, without ROS. */

#include <cmath>
#include <vector>

#include "report.h"
#include "settings.h"

#include "cpp_tests.h"

using namespace tmini_ros;
using Text = std::string;

static Settings settings;

void setUp()
{
    settings = initial_settings();
}

void tearDown() {}

/* -------------------------------------------------------------------------------- parameters */

TEST(initially_the_lidar_is_as_the_data_sheet_has_it)
{
    TEST_ASSERT_EQUAL_STRING("/dev/ttyUSB0", settings.port.c_str());
    TEST_ASSERT_EQUAL_STRING("laser_frame", settings.frame_id.c_str());
    TEST_ASSERT_EQUAL_UINT16(1000, settings.frequency_chz);
    TEST_ASSERT_EQUAL_UINT16(360, settings.laser.rays);
    TEST_ASSERT_EQUAL_UINT16(50, settings.laser.min_mm);
    TEST_ASSERT_EQUAL_UINT16(12000, settings.laser.max_mm);
    TEST_ASSERT_EQUAL_FLOAT(-180.0f, settings.laser.seen.from_deg);
    TEST_ASSERT_EQUAL_FLOAT(180.0f, settings.laser.seen.to_deg);
    TEST_ASSERT_EQUAL_size_t(0, settings.laser.masked_count);
    TEST_ASSERT_FALSE(settings.laser.is_turned || settings.laser.is_mirrored ||
                      settings.laser.missing_inf || settings.point_cloud ||
                      settings.publish_incomplete || settings.standby);
    TEST_ASSERT_EQUAL_STRING("", contradiction(settings).c_str());
}

/* Each parameter's own value, and where it goes. */
static const struct {
    const char *name;
    Value value;
    bool (*has_arrived)(const Settings &s);
} taken[] = {
    {"port", Text("tcp:robot:5000"), [](const Settings &s) { return s.port == "tcp:robot:5000"; }},
    {"frame_id", Text("scanner"), [](const Settings &s) { return s.frame_id == "scanner"; }},
    {"frequency", 8.0, [](const Settings &s) { return s.frequency_chz == 800; }},
    {"frequency", std::int64_t{7}, [](const Settings &s) { return s.frequency_chz == 700; }},
    {"frequency", 6.0, [](const Settings &s) { return s.frequency_chz == 600; }},
    {"frequency", 12.0, [](const Settings &s) { return s.frequency_chz == 1200; }},
    {"frequency", 8.26, [](const Settings &s) { return s.frequency_chz == 830; }},
    {"rays", std::int64_t{36}, [](const Settings &s) { return s.laser.rays == 36; }},
    {"rays", std::int64_t{1440}, [](const Settings &s) { return s.laser.rays == 1440; }},
    {"reversion", true, [](const Settings &s) { return s.laser.is_turned; }},
    {"inverted", false, [](const Settings &s) { return s.laser.is_mirrored; }},
    {"inverted", true, [](const Settings &s) { return !s.laser.is_mirrored; }},
    {"angle_min", -90.5, [](const Settings &s) { return s.laser.seen.from_deg == -90.5f; }},
    {"angle_max", std::int64_t{45}, [](const Settings &s) { return s.laser.seen.to_deg == 45; }},
    {"angle_min", -180.0, [](const Settings &s) { return s.laser.seen.from_deg == -180.0f; }},
    {"angle_max", 180.0, [](const Settings &s) { return s.laser.seen.to_deg == 180.0f; }},
    {"range_min", 0.03, [](const Settings &s) { return s.laser.min_mm == 30; }},
    {"range_min", std::int64_t{0}, [](const Settings &s) { return s.laser.min_mm == 0; }},
    {"range_max", 65.0, [](const Settings &s) { return s.laser.max_mm == 65000; }},
    {"invalid_range_is_inf", true, [](const Settings &s) { return s.laser.missing_inf; }},
    {"point_cloud", true, [](const Settings &s) { return s.point_cloud; }},
    {"publish_incomplete", true, [](const Settings &s) { return s.publish_incomplete; }},
    {"standby", true, [](const Settings &s) { return s.standby; }},
};

TEST(each_value_arrives_and_a_number_may_be_an_integer)
{
    for (const auto &one : taken) {
        TEST_ASSERT_FALSE_MESSAGE(one.has_arrived(settings), one.name);
        TEST_ASSERT_EQUAL_STRING_MESSAGE("", put(settings, one.name, one.value).c_str(), one.name);
        TEST_ASSERT_TRUE_MESSAGE(one.has_arrived(settings), one.name);
    }
}

static const struct {
    const char *name;
    std::vector<Value> values;
} refused[] = {
    {"port", {std::int64_t{5}, Text()}},
    {"frame_id", {true}},
    {"frequency", {5.9, 12.1, NAN, Text("10"), true, Value(), std::int64_t{1} << 40}},
    {"rays", {std::int64_t{34}, std::int64_t{361}, std::int64_t{1442}, 360.0}},
    {"reversion", {std::int64_t{1}}},
    {"inverted", {Text("true")}},
    {"angle_min", {-181.0}},
    {"angle_max", {181.0}},
    {"range_min", {-0.1}},
    {"range_max", {66.0}},
    {"ignore_array", {5.0, Text("10"), Text("10,20,30"), Text("20,10"), Text("-181,0")}},
    {"ignore_array", {Text("0,181"), Text("10;20"), Text("10,x"), Text("10,20 30,40")}},
    {"no_such_parameter", {1.0}},
};

TEST(what_cannot_be_is_refused_with_a_reason_and_changes_nothing)
{
    for (const auto &one : refused) {
        for (const Value &value : one.values) {
            TEST_ASSERT_TRUE_MESSAGE(put(settings, one.name, value) != "", one.name);
        }
    }
    initially_the_lidar_is_as_the_data_sheet_has_it();
}

TEST(ignored_directions_are_pairs_between_commas)
{
    static const float expected[][2] = {{-180.0f, -150.5f}, {150.0f, 180.0f}, {7.0f, 7.0f}};
    const Text pairs = " -180,-150.5, 150 ,180,7,7";
    TEST_ASSERT_EQUAL_STRING("", put(settings, "ignore_array", pairs).c_str());
    TEST_ASSERT_EQUAL_size_t(3, settings.laser.masked_count);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_FLOAT(expected[i][0], settings.laser.masked[i].from_deg);
        TEST_ASSERT_EQUAL_FLOAT(expected[i][1], settings.laser.masked[i].to_deg);
    }
    TEST_ASSERT_EQUAL_STRING("", put(settings, "ignore_array", Text("")).c_str());
    TEST_ASSERT_EQUAL_size_t(0, settings.laser.masked_count);
}

TEST(sixteen_pairs_fit_and_no_more)
{
    Text pairs = "0,1";
    for (int i = 1; i < 16; i++) {
        pairs += ",0,1";
    }
    TEST_ASSERT_EQUAL_STRING("", put(settings, "ignore_array", pairs).c_str());
    TEST_ASSERT_EQUAL_size_t(16, settings.laser.masked_count);
    TEST_ASSERT_TRUE(put(settings, "ignore_array", pairs + ",0,1") != "");
}

TEST(limits_that_leave_nothing_are_noticed)
{
    Settings other = settings;
    other.laser.seen.to_deg = other.laser.seen.from_deg;
    TEST_ASSERT_TRUE(contradiction(other) != "");
    other = settings;
    other.laser.min_mm = other.laser.max_mm;
    TEST_ASSERT_TRUE(contradiction(other) != "");
}

/* What the vendor's file for this lidar says, as it is delivered, beside the parameters above. */
static const struct {
    const char *name;
    Value value;
} of_the_vendor[] = {
    {"baudrate", std::int64_t{230400}}, {"lidar_type", std::int64_t{1}},
    {"device_type", std::int64_t{0}},   {"sample_rate", std::int64_t{4}},
    {"intensity_bit", std::int64_t{8}}, {"abnormal_check_count", std::int64_t{4}},
    {"fixed_resolution", true},         {"auto_reconnect", true},
    {"isSingleChannel", false},         {"intensity", true},
    {"support_motor_dtr", false},
};

TEST(the_vendors_parameters_for_this_lidar_need_no_remark)
{
    for (const auto &one : of_the_vendor) {
        TEST_ASSERT_EQUAL_STRING("", remark(one.name, one.value).c_str());
    }
}

TEST(values_for_other_lidars_and_unknown_names_get_a_remark)
{
    TEST_ASSERT_EQUAL_STRING("baudrate has no effect: a T-mini has 230400",
                             remark("baudrate", std::int64_t{115200}).c_str());
    TEST_ASSERT_EQUAL_STRING("turns is unknown", remark("turns", 10.0).c_str());
    TEST_ASSERT_TRUE(remark("device_type", std::int64_t{1}) != "");
    TEST_ASSERT_TRUE(remark("lidar_type", std::int64_t{0}) != "");
    TEST_ASSERT_TRUE(remark("auto_reconnect", false) != "");
    TEST_ASSERT_TRUE(remark("isSingleChannel", true) != "");
}

/* ------------------------------------------------------------------------------- diagnostics */

static Report healthy(std::uint32_t scans)
{
    Report report;
    report.is_wanted = true;
    report.state = TMINI_STATE_SCANNING;
    report.port = TMINI_POSIX_OK;
    report.wanted_chz = report.measured_chz = 1000;
    report.complete = report.published = scans;
    return report;
}

/* A second passes; then this is wrong. */
static const struct {
    Level level;
    const char *text;
    void (*change)(Report &now);
} judged[] = {
    {LEVEL_OK, "scans at 10.0 Hz", [](Report &) {}},
    {LEVEL_OK, "scans at 10.0 Hz", [](Report &now) { now.complete = 109; }},
    {LEVEL_WARN, "only 8.0 complete scans a second", [](Report &now) { now.complete = 108; }},
    {LEVEL_WARN, "1 of 10 scans are incomplete",
     [](Report &now) { now.complete = 109, now.incomplete = 1; }},
    {LEVEL_WARN, "turns at 7.5 Hz instead of 10.0 Hz",
     [](Report &now) { now.faults = TMINI_FAULT_FREQUENCY, now.measured_chz = 750; }},
    {LEVEL_ERROR, "no complete scan", [](Report &now) { now.complete = 100, now.incomplete = 9; }},
    {LEVEL_ERROR, "faults: data, frequency",
     [](Report &now) { now.faults = TMINI_FAULT_DATA | TMINI_FAULT_FREQUENCY; }},
    {LEVEL_ERROR, "does not scan: recovering",
     [](Report &now) { now.state = TMINI_STATE_RECOVERING; }},
    {LEVEL_ERROR, "port: unplugged",
     [](Report &now) { now.state = TMINI_STATE_RECOVERING, now.port = TMINI_POSIX_UNPLUGGED; }},
    {LEVEL_OK, "stopped, as wished",
     [](Report &now) { now.is_wanted = false, now.state = TMINI_STATE_IDLE; }},
};

TEST(each_trouble_has_its_level_and_words)
{
    for (const auto &one : judged) {
        Report now = healthy(110);
        one.change(now);
        const Verdict verdict = judge(healthy(100), now, 1.0);
        TEST_ASSERT_EQUAL_STRING(one.text, verdict.text.c_str());
        TEST_ASSERT_EQUAL_MESSAGE(one.level, verdict.level, one.text);
    }
}

TEST(a_lidar_that_has_just_begun_is_not_blamed)
{
    Report before = healthy(100);
    before.state = TMINI_STATE_STARTING;
    TEST_ASSERT_EQUAL(LEVEL_OK, judge(before, healthy(100), 1.0).level);
}

static Text value_of(const Report &report, const char *name)
{
    for (const auto &one : judge(healthy(10), report, 2.0).values) {
        if (one.first == name) {
            return one.second;
        }
    }
    return "missing";
}

static const struct {
    const char *name;
    const char *text;
} values[] = {
    {"state", "scanning"},
    {"faults", "frequency"},
    {"frequency, wanted", "10.0 Hz"},
    {"frequency, measured", "9.0 Hz"},
    {"scans published per second", "10.5"},
    {"scans published", "31"},
    {"scans complete", "20"},
    {"scans incomplete", "3"},
    {"age of the newest complete scan, ms", "70"},
    {"wrong checksums", "4"},
    {"bytes skipped", "7"},
    {"bytes overrun", "8"},
    {"losses", "5"},
    {"reconnections", "6"},
};

TEST(values_are_totals_and_the_rate)
{
    Report now = healthy(20);
    now.faults = TMINI_FAULT_FREQUENCY;
    now.measured_chz = 900;
    now.incomplete = 3;
    now.published = 31;
    now.counters.checksum_errors = 4;
    now.counters.bytes_skipped = 7;
    now.counters.bytes_overrun = 8;
    now.counters.losses = 5;
    now.age_ms = 70;
    now.reconnections = 6;
    for (const auto &one : values) {
        TEST_ASSERT_EQUAL_STRING_MESSAGE(one.text, value_of(now, one.name).c_str(), one.name);
    }
}

TEST(serial_number_and_firmware_are_known_from_an_answer_or_while_scanning)
{
    Report now = healthy(1);
    TEST_ASSERT_EQUAL_STRING("unknown", serial_number(now).c_str());
    TEST_ASSERT_EQUAL_STRING("unknown", value_of(now, "firmware").c_str());
    now.info = {TMINI_MODEL_T_MINI_PLUS, 2, 1, 1, {2, 0, 2, 3, 1, 2, 0, 5, 0, 0, 0, 0, 1, 2, 3, 4}};
    TEST_ASSERT_EQUAL_STRING("2023120500001234", serial_number(now).c_str());
    TEST_ASSERT_EQUAL_STRING("1.2", value_of(now, "firmware").c_str());
    now.ct.known = TMINI_KNOWN_SERIAL | TMINI_KNOWN_FIRMWARE;
    now.ct.year = 2024;
    now.ct.month = 1;
    now.ct.day = 2;
    now.ct.number = 77;
    now.ct.firmware_major = 1;
    now.ct.firmware_minor = 3;
    TEST_ASSERT_EQUAL_STRING("2024010200000077", value_of(now, "serial number").c_str());
    TEST_ASSERT_EQUAL_STRING("1.3", value_of(now, "firmware").c_str());
}

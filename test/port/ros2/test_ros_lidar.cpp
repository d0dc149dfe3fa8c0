/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the lidar's thread with the simulated lidar on a pseudo-terminal or a socket. */

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "lidar.h"

#include "cpp_tests.h"

using namespace tmini_ros;

/* Ends the program: Unity's way to end a test would leave threads behind. */
static void require(bool is_true, const char *what)
{
    if (!is_true) {
        (void)printf("FAIL: %s\n", what);
        (void)fflush(stdout);
        _exit(1);
    }
}

/* The simulated lidar; its log goes to the file `log`. */
class Simulator
{
  public:
    explicit Simulator(const char *how, const char *value = nullptr)
    {
        int ends[2];
        require(pipe(ends) == 0, "a pipe");
        process_ = fork();
        if (process_ == 0) {
            (void)dup2(ends[1], STDOUT_FILENO);
            execl(TMINI_SIM, TMINI_SIM, "--log", "log", how, value, nullptr);
            _exit(127);
        }
        (void)close(ends[1]);
        FILE *const output = fdopen(ends[0], "r");
        char line[256] = "";
        require(fgets(line, sizeof line, output) != nullptr, "the simulated lidar starts");
        (void)fclose(output);
        address = line;
        address.pop_back();
    }
    ~Simulator()
    {
        end();
    }
    void end()
    {
        if (process_ > 0) {
            (void)kill(process_, SIGTERM);
            (void)waitpid(process_, nullptr, 0);
        }
        process_ = 0;
    }
    std::string address;

  private:
    pid_t process_;
};

class Observer : public Listener
{
  public:
    void take(const tmini_scan_t &scan, std::uint32_t) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        scans++;
        frequency_chz = scan.frequency_chz;
        changed_.notify_all();
    }
    void tell(Level, const std::string &text) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        told += text + "\n";
        changed_.notify_all();
    }
    bool has_subscribers() override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        looks++;
        changed_.notify_all();
        return is_subscribed;
    }
    void subscribe(bool subscribes)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        is_subscribed = subscribes;
    }
    /* Waits, at most a minute. */
    void await(const char *what, const std::function<bool()> &happened)
    {
        std::unique_lock<std::mutex> lock(mutex_);
        require(changed_.wait_for(lock, std::chrono::minutes(1), happened), what);
    }
    void await_scans(int more)
    {
        const int wanted = scans + more;
        await("scans", [&] { return scans >= wanted; });
    }
    bool has_told(const char *text) const
    {
        return told.find(text) != std::string::npos;
    }

    int scans = 0;
    int looks = 0;
    std::uint16_t frequency_chz = 0;
    std::string told;
    bool is_subscribed = false;

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
};

static Settings settings;
static Observer *observer;

void setUp()
{
    settings = initial_settings();
    observer = new Observer;
}

void tearDown()
{
    delete observer;
}

/* The last mode in the simulated lidar's log. */
static bool is_lidar_idle()
{
    std::ifstream log("log");
    const std::string text((std::istreambuf_iterator<char>(log)), std::istreambuf_iterator<char>());
    const size_t at = text.rfind(" mode ");
    return at != std::string::npos && text.find("-> idle", at) < text.find('\n', at);
}

TEST(scans_come_at_the_wished_frequency_and_stop_and_start_as_wished_until_the_end)
{
    Simulator simulator("--pty");
    settings.port = simulator.address;
    {
        Lidar lidar(settings, *observer);
        observer->await_scans(3);
        observer->await("10 Hz", [] { return observer->frequency_chz >= 980; });
        lidar.want_frequency(700);
        observer->await("7 Hz", [] { return observer->frequency_chz <= 720; });
        observer->await_scans(2);
        const Report report = lidar.report();
        require(report.state == TMINI_STATE_SCANNING, "scanning is reported");
        require(report.wanted_chz == 700, "the wish is reported");
        require(report.info.model == TMINI_MODEL_T_MINI_PLUS, "the model is known");
        require(report.complete >= 3 && report.published == report.complete, "scans are counted");
        require(report.counters.packets > 0, "packets are counted");
        require(report.age_ms < 1000, "the newest scan is young");
        require(observer->has_told("the lidar: paused"), "the pause is told");
        lidar.want_scans(false);
        observer->await("a stop", [] { return observer->has_told("stopped"); });
        require(!lidar.report().is_wanted, "the wish is reported");
        lidar.want_scans(true);
        observer->await_scans(2);
    }
    /* The stop has been sent; a simulator that the computer keeps waiting has yet to read it. */
    for (int tries = 0; !is_lidar_idle() && tries < 600; tries++) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    require(is_lidar_idle(), "the lidar is idle at the end");
}

TEST(in_standby_the_lidar_scans_only_while_somebody_subscribes)
{
    Simulator simulator("--pty");
    settings.port = simulator.address;
    settings.standby = true;
    Lidar lidar(settings, *observer);
    observer->await("looks", [] { return observer->looks > 100; });
    require(observer->scans == 0 && !observer->has_told("started"), "standing still");
    observer->subscribe(true);
    observer->await_scans(1);
    observer->subscribe(false);
    observer->await("a stop", [] { return observer->has_told("stopped"); });
}

TEST(a_lidar_that_goes_away_is_reported_and_found_again)
{
    Simulator first("--tcp", "0");
    settings.port = "tcp:" + first.address;
    Lidar lidar(settings, *observer);
    observer->await_scans(1);
    first.end();
    observer->await("an end", [] { return observer->has_told("trying again"); });
    observer->await("a loss", [] { return observer->has_told("the lidar: lost"); });
    const std::string number = first.address.substr(first.address.find(':') + 1);
    Simulator second("--tcp", number.c_str());
    observer->await_scans(2);
    require(observer->has_told("recovered"), "a recovery is told");
    require(lidar.report().reconnections >= 1, "the reconnection is counted");
}

TEST(a_port_that_does_not_exist_is_told_at_once)
{
    settings.port = "/dev/no-such-lidar";
    Lidar lidar(settings, *observer);
    observer->await("words", [] {
        return observer->has_told("/dev/no-such-lidar: no such device; trying again");
    });
}

TEST(incomplete_scans_are_counted_and_published_only_if_wished)
{
    for (const bool is_wished : {false, true}) {
        Simulator simulator("--fault=flip=0.0005", "--pty");
        Observer own;
        settings.port = simulator.address;
        settings.publish_incomplete = is_wished;
        Lidar lidar(settings, own);
        Report report;
        own.await("five incomplete scans", [&] {
            report = lidar.report();
            return report.incomplete >= 5 && report.complete >= 1;
        });
        require(report.published == report.complete + (is_wished ? report.incomplete : 0),
                "what is published");
    }
}

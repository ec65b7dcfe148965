// The measurement, by a real servo; and the report made of it.
#include "doctor/latency.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>

#include "doctor/made_up_machine.hpp"
#include "doctor/report.hpp"

namespace palpate::doctor::test {
namespace {

using support::contains;

TEST(PacedLatency, counts_every_tick_of_a_real_servo_once) {
    double part = 0;
    const Latency latency = measure_latency({0.5, true, [&](double now) {
                                                 EXPECT_GE(now, part);
                                                 part = now;
                                             }});
    EXPECT_EQ(part, 1);
    const ServoReport& report = latency.report;
    EXPECT_GT(report.ticks, 0);
    std::uint64_t counted = 0;
    double last = 0;
    for (const LatenessBin& bin : latency.histogram) {
        EXPECT_GT(bin.to_us, last);
        last = bin.to_us;
        counted += bin.ticks;
    }
    EXPECT_EQ(counted, report.lateness.count);
    EXPECT_EQ(counted, static_cast<std::uint64_t>(report.ticks));
    EXPECT_DOUBLE_EQ(last, static_cast<double>(report.lateness.max) / 1000);
    EXPECT_EQ(latency.privileges.size(), 2U);
    EXPECT_GT(report.compute.p50, 0);
}

TEST(DoctorLatency, stops_when_it_is_told_to) {
    EXPECT_THROW(measure_latency({1000, true, [](double) { throw std::runtime_error("stop"); }}),
                 std::runtime_error);
}

TEST(DoctorReport, says_what_was_measured_and_what_is_wrong) {
    MadeUpMachine machine;
    machine.facts.machine = machine.read();
    Latency& latency = *machine.facts.latency;
    latency.under_load = true;
    latency.seconds = 600;
    latency.rendered = "a torus";
    latency.privileges = {"real-time priority: SCHED_FIFO 80"};
    latency.histogram = {{5, 9'000}, {10, 999}, {40, 1}};
    machine.put("sys/devices/system/clocksource/clocksource0/current_clocksource", "acpi_pm\n");
    const std::vector<Fault> faults = machine.faults();
    const std::string report = report_of(machine.facts, faults, "2024-05-06T07:08Z");
    for (const char* part :
         {"2024-05-06T07:08Z", "PREEMPT_RT", "600 s", "a torus", "SCHED_FIFO 80", "| 10 | 999 |",
          "clock-source", "tsc=reliable", "| lateness (the machine) | 4.0 | 9.0 | 15.0 | 40.0 |",
          "| haply | yes | Inverse3 |", "missed 0"}) {
        EXPECT_TRUE(contains(report, part)) << part << "\n" << report;
    }
    const auto json = json_of(machine.facts, faults);
    EXPECT_EQ(json.at("faults").at(0).at("name"), "clock-source");
    EXPECT_EQ(json.at("essential_missing"), false);
    EXPECT_EQ(json.at("machine").at("preemption"), "real-time");
    EXPECT_EQ(json.at("limits").at("locked_bytes"), "unlimited");
    EXPECT_EQ(json.at("latency").at("lateness_histogram").size(), 3U);
}

TEST(DoctorReport, is_short_for_a_healthy_machine) {
    MadeUpMachine machine;
    const std::vector<Fault> faults = machine.faults();
    const std::string text = summary_of(machine.facts, faults);
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 8);
    EXPECT_TRUE(contains(text, "nothing is missing")) << text;
}

}  // namespace
}  // namespace palpate::doctor::test

// The table of settings and JSON: each setting of a table is written, and read back to the bit.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/json_members.hpp"
#include "palpate/settings.hpp"

namespace palpate {

/// A setting that only this test has.
struct Dummy {
    double wobble = 0.5;
    Magnet magnet;
};
template <>
inline constexpr auto settings_of<Dummy> =
    std::tuple{setting(&Dummy::wobble, "wobble", "mm", "How far it wobbles")
                   .in_files("wobbles")
                   .within(ranges::positive),
               setting(&Dummy::magnet, "magnet", "", "Magnet")};

}  // namespace palpate

namespace palpate::io::test {
namespace {

/// The number in JSON at a path as for_each_number() names it, by the keys of files.
template <class T>
void expect_all_written(const Json& json, const T& value, int& seen) {
    for_each_setting<T>([&](const auto& one) {
        ASSERT_TRUE(json.contains(one.key)) << one.key << " in " << json.dump();
        const auto& part = value.*one.member;
        if constexpr (Described<std::remove_cvref_t<decltype(part)>>) {
            expect_all_written(json.at(one.key), part, seen);
        } else {
            EXPECT_EQ(json.at(one.key), JsonWriter::of(part)) << one.key;
        }
        ++seen;
    });
}

TEST(SettingsTable, a_setting_that_is_added_to_a_table_is_in_files) {
    const Dummy written{.wobble = 0.1, .magnet = {.distance = 3, .peak = 0.25}};
    const Json json = JsonWriter::of(written);
    EXPECT_EQ(json.dump(), R"({"wobbles":0.1,"magnet":{"distance":3.0,"peak":0.25}})");
    Dummy read;
    JsonReader::get(json, "dummy", read);
    EXPECT_EQ(read.wobble, 0.1);
    EXPECT_EQ(read.magnet, written.magnet);
    EXPECT_THROW(JsonReader::get(Json{{"wobbles", "far"}}, "dummy", read), std::invalid_argument);
}

TEST(SettingsTable, a_setting_that_is_added_to_a_table_is_checked) {
    const auto refusal = [](const Dummy& dummy) -> std::string {
        try {
            check_ranges(dummy);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refusal({}), "");
    EXPECT_EQ(refusal({.wobble = 0, .magnet = {}}), "wobble [mm] = 0: must be finite and above 0");
    EXPECT_EQ(refusal({.magnet = {.peak = -1}}),
              "magnet peak [N] = -1: must be finite and at least 0");
}

TEST(SettingsTable, numbers_are_named_by_their_path_and_their_range_is_told) {
    Dummy dummy;
    std::vector<std::string> names;
    for_each_number("dummy", dummy, [&](const std::string& name, const auto& one, double& value) {
        names.push_back(name);
        EXPECT_TRUE(one.range.has(1)) << name;
        EXPECT_FALSE(one.range.has(-1)) << name;
        EXPECT_EQ(one.range.has(0), name != "dummy.wobble") << name;
        EXPECT_FALSE(one.range.has(std::numeric_limits<double>::quiet_NaN())) << name;
        EXPECT_FALSE(one.range.has(std::numeric_limits<double>::infinity())) << name;
        value = 2;
    });
    EXPECT_EQ(names, (std::vector<std::string>{"dummy.wobble", "dummy.magnet.distance",
                                               "dummy.magnet.peak"}));
    EXPECT_EQ(dummy.wobble + dummy.magnet.distance + dummy.magnet.peak, 6);
}

TEST(SettingsTable, recordings_and_session_files_have_every_setting) {
    RendererSettings written;
    double next = 0.125;
    const auto change = [&](const char* path, auto& group) {
        for_each_number(path, group, [&](auto&, const auto&, double& value) { value = next += 1; });
    };
    change("force", written.force);
    change("friction", written.proxy.friction);
    change("device", written.device);
    const Json json = to_json(written);
    int seen = 0;
    expect_all_written(json.at("force"), written.force, seen);
    expect_all_written(json.at("friction"), written.proxy.friction, seen);
    expect_all_written(json.at("device"), written.device, seen);
    expect_all_written(json.at("transform"), written.transform, seen);
    EXPECT_GT(seen, 25);
    RendererSettings read;
    from_json(json, read);
    EXPECT_EQ(read.force, written.force);
    EXPECT_EQ(read.device, written.device);
    EXPECT_EQ(to_json(read), json);
}

}  // namespace
}  // namespace palpate::io::test

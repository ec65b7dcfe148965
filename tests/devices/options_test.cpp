// --device NAME:OPTIONS.
#include "palpate/devices/options.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "support/scratch_folder.hpp"

namespace palpate::devices {
namespace {

constexpr auto refusal = [](const auto& call) {
    return support::message_of<std::invalid_argument>(call);
};

TEST(DeviceOptions, a_name_alone_has_none) {
    const DeviceChoice choice = parse_device("haply");
    EXPECT_EQ(choice.name, "haply");
    EXPECT_TRUE(choice.options.empty());
}

TEST(DeviceOptions, pairs_are_found_by_key_and_a_value_alone_is_the_main_one) {
    DeviceOptions options(parse_device("simulated:omni,hand=press,friction=no,rate=2.5"),
                          "profile");
    EXPECT_EQ(options.text("profile", "touch"), "omni");
    EXPECT_EQ(options.one_of("hand", "explore", {"explore", "press"}), "press");
    EXPECT_FALSE(options.flag("friction", true));
    EXPECT_EQ(options.number("rate", 1, 0, 10), 2.5);
    EXPECT_EQ(options.number("delay", 4, 0, 10), 4);
    EXPECT_NO_THROW(options.finish());
}

TEST(DeviceOptions, a_value_may_hold_colons_and_equals_signs) {
    DeviceOptions options(parse_device("recorded:file=a:b=c.csv"), "file");
    EXPECT_EQ(options.text("file", ""), "a:b=c.csv");
}

TEST(DeviceOptions, what_cannot_be_meant_is_refused_with_the_accepted_range) {
    EXPECT_NE(refusal([] { parse_device(":x"); }).find("name"), std::string::npos);
    EXPECT_NE(refusal([] { parse_device("a:x=1,x=2"); }).find("twice"), std::string::npos);
    EXPECT_NE(refusal([] { parse_device("a:,"); }).find("KEY=VALUE"), std::string::npos);
    EXPECT_NE(refusal([] { parse_device("a:=2"); }).find("KEY=VALUE"), std::string::npos);
    const auto options = [] { return DeviceOptions(parse_device("a:x=12,y"), ""); };
    EXPECT_NE(refusal([&] { options().number("x", 1, 0, 10); }).find("from 0 to 10"),
              std::string::npos);
    EXPECT_NE(refusal([] {
                  DeviceOptions(parse_device("a:x="), "").number("x", 1, 0, 10);
              }).find("x=: a number from 0 to 10"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  options().one_of("x", "b", {"b", "c"});
              }).find("b, c"),
              std::string::npos);
    EXPECT_NE(refusal([&] { options().finish(); }).find("'y' is no KEY=VALUE"), std::string::npos);
    EXPECT_NE(refusal([] { DeviceOptions(parse_device("a:p=1,2"), "p"); }).find("twice"),
              std::string::npos);
}

TEST(DeviceOptions, an_option_that_nobody_asked_for_is_refused_with_those_there_are) {
    DeviceOptions options(parse_device("a:z=1"), "");
    options.text("x", "");
    EXPECT_EQ(refusal([&] { options.finish(); }), "device a: no option 'z': use one of x");
}

}  // namespace
}  // namespace palpate::devices

// A test program for second_chance_test.py: its cases pass, fail or abort as the environment says,
// and each appends its name to the file RAN.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace {

std::string setting(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

bool ran_before(const std::string& name) {
    std::ifstream in(setting("RAN"));
    for (std::string line; std::getline(in, line);) {
        if (line == name) return true;
    }
    return false;
}

void run(const std::string& name) {
    const bool before = ran_before(name);
    std::ofstream(setting("RAN"), std::ios::app) << name << '\n';
    if (setting("ABORTS") == name) std::abort();
    EXPECT_NE(setting("ALWAYS_FAILS"), name);
    if (setting("FAILS_ONCE") == name) {
        EXPECT_TRUE(before);
    }
}

TEST(Plain, one) {
    run("one");
}
TEST(Plain, two) {
    run("two");
}
TEST(PacedPlain, three) {
    run("three");
}

class Counted : public testing::TestWithParam<int> {};
TEST_P(Counted, four) {
    run("four/" + std::to_string(GetParam()));
}
INSTANTIATE_TEST_SUITE_P(Few, Counted, testing::Values(0, 1));

}  // namespace

// The service is found by environment variables, which POSIX sets while a program runs.
#include <cstdlib>

#include "devices/haply/haply_fixture.hpp"
#include "devices/haply/socket.hpp"

namespace palpate::devices {
namespace {

TEST_F(HaplyTest, a_service_elsewhere_is_found_by_the_environment) {
    setenv("HAPLY_WS_HOST", "127.0.0.1", 1);
    setenv("HAPLY_WS_PORT", std::to_string(service.port()).c_str(), 1);
    const DeviceFinding there = find_haply();
    EXPECT_EQ(there.name, "haply");
    EXPECT_TRUE(there.found);
    EXPECT_NE(there.what.find("Inverse3 049D, firmware 7.4"), std::string::npos) << there.what;
    EXPECT_EQ(there.missing, "");

    service.greet(snapshot({}));
    const DeviceFinding none = find_haply();
    EXPECT_FALSE(none.found);
    EXPECT_NE(none.missing.find("no Inverse3"), std::string::npos) << none.missing;

    service.hang(true);
    const DeviceFinding silent = find_haply();
    EXPECT_FALSE(silent.found);
    EXPECT_NE(silent.missing, "");

    setenv("HAPLY_WS_PORT", "http", 1);
    EXPECT_NE(find_haply().missing.find("HAPLY_WS_PORT=http"), std::string::npos);
    unsetenv("HAPLY_WS_HOST");
    unsetenv("HAPLY_WS_PORT");
}

TEST_F(HaplyTest, the_usual_service_is_looked_for_without_a_resolver) {
    setenv("HAPLY_WS_PORT", std::to_string(service.port()).c_str(), 1);
    EXPECT_NE(find_haply().what.find("127.0.0.1:"), std::string::npos) << find_haply().missing;
    unsetenv("HAPLY_WS_PORT");
    EXPECT_NE(find_haply().options.find("host=127.0.0.1"), std::string::npos);
    EXPECT_EQ(palpate::devices::haply::look_up("localhost", 1).numeric,
              (std::vector<std::string>{"127.0.0.1", "::1"}));
}

}  // namespace
}  // namespace palpate::devices

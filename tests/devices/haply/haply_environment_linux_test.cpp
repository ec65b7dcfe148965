// The service is found by environment variables, which POSIX sets while a program runs.
#include <cstdlib>

#include "devices/haply/haply_fixture.hpp"
#include "support/silent_server.hpp"

namespace palpate::devices {
namespace {

class HaplyEnvironment : public HaplyTest {
  protected:
    ~HaplyEnvironment() override {
        unsetenv("HAPLY_WS_HOST");
        unsetenv("HAPLY_WS_PORT");
    }
    DeviceFinding find() { return haply::find({service.channel(), {}}, timing); }
};

TEST_F(HaplyEnvironment, a_service_elsewhere_is_found_by_the_environment) {
    setenv("HAPLY_WS_HOST", "127.0.0.2", 1);
    setenv("HAPLY_WS_PORT", "4712", 1);
    const DeviceFinding there = find();
    EXPECT_EQ(there.name, "haply");
    EXPECT_TRUE(there.found);
    EXPECT_NE(there.what.find("Inverse3 049D, firmware 7.4"), std::string::npos) << there.what;
    EXPECT_NE(there.what.find("127.0.0.2:4712"), std::string::npos) << there.what;
    EXPECT_EQ(there.missing, "");
    EXPECT_EQ(service.address().port, 4712);
    EXPECT_EQ(service.address().numeric, std::vector<std::string>{"127.0.0.2"});

    service.greet(snapshot({}));
    const DeviceFinding none = find();
    EXPECT_FALSE(none.found);
    EXPECT_NE(none.missing.find("no Inverse3"), std::string::npos) << none.missing;

    service.hang(true);
    const std::int64_t begun = virtual_now();
    const DeviceFinding silent = find();
    EXPECT_FALSE(silent.found);
    EXPECT_NE(silent.missing, "");
    EXPECT_EQ(passed_since(begun), 2s);

    setenv("HAPLY_WS_PORT", "http", 1);
    EXPECT_NE(haply::find().missing.find("HAPLY_WS_PORT=http"), std::string::npos);
}

TEST_F(HaplyEnvironment, the_usual_service_is_looked_for_without_a_resolver) {
    setenv("HAPLY_WS_PORT", "4712", 1);
    EXPECT_NE(find().what.find("127.0.0.1:4712"), std::string::npos);
    EXPECT_NE(find().options.find("host=127.0.0.1"), std::string::npos);
    EXPECT_EQ(haply::look_up("localhost", 1).numeric,
              (std::vector<std::string>{"127.0.0.1", "::1"}));
}

TEST_F(HaplyEnvironment, what_waits_for_a_silent_service_ends_when_it_is_told_to) {
    struct Stop {};
    const auto stops = [](const auto& work) {
        for (int attempt = 0; attempt < 20; ++attempt) {
            int calls = 0;
            try {
                work([&](double) {
                    if (++calls == 2) throw Stop{};
                });
            } catch (const Stop&) {
                return true;
            } catch (
                const DeviceError&) {  // this thread was stalled until the service was given up
            }
        }
        return false;
    };
    const support::SilentServer server;
    const std::string address = server.address();
    const std::size_t colon = address.rfind(':');
    const std::string port = address.substr(colon + 1, address.rfind('/') - colon - 1);
    EXPECT_TRUE(stops([&](const OnProgress& progress) {
        DeviceScene scene = support::any_scene();
        scene.progress = progress;
        (void)open_device({"haply", {{"host", "127.0.0.1"}, {"port", port}}}, scene);
    }));
    setenv("HAPLY_WS_PORT", port.c_str(), 1);
    EXPECT_TRUE(stops([](const OnProgress& progress) { (void)find_devices(progress); }));
}

}  // namespace
}  // namespace palpate::devices

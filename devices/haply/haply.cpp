// Finds and opens the device `haply`: its options and errors.
#include "devices/haply/haply.hpp"

#include <cstdlib>
#include <utility>

#include "devices/haply/inverse3.hpp"
#include "devices/opening.hpp"
#include "io/system/number.hpp"

namespace palpate::devices {
namespace {

using namespace std::chrono_literals;

std::string usual_host() {
    const char* host = std::getenv("HAPLY_WS_HOST");
    return host && *host ? host : "127.0.0.1";  // not a name: it is found without a resolver
}

std::uint16_t usual_port() {
    const char* given = std::getenv("HAPLY_WS_PORT");
    if (!given || !*given) return 10001;
    const auto port = io::number_from<int>(given);
    if (port && *port >= 1 && *port <= 65535) return static_cast<std::uint16_t>(*port);
    throw std::invalid_argument("device haply: HAPLY_WS_PORT=" + std::string(given) +
                                ": a number from 1 to 65535 is needed");
}

/// A conversation with the service that has begun, or why not.
struct Begun {
    haply::Address address;
    haply::Talk talk;
    std::string wrong = {};
};

/// Throws DeviceError if there is no such host.
Begun begin_talk(haply::Talk talk, const std::string& host, std::uint16_t port,
                 const std::string& device, const Timing& timing) {
    Begun begun{haply::look_up(host, port), std::move(talk)};
    if (begun.address.numeric.empty()) {
        throw DeviceError("device haply: no host '" + host +
                          "': host=NAME is where Haply's Inverse Service runs, usually 127.0.0.1");
    }
    // For a service that is just starting, and for one on a busy machine, which answers late.
    const haply::Clock::time_point begin = haply::time_of(timing);
    const haply::Clock::time_point started = begin + 1s, answered = begin + 5s;
    for (;;) {
        begun.wrong = haply::start_talk(begun.talk, begun.address, device, answered);
        const haply::Clock::time_point next = haply::time_of(timing) + 100ms;
        if (begun.wrong.empty() || next > started) break;
        timing.sleep_until(haply::ns_of(next));
    }
    if (begun.wrong.empty() && begun.talk.state.device_id.empty()) {
        begun.wrong = haply::no_device(begun.talk, begun.address);
    }
    return begun;
}

}  // namespace

DeviceFinding haply::find(Talk talk, const Timing& timing) {
    return finding_of(
        "haply",
        "host=127.0.0.1,port=10001,device=ID (the first),force_key=auto (auto|values|vector),"
        "preset=defaults,axes=xz-y,"
        "calibrated=ask (ask|assume),timeout=2",
        [&](DeviceFinding& finding) {
            const Address address = look_up(usual_host(), usual_port());
            finding.missing = start_talk(talk, address, "", time_of(timing) + 2s);
            if (!finding.missing.empty()) return;
            finding.found = !talk.state.device_id.empty();
            const std::string place = address.host + ":" + std::to_string(address.port);
            if (finding.found) {
                finding.what = talk.state.model + ", Inverse Service at " + place;
            } else {
                finding.missing = no_device(talk, address);
            }
            talk.channel->close(time_of(timing) + 50ms);
        });
}

std::unique_ptr<haply::Inverse3> haply::open(const DeviceChoice& choice, const DeviceScene& scene,
                                             Talk talk, const Timing& timing) {
    DeviceOptions options(choice, "host");
    const std::string host = options.text("host", usual_host());
    const auto port =
        static_cast<std::uint16_t>(options.whole_number("port", usual_port(), 1, 65535));
    Settings settings;
    settings.device = options.text("device", "");
    const std::string key = options.one_of("force_key", "auto", {"auto", "values", "vector"});
    if (key != "auto") settings.force_key = key == "values" ? ForceKey::values : ForceKey::vector;
    settings.preset = options.text("preset", settings.preset);
    if (!is_device_id(settings.preset)) {
        throw std::invalid_argument("device haply: preset=" + settings.preset +
                                    ": a name of the service's, such as defaults or led_front, "
                                    "or keep");
    }
    settings.axes = axes_from(options.text("axes", "xz-y"));
    settings.assume_calibrated = options.one_of("calibrated", "ask", {"ask", "assume"}) == "assume";
    settings.timeout = options.number("timeout", settings.timeout, 0.1, 5);
    settings.rate = scene.rate;
    options.finish();

    Begun begun = left_alone_when_stopped(
        scene.progress,
        [talk = std::move(talk), host, port, device = settings.device, timing]() mutable {
            return begin_talk(std::move(talk), host, port, device, timing);
        });
    if (!begun.wrong.empty()) throw DeviceError("device haply: " + begun.wrong);
    return std::make_unique<Inverse3>(std::move(settings), std::move(begun.address),
                                      std::move(begun.talk), timing);
}

}  // namespace palpate::devices

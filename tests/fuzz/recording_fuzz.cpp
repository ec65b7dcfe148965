// Any text gives a recording whose events can be rendered again, or a one-line InputError.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "palpate/io/recording.hpp"

namespace {

/// Plays the events to a session on a small volume, as validation would.
void play(palpate::io::RecordingReader& reader) {
    using namespace palpate;
    const io::RecordingHead& head = reader.head();
    std::vector<float> samples(27);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<float>(i % 5);
    Geometry geometry;
    geometry.size = {3, 3, 3};
    try {
        RendererSettings settings = head.settings;
        settings.proxy.step_budget = std::min(settings.proxy.step_budget, 64);
        check(head.session);
        Session session{make_renderer(linear_field(Volume(geometry, std::move(samples)), head.solid,
                                                   head.background),
                                      head.isovalue, settings),
                        head.session};
        while (const auto event = reader.next()) {
            if (const auto* command = std::get_if<Command>(&*event)) {
                apply(session, *command);
                continue;
            }
            const auto& tick = std::get<SessionTick>(*event);
            const SessionTick again = repeat(session, tick);
            require(again.tick.force.allFinite());
            require(again.tick.force.norm() <=
                    session.renderer.settings.device.maximum_force * (1 + 1e-12));
        }
    } catch (const std::invalid_argument&) {  // a head or a command that cannot be carried out
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        palpate::io::RecordingReader reader(std::string(reinterpret_cast<const char*>(data), size),
                                            "text");
        play(reader);
    } catch (const palpate::io::InputError& error) {
        require_one_line(error.what(), "text");
    }
    return 0;
}

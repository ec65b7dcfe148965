// Any lines from the Inverse Service give a plausible position or a refusal, a ready device only
// once all its conditions have been reported, and an id that is safe in a command.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "devices/haply/protocol.hpp"
#include "fuzz/require.hpp"

namespace {

using namespace palpate;
using namespace palpate::devices::haply;

void check(const ServiceState& state) {
    if (state.position) {
        require(state.position->allFinite() && state.position->norm() <= farthest_position);
    }
    const Mat3& turn = state.grip.orientation;
    require((turn * turn.transpose() - Mat3::Identity()).norm() < 1e-9);
    require(state.grip.buttons < 8);
    require(is_one_line(state.model) && is_one_line(state.attached));
    require(is_one_line(problem_of(state)));
    if (status_of(state) == DeviceStatus::ready) {
        require(state.position && state.calibrated.value() && state.ready.value() &&
                state.started.value());
    }
    if (state.device_id.empty()) return;
    require(is_device_id(state.device_id));
    ForceCommand command(state.device_id, ForceKey::vector);
    const auto told = nlohmann::json::parse(command.with(Vec3(1e300, -1e-300, 0.1)));
    require(told["inverse3"][0]["device_id"] == state.device_id);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view text(reinterpret_cast<const char*>(data), size);
    ServiceState state;
    if (text.starts_with('!')) state.wanted = "B";
    for (bool more = true; more;) {
        const auto end = text.find('\n');
        const auto before = state.position;
        const News news = take_message(state, text.substr(0, end));
        require(news != News::refused || (state.position == before && !state.error.empty()));
        require(news != News::state || !state.device_id.empty());
        check(state);
        more = end != std::string_view::npos;
        if (more) text.remove_prefix(end + 1);
    }
    return 0;
}

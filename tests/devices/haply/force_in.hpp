// The force in a message to the service.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "palpate/volume.hpp"

namespace palpate::support {

/// [N, service axes]
inline std::optional<Vec3> force_in(const std::string& message) {
    const auto json = nlohmann::json::parse(message, nullptr, false);
    if (!json.is_object()) return std::nullopt;
    const auto list =
        std::ranges::find_if(json, [](const nlohmann::json& value) { return value.is_array(); });
    if (list == json.end()) return std::nullopt;
    const auto& command = (*list)[0]["commands"]["set_cursor_force"];
    const auto& force = command.contains("values") ? command["values"] : command["vector"];
    return Vec3(force["x"].get<double>(), force["y"].get<double>(), force["z"].get<double>());
}

}  // namespace palpate::support

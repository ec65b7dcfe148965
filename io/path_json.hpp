// Paths in JSON. A path of Linux is bytes, which need not be UTF-8, as JSON's text must be.
// Private to io/, stream/, run/ and programs.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace palpate::io {

/// Text, if the path is UTF-8; else {"bytes": "2f746d702f..."}, hexadecimal.
nlohmann::json json_of_path(const std::filesystem::path& path);
/// Throws std::invalid_argument for what is neither.
std::filesystem::path path_from_json(const nlohmann::json& json);

}  // namespace palpate::io

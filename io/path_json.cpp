// Paths in JSON. See the header.
#include "io/path_json.hpp"

#include <charconv>
#include <stdexcept>

namespace palpate::io {
namespace {

bool is_utf8(const std::string& text) {
    try {
        (void)nlohmann::json(text).dump();
        return true;
    } catch (const nlohmann::json::type_error&) {
        return false;
    }
}

}  // namespace

nlohmann::json json_of_path(const std::filesystem::path& path) {
    const std::string bytes = path.string();
    if (is_utf8(bytes)) return bytes;
    std::string digits;
    for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        digits += "0123456789abcdef"[byte >> 4];
        digits += "0123456789abcdef"[byte & 15];
    }
    return {{"bytes", digits}};
}

std::filesystem::path path_from_json(const nlohmann::json& json) {
    if (json.is_string()) return json.get<std::string>();
    const nlohmann::json digits =
        json.is_object() ? json.value("bytes", nlohmann::json()) : nlohmann::json();
    const std::string text = digits.is_string() ? digits.get<std::string>() : "odd";
    std::string bytes;
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
        unsigned byte = 0;
        const char* const at = text.data() + i;
        if (std::from_chars(at, at + 2, byte, 16).ptr != at + 2) break;
        bytes += static_cast<char>(byte);
    }
    if (2 * bytes.size() != text.size()) throw std::invalid_argument("this is no path");
    return bytes;
}

}  // namespace palpate::io

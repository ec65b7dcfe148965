// Converts DICOM texts to UTF-8. See the header.
#include "io/helper/dicom_text.hpp"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <string_view>
#include <utility>

namespace palpate::io {
namespace {

constexpr char escape = '\x1b';

/// The name that iconv has for a set; empty if it is not known. ISO 2022 is the same with escapes.
std::string iconv_name(std::string_view set) {
    static constexpr std::array<std::pair<std::string_view, const char*>, 19> names = {
        {{"", "ASCII"},
         {"6", "ASCII"},
         {"100", "ISO-8859-1"},
         {"101", "ISO-8859-2"},
         {"109", "ISO-8859-3"},
         {"110", "ISO-8859-4"},
         {"144", "ISO-8859-5"},
         {"127", "ISO-8859-6"},
         {"126", "ISO-8859-7"},
         {"138", "ISO-8859-8"},
         {"148", "ISO-8859-9"},
         {"203", "ISO-8859-15"},
         {"166", "TIS-620"},
         {"13", "SHIFT_JIS"},
         {"87", "ISO-2022-JP-3"},
         {"159", "ISO-2022-JP-2"},
         {"149", "EUC-KR"},
         {"58", "GB2312"},
         {"192", "UTF-8"}}};
    if (set == "GB18030" || set == "GBK") return std::string(set);
    for (const std::string_view prefix : {"ISO_IR ", "ISO 2022 IR "}) {
        if (set.starts_with(prefix)) set.remove_prefix(prefix.size());
    }
    const auto found =
        std::ranges::find(names, set, &std::pair<std::string_view, const char*>::first);
    return found == names.end() ? std::string() : found->second;
}

/// Of several sets, those with more characters than ASCII and a Latin alphabet.
std::string chosen_name(std::string_view sets) {
    std::string chosen;
    while (true) {
        const std::size_t end = std::min(sets.find('\\'), sets.size());
        const std::string name = iconv_name(sets.substr(0, end));
        const bool is_usual = chosen.empty() || chosen == "ASCII" || chosen == "SHIFT_JIS" ||
                              chosen.starts_with("ISO-8859");
        if (is_usual && (name != "ASCII" || chosen.empty())) chosen = name;
        if (end == sets.size()) return chosen;
        sets.remove_prefix(end + 1);
    }
}

/// Without the escapes that say which set follows: all of it is of one.
std::string without_escapes(std::string_view text) {
    std::string plain;
    for (std::size_t at = 0; at < text.size(); ++at) {
        if (text[at] != escape) {
            plain += text[at];
            continue;
        }
        while (at + 1 < text.size() && text[at + 1] >= ' ' && text[at + 1] <= '/') ++at;
        ++at;  // the last one of the escape
    }
    return plain;
}

std::optional<std::string> converted(std::string text, const std::string& name) {
    const iconv_t job = iconv_open("UTF-8", name.c_str());
    if (job == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
    std::string out(4 * text.size() + 16, '\0');
    char* from = text.data();
    char* to = out.data();
    std::size_t left = text.size(), room = out.size();
    const bool is_done = iconv(job, &from, &left, &to, &room) != static_cast<std::size_t>(-1) &&
                         iconv(job, nullptr, nullptr, &to, &room) != static_cast<std::size_t>(-1);
    iconv_close(job);
    if (!is_done) return std::nullopt;
    out.resize(out.size() - room);
    return out;
}

}  // namespace

std::string dicom_in_utf8(const std::string& text, const std::string& sets) {
    const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 128 && c != escape; };
    if (std::ranges::all_of(text, is_ascii)) return text;
    const std::string name = chosen_name(sets);
    const bool has_states = name.starts_with("ISO-2022");
    if (!name.empty()) {
        if (auto whole = converted(has_states ? text : without_escapes(text), name)) return *whole;
    }
    std::string shown;
    for (const char c : text) {
        char code[8];
        std::snprintf(code, sizeof code, "\\x%02x", static_cast<unsigned char>(c));
        shown += is_ascii(c) ? std::string(1, c) : code;
    }
    return shown;
}

}  // namespace palpate::io

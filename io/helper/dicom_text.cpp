// Converts text of DICOM to UTF-8 with the system's iconv. See the header.
#include "io/helper/dicom_text.hpp"

#include <iconv.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string_view>

namespace palpate::io {
namespace {

bool is_plain(char c) {
    return static_cast<unsigned char>(c) < 0x80;
}

/// From `set` as iconv names it. What cannot be converted is shown byte by byte.
class Converter {
  public:
    explicit Converter(const char* set) : state_(iconv_open("UTF-8", set)) {}
    ~Converter() {
        if (is_there()) iconv_close(state_);
    }
    Converter(const Converter&) = delete;
    Converter& operator=(const Converter&) = delete;

    std::string convert(std::string bytes) {
        std::string text;
        char* from = bytes.data();
        std::size_t left = bytes.size();
        while (left > 0) {
            char some[256];
            char* to = some;
            std::size_t room = sizeof some;
            const bool fails = !is_there() || iconv(state_, &from, &left, &to, &room) == failed;
            text.append(some, to);
            if (!fails || left == 0 || (is_there() && to != some)) continue;
            char shown[8];
            std::snprintf(shown, sizeof shown, "\\x%02x", static_cast<unsigned char>(*from));
            text += is_plain(*from) ? std::string(1, *from) : shown;
            ++from;
            --left;
        }
        return text;
    }

  private:
    static constexpr auto failed = static_cast<std::size_t>(-1);
    bool is_there() const { return state_ != iconv_t(-1); }
    iconv_t state_;
};

/// The sets without code extensions, by their defined terms without "ISO_IR ".
const char* plain_set(const std::string& term) {
    static const std::map<std::string, const char*> sets = {
        {"100", "ISO-8859-1"}, {"101", "ISO-8859-2"},  {"109", "ISO-8859-3"}, {"110", "ISO-8859-4"},
        {"144", "ISO-8859-5"}, {"127", "ISO-8859-6"},  {"126", "ISO-8859-7"}, {"138", "ISO-8859-8"},
        {"148", "ISO-8859-9"}, {"203", "ISO-8859-15"}, {"13", "SHIFT_JIS"},   {"166", "TIS-620"},
        {"192", "UTF-8"},      {"GB18030", "GB18030"}, {"GBK", "GBK"},        {"149", "EUC-KR"},
        {"58", "GB2312"}};
    const auto found = sets.find(term);
    return found == sets.end() ? "UTF-8" : found->second;  // ASCII is part of it
}

/// "100" of "ISO_IR 100", "ISO 2022 IR 100" and what some writers make of these.
std::string number_of(const std::string& term) {
    const std::size_t at = term.find_last_of("0123456789");
    if (term.find("ISO") == term.npos || at == term.npos) return term;
    const std::size_t before = term.find_last_not_of("0123456789", at);
    return term.substr(before + 1, at - before);
}

/// A set that an escape sequence switches to, for bytes without or with the highest bit.
struct Switch {
    std::string_view letters;  // behind the escape character
    bool is_high;
    const char* set;
    bool has_two = false;          // bytes of a letter, whose highest bits are not set
    std::string_view prefix = {};  // of a letter
};

const Switch* switch_in(std::string_view text) {
    static const Switch all[] = {{"(B", false, "UTF-8"},
                                 {"(J", false, "UTF-8"},
                                 {")I", true, "SHIFT_JIS"},
                                 {"$B", false, "EUC-JP", true},
                                 {"$@", false, "EUC-JP", true},
                                 {"$(B", false, "EUC-JP", true},
                                 {"$(D", false, "EUC-JP", true, "\x8f"},
                                 {"$)C", true, "EUC-KR"},
                                 {"$)A", true, "GB2312"},
                                 {"-A", true, "ISO-8859-1"},
                                 {"-B", true, "ISO-8859-2"},
                                 {"-C", true, "ISO-8859-3"},
                                 {"-D", true, "ISO-8859-4"},
                                 {"-L", true, "ISO-8859-5"},
                                 {"-G", true, "ISO-8859-6"},
                                 {"-F", true, "ISO-8859-7"},
                                 {"-H", true, "ISO-8859-8"},
                                 {"-M", true, "ISO-8859-9"},
                                 {"-b", true, "ISO-8859-15"},
                                 {"-T", true, "TIS-620"}};
    const auto found =
        std::ranges::find_if(all, [&](const Switch& one) { return text.starts_with(one.letters); });
    return found == std::end(all) ? nullptr : found;
}

/// Bytes between two escape sequences.
std::string run_of(std::string_view bytes, const Switch* low, const char* high) {
    if (low == nullptr || !low->has_two) return Converter(high).convert(std::string(bytes));
    std::string letters;
    for (std::size_t i = 0; i < bytes.size(); i += 2) {
        letters += low->prefix;
        for (const char c : bytes.substr(i, 2)) letters += static_cast<char>(c | 0x80);
    }
    return Converter(low->set).convert(letters);
}

}  // namespace

std::string utf8_of(const std::string& bytes, const std::string& set) {
    constexpr char escape = '\x1b';
    if (std::ranges::all_of(bytes, [](char c) { return is_plain(c) && c != escape; })) {
        return bytes;
    }
    const char* high = plain_set(number_of(set.substr(0, set.find('\\'))));
    if (set.find("2022") == set.npos && set.find('\\') == set.npos) {
        return Converter(high).convert(bytes);
    }
    const Switch* low = nullptr;
    std::string text;
    for (std::string_view rest = bytes; !rest.empty();) {
        const std::size_t end = std::min(rest.find(escape), rest.size());
        text += run_of(rest.substr(0, end), low, high);
        rest.remove_prefix(end);
        if (rest.empty()) break;
        rest.remove_prefix(1);
        const Switch* const next = switch_in(rest);
        if (next == nullptr) continue;
        if (next->is_high) {
            high = next->set;
        } else {
            low = next;
        }
        rest.remove_prefix(next->letters.size());
    }
    return text;
}

}  // namespace palpate::io

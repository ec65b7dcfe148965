// Reads dates and times of DICOM. See the header.
#include "io/helper/dicom_time.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

namespace palpate::io {
namespace {

bool is_figure(char c) {
    return c >= '0' && c <= '9';
}

/// A number of `count` digits, of which all have to be there.
std::optional<int> digits(const std::string& text, std::size_t at, std::size_t count) {
    if (at + count > text.size()) return std::nullopt;
    int value = 0;
    for (std::size_t i = at; i < at + count; ++i) {
        if (!is_figure(text[i])) return std::nullopt;
        value = 10 * value + (text[i] - '0');
    }
    return value;
}

/// [s] to the day's begin. A part that is missing at the end counts as its first value.
std::optional<double> day_of(std::string date) {
    std::erase(date, '.');  // of old files
    const auto year = digits(date, 0, 4);
    if (!year) return std::nullopt;
    const int month = std::clamp(digits(date, 4, 2).value_or(1), 1, 12);
    const int day = std::clamp(digits(date, 6, 2).value_or(1), 1, 31);
    // A day beyond the end of its month counts on, in the next one.
    const auto first = std::chrono::sys_days(std::chrono::year(*year) / month / 1);
    return 86400.0 * (first.time_since_epoch().count() + day - 1);
}

/// [s] since the day's begin: HHMMSS.FFFFFF, of which all behind the hours may be missing. Old
/// files have colons. Some writers leave out the first zero.
std::optional<double> time_of(std::string time) {
    std::erase(time, ':');
    std::ranges::replace(time, ',', '.');
    const auto end = std::ranges::find_if_not(time, is_figure);
    std::string whole(time.begin(), end);
    if (whole.size() % 2 == 1) whole.insert(0, 1, '0');
    const auto hours = digits(whole, 0, 2);
    if (!hours) return std::nullopt;
    double fraction = 0, part = 0.1;
    if (whole.size() == 6 && end != time.end() && *end == '.') {
        for (auto at = end + 1; at != time.end() && is_figure(*at); ++at, part /= 10) {
            fraction += part * (*at - '0');
        }
    }
    return *hours * 3600.0 + digits(whole, 2, 2).value_or(0) * 60.0 +
           digits(whole, 4, 2).value_or(0) + fraction;
}

/// [s] of "+HHMM" or "-HHMM", which is what a clock shows more than Coordinated Universal Time.
double offset_of(const std::string& text) {
    const auto hours = digits(text, 1, 2), minutes = digits(text, 3, 2);
    if (!hours || !minutes || (text[0] != '+' && text[0] != '-')) return 0;
    return (text[0] == '-' ? -1 : 1) * (*hours * 3600.0 + *minutes * 60.0);
}

}  // namespace

double moment_of(const std::string& date, const std::string& time, const std::string& offset) {
    const auto seconds = time_of(time);
    if (!seconds) return std::numeric_limits<double>::quiet_NaN();
    const auto day = day_of(date);
    return day.value_or(0) + *seconds - offset_of(offset);
}

double moment_of(const std::string& both, const std::string& offset) {
    constexpr std::size_t date_size = 8;
    const std::size_t sign = both.find_first_of("+-");
    const std::string local = both.substr(0, sign);
    if (local.size() < date_size + 2) return std::numeric_limits<double>::quiet_NaN();
    return moment_of(local.substr(0, date_size), local.substr(date_size),
                     sign == both.npos ? offset : both.substr(sign));
}

}  // namespace palpate::io

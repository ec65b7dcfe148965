// Compares names by the number of letters that have to change (optimal string alignment), and
// writes messages about numbers that are out of range.
#include "palpate/names.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <utility>
#include <vector>

namespace palpate {
namespace {

std::string small_letters(std::string_view text) {
    std::string small(text);
    for (char& c : small) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return small;
}

std::size_t changes_between(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before, last(b.size() + 1), now(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        now[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) now[j] = std::min(now[j], before[j - 2] + 1);
        }
        before = std::exchange(last, now);
    }
    return last[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view word, std::span<const std::string> names) {
    constexpr std::size_t longest_word = 64;
    if (word.empty() || word.size() > longest_word) return {};
    const std::string meant = small_letters(word);
    std::string nearest;
    std::size_t fewest = std::max<std::size_t>(1, meant.size() / 3) + 1;
    for (const std::string& name : names) {
        const std::string small = small_letters(name);
        const bool begins = meant.size() > 1 && small.starts_with(meant);
        const std::string last = small.substr(small.rfind('.') + 1);  // of force.stiffness
        const std::size_t changes =
            begins ? 1 : std::min(changes_between(meant, small), changes_between(meant, last));
        if (changes >= std::min(fewest, std::max(meant.size(), small.size()))) continue;
        fewest = changes;
        nearest = name;
    }
    return nearest;
}

std::string use_one_of(std::span<const std::string> names, std::string_view word) {
    std::string text = "use one of ";
    for (const std::string& name : names) {
        if (&name != names.data()) text += ", ";
        text += name;
    }
    const std::string near = nearest_name(word, names);
    return near.empty() ? text : text + " (did you mean " + near + "?)";
}

std::string number_text(double value) {
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "%.6g", value);
    return text.data();
}

void refuse_number(const std::string& title, double value, const std::string& words) {
    throw std::invalid_argument(title + " = " + number_text(value) + ": must be " + words);
}

}  // namespace palpate

// Shared by the mutators: bytes, chance, libFuzzer's own mutations, and mutations of JSON that
// leave it JSON. For sources that libFuzzer calls.
#pragma once

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace palpate::fuzz {

using Bytes = std::vector<std::uint8_t>;
using Random = std::minstd_rand;

inline bool one_in(Random& random, unsigned n) {
    return random() % n == 0;
}

/// A random element; `all` is not empty.
template <class All>
auto& one_of(All& all, Random& random) {
    return all[random() % std::size(all)];
}

/// libFuzzer's own mutations, by which it grows by `room` at most. Bytes or a text.
template <class Text>
void mutate(Text& bytes, std::size_t room) {
    const std::size_t size = bytes.size();
    bytes.resize(std::max<std::size_t>(size + room, 1));
    auto* const data = reinterpret_cast<std::uint8_t*>(bytes.data());
    bytes.resize(LLVMFuzzerMutate(data, size, bytes.size()));
}

/// Numbers at which readers take another branch.
inline constexpr double odd_numbers[] = {0,      -0.0, 1,    -1,    2,     0.5, 1e-30,
                                         1e-300, 9,    100,  255,   65535, 1e5, 1e9,
                                         -1e9,   1e30, 1e38, 1e300, -1e300};

/// A number as text: odd, near the one before, or not one.
inline std::string other_number(const std::string& before, Random& random) {
    switch (random() % 4) {
        case 0:
            return nlohmann::json(one_of(odd_numbers, random)).dump();
        case 1:
            return std::to_string(static_cast<int>(random() % 12) - 2);
        case 2:
            return one_in(random, 2) ? "inf" : one_in(random, 2) ? "-inf" : "nan";
        default:
            std::string text = before;
            mutate(text, 4);
            std::replace_if(
                text.begin(), text.end(), [](char c) { return c == '\n' || c == ','; }, '0');
            return text;
    }
}

/// All values in it, itself included.
inline void collect(nlohmann::json& json, std::vector<nlohmann::json*>& all) {
    all.push_back(&json);
    if (json.is_structured()) {
        for (auto& inner : json) collect(inner, all);
    }
}

/// Changes one value: another number, the opposite, a part of itself less or twice, or a copy of
/// another value.
inline void mutate_json(nlohmann::json& json, Random& random) {
    std::vector<nlohmann::json*> all;
    collect(json, all);
    nlohmann::json& one = *one_of(all, random);
    const nlohmann::json other = *one_of(all, random);
    if (one_in(random, 8)) {
        if (other.size() < 64) one = other;
    } else if (one.is_boolean()) {
        one = !one.get<bool>();
    } else if (one.is_number()) {
        const double odd = one_of(odd_numbers, random);
        one = one_in(random, 2) ? nlohmann::json(odd) : nlohmann::json(int(random() % 12) - 2);
    } else if (one.is_string()) {
        auto text = one.get<std::string>();
        mutate(text, 8);
        one = text;
    } else if (one.is_array() && !one.empty()) {
        const auto at = random() % one.size();
        one_in(random, 2) ? one.erase(at) : (one.push_back(nlohmann::json(one[at])), void());
    } else if (one.is_object() && !one.empty()) {
        auto member = one.begin();
        std::advance(member, random() % one.size());
        one_in(random, 2) ? (void)one.erase(member) : (void)(*member = other);
    } else {
        one = other;
    }
}

/// A text in JSON, with a value of it changed; false if it is none.
inline bool mutate_json_text(std::string& text, Random& random) {
    auto json = nlohmann::json::parse(text, nullptr, false);
    if (json.is_discarded()) return false;
    mutate_json(json, random);
    text = json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    return true;
}

inline std::vector<std::string> lines_of(std::string_view text) {
    std::vector<std::string> lines;
    while (!text.empty()) {
        const auto end = text.find('\n');
        lines.emplace_back(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    return lines;
}

/// The lines as the mutator's result; its size.
inline std::size_t put_lines(const std::vector<std::string>& lines, std::uint8_t* data,
                             std::size_t most) {
    std::string text;
    for (const std::string& line : lines) text += line + '\n';
    text.resize(std::min(text.size(), most));
    std::copy(text.begin(), text.end(), data);
    return text.size();
}

}  // namespace palpate::fuzz

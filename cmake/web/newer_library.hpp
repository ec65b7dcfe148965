// Newer functions of the standard library, which Debian's emscripten (libc++ 13) lacks.
// The toolchain file includes it before every source. Delete it with a newer emscripten.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

static_assert(_LIBCPP_VERSION < 14000, "this libc++ has more: delete what it has");

namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
    return __builtin_bit_cast(To, from);
}

/// 15, 16 or 17 significant digits: the first of these that reads back as the same double. A real
/// to_chars() may need fewer, for example for 5e-324.
inline to_chars_result to_chars(char* first, char* last, double value) {
    char digits[32];
    int size = 0;
    for (int precision = 15; precision <= 17; ++precision) {
        size = snprintf(digits, sizeof digits, "%.*g", precision, value);
        if (strtod(digits, nullptr) == value) break;
    }
    if (last - first < size) return {last, errc::value_too_large};
    return {std::copy(digits, digits + size, first), errc{}};
}
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
    const string text(first, last);
    char* end = nullptr;
    value = strtod(text.c_str(), &end);
    if (end == text.c_str()) return {first, errc::invalid_argument};
    return {first + (end - text.c_str()), errc{}};
}

/// Declared members only: there are no threads.
class jthread {
  public:
    void request_stop() {}
};

namespace ranges {

template <class Range, class Test>
bool any_of(Range&& range, Test test) {
    return std::any_of(std::begin(range), std::end(range), test);
}
template <class Range, class Test>
bool all_of(Range&& range, Test test) {
    return std::all_of(std::begin(range), std::end(range), test);
}
template <class Range, class Test>
bool none_of(Range&& range, Test test) {
    return std::none_of(std::begin(range), std::end(range), test);
}
template <class Range, class Value>
void fill(Range&& range, const Value& value) {
    std::fill(std::begin(range), std::end(range), value);
}
template <class Out>
struct Copied {
    Out out;
};
template <class Range, class Out>
Copied<Out> copy(Range&& range, Out out) {
    return {std::copy(std::begin(range), std::end(range), out)};
}
template <class One, class Other, class Same>
bool equal(const One& one, const Other& other, Same same) {
    return std::equal(std::begin(one), std::end(one), std::begin(other), std::end(other), same);
}
template <class Range, class Out, class Function>
void transform(Range&& range, Out out, Function function) {
    std::transform(std::begin(range), std::end(range), out, function);
}
template <class Range>
void reverse(Range&& range) {
    std::reverse(std::begin(range), std::end(range));
}
template <class Range, class Test, class Value>
void replace_if(Range&& range, Test test, const Value& value) {
    std::replace_if(std::begin(range), std::end(range), test, value);
}
template <class Range, class Old, class New>
void replace(Range&& range, const Old& old, const New& value) {
    std::replace_if(
        std::begin(range), std::end(range), [&](const auto& one) { return one == old; }, value);
}
template <class Range, class Value>
auto find(Range&& range, const Value& value) {
    return std::find(std::begin(range), std::end(range), value);
}

template <class Range, class Test>
auto find_if(Range&& range, Test test) {
    return std::find_if(std::begin(range), std::end(range), test);
}
template <class Range, class Value, class Key>
auto find(Range&& range, const Value& value, Key key) {
    return std::find_if(std::begin(range), std::end(range),
                        [&](const auto& one) { return std::invoke(key, one) == value; });
}

/// By a projection: of two values, that whose member is less comes first.
template <class Key>
auto by(Key key) {
    return
        [key](const auto& a, const auto& b) { return std::invoke(key, a) < std::invoke(key, b); };
}
template <class Range>
void sort(Range&& range) {
    std::sort(std::begin(range), std::end(range));
}
template <class Range, class Key>
void sort(Range&& range, std::initializer_list<int>, Key key) {
    std::sort(std::begin(range), std::end(range), by(key));
}
template <class Range, class Key>
auto min_element(Range&& range, std::initializer_list<int>, Key key) {
    return std::min_element(std::begin(range), std::end(range), by(key));
}

}  // namespace ranges
}  // namespace std

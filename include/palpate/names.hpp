// The names of enumerations and settings, each written once: for files, the command line, messages
// and Python. Messages about unknown names list the known ones and suggest the one that was
// probably meant. A struct of settings has a table below it, with the name, unit, range and purpose
// of each member. The tables of the force, the friction and the device are in settings.hpp.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace palpate {

/// The name that `word` probably stands for: the one that begins with it, or that differs from it,
/// as a whole or behind its last dot, by the fewest missing, added, wrong or swapped letters. Case
/// does not matter. Empty if no name is similar: at most a third of the letters may differ.
std::string nearest_name(std::string_view word, std::span<const std::string> names);

/// The end of a message about a `word` that is not one of the names: "use one of cubic, linear (did
/// you mean linear?)".
std::string use_one_of(std::span<const std::string> names, std::string_view word);

enum class SampleType : std::uint8_t;
enum class Solid : std::uint8_t;
enum class Interpolation : std::uint8_t;
enum class BrushKind : std::uint8_t;
enum class Mode : std::uint8_t;
enum class UpdateStatus : std::uint8_t;
enum class HapticProperty : std::uint8_t;
enum class DeviceStatus : std::uint8_t;
enum class Facing : std::uint8_t;

/// The names of all values in their order from 0, and the kind of value, for messages.
template <std::size_t count>
struct EnumNames {
    const char* kind;
    std::array<const char*, count> names;
};
constexpr auto enum_names(const char* kind, auto... names) {
    return EnumNames<sizeof...(names)>{kind, {names...}};
}

template <class E>
inline constexpr std::nullptr_t names_of{};
template <class E>
concept HasNames = !std::same_as<decltype(names_of<E>), const std::nullptr_t>;

template <>
inline constexpr auto names_of<SampleType> = enum_names("sample type", "uint8", "int16", "uint16",
                                                        "float32");
template <>
inline constexpr auto names_of<Solid> = enum_names("solid side", "above", "below");
template <>
inline constexpr auto names_of<Interpolation> = enum_names("field", "linear", "cubic");
template <>
inline constexpr auto names_of<BrushKind> = enum_names("brush", "carve", "add", "smooth", "paint");
template <>
inline constexpr auto names_of<Mode> = enum_names("mode", "free", "constrained");
template <>
inline constexpr auto names_of<UpdateStatus> = enum_names("status", "done", "out_of_budget",
                                                          "recovering", "refused", "not_finite",
                                                          "waiting");
template <>
inline constexpr auto names_of<HapticProperty> = enum_names("haptic property", "stiffness",
                                                            "static_friction", "dynamic_friction",
                                                            "damping", "viscosity",
                                                            "puncture_force", "drag");
template <>
inline constexpr auto names_of<DeviceStatus> = enum_names("device status", "starting", "ready",
                                                          "uncalibrated", "stale", "lost", "fault",
                                                          "finished");
template <>
inline constexpr auto names_of<Facing> = enum_names("facing", "anterior", "posterior", "left",
                                                    "right", "superior", "inferior");

/// The name of a value, or "unknown" for a number that is none.
template <HasNames E>
constexpr const char* enum_name(E value) {
    const auto number = static_cast<std::size_t>(value);
    return number < names_of<E>.names.size() ? names_of<E>.names[number] : "unknown";
}
template <HasNames E>
std::vector<std::string> all_names() {
    return {names_of<E>.names.begin(), names_of<E>.names.end()};
}
/// The value of this name. Throws std::invalid_argument, listing the names, for another.
template <HasNames E>
E named(std::string_view text) {
    const std::vector<std::string> names = all_names<E>();
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == text) return static_cast<E>(i);
    }
    throw std::invalid_argument(std::string("there is no ") + names_of<E>.kind + " '" +
                                std::string(text) + "': " + use_one_of(names, text));
}

/// The values that a number may have. NaN is in no range.
struct ValueRange {
    double least, most;  ///< both included, except `least` where `open`
    bool open;
    const char* words;  ///< "finite and at least 0"

    constexpr bool has(double value) const {
        return (open ? value > least : value >= least) && value <= most;
    }
};
namespace ranges {
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double greatest = std::numeric_limits<double>::max();
inline constexpr ValueRange any{-infinity, infinity, false, "a number"};
inline constexpr ValueRange finite{-greatest, greatest, false, "finite"};
inline constexpr ValueRange place{-1e60, 1e60, false, "within 1e60"};
inline constexpr ValueRange scale{1e-30, 1e30, false, "from 1e-30 to 1e30"};
inline constexpr ValueRange part{0, 1, false, "from 0 to 1"};
inline constexpr ValueRange not_negative{0, greatest, false, "finite and at least 0"};
inline constexpr ValueRange at_least_1{1, greatest, false, "finite and at least 1"};
inline constexpr ValueRange positive{0, greatest, true, "finite and above 0"};
inline constexpr ValueRange limit{0, infinity, true, "above 0 (inf: none)"};
inline constexpr ValueRange limit_or_zero{0, infinity, false, "at least 0 (inf: none)"};
inline constexpr ValueRange start{0, infinity, false, "at least 0 (inf: start at any)"};
inline constexpr ValueRange rate{1, 1e5, false, "1 to 100000"};
}  // namespace ranges

/// One setting of a struct.
template <class Owner, class Value>
struct Setting {
    Value Owner::*member;
    const char* name;   ///< of the member, and in Python and C
    const char* unit;   ///< "N/mm", or "" without one
    const char* about;  ///< a sentence without its full stop
    ValueRange range = ranges::any;
    const char* title = name;    ///< in messages
    const char* key = name;      ///< in files
    const char* option = "";     ///< of the command line: "--force-limit", or ""
    const char* left_open = "";  ///< the meaning of None in Python, or "" if it cannot be None

    constexpr Setting within(const ValueRange& to) const { return with(&Setting::range, to); }
    constexpr Setting titled(const char* to) const { return with(&Setting::title, to); }
    constexpr Setting in_files(const char* to) const { return with(&Setting::key, to); }
    constexpr Setting as_option(const char* to) const { return with(&Setting::option, to); }
    constexpr Setting if_open(const char* to) const { return with(&Setting::left_open, to); }

  private:
    template <class Part>
    constexpr Setting with(Part Setting::*part, const Part& to) const {
        Setting changed = *this;
        changed.*part = to;
        return changed;
    }
};
template <class Owner, class Value>
constexpr Setting<Owner, Value> setting(Value Owner::*member, const char* name, const char* unit,
                                        const char* about) {
    return {member, name, unit, about};
}

/// The table of a struct: a tuple with a Setting for each member, in the order of files.
template <class T>
inline constexpr std::nullptr_t settings_of{};
/// T has a table.
template <class T>
concept Described = !std::same_as<decltype(settings_of<T>), const std::nullptr_t>;
/// Calls visit(setting) for each setting of T.
template <Described T>
constexpr void for_each_setting(auto&& visit) {
    std::apply([&](const auto&... each) { (visit(each), ...); }, settings_of<T>);
}
/// Calls visit(path, setting, number) for each number of a struct, and of the structs in it, as in
/// "force.magnet.peak" for the path "force". `number` is a reference into `owner`.
template <class Owner>
void for_each_number(const std::string& path, Owner& owner, auto&& visit) {
    for_each_setting<std::remove_const_t<Owner>>([&](const auto& one) {
        auto& value = owner.*one.member;
        using Value = std::remove_cvref_t<decltype(value)>;
        const std::string name = path + "." + one.name;
        if constexpr (Described<Value>) for_each_number(name, value, visit);
        if constexpr (std::same_as<Value, double>) visit(name, one, value);
    });
}

/// To six digits.
std::string number_text(double value);
/// Throws std::invalid_argument: "TITLE = VALUE: must be WORDS".
[[noreturn]] void refuse_number(const std::string& title, double value, const std::string& words);
/// "stiffness [N/mm]", as messages name it.
template <class Owner, class Value>
std::string title_of(const Setting<Owner, Value>& one) {
    return *one.unit == '\0' ? one.title : one.title + std::string(" [") + one.unit + "]";
}
/// Throws refuse_number()'s error for the first number of a struct, also in vectors and structs in
/// it, that is out of its range. Builds no text, so allocates nothing, if all is well.
template <Described T>
void check_ranges(const T& settings) {
    for_each_setting<T>([&](const auto& one) {
        [[maybe_unused]] const auto check = [&](double number) {
            if (!one.range.has(number)) refuse_number(title_of(one), number, one.range.words);
        };
        const auto& value = settings.*one.member;
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (Described<Value>) {
            check_ranges(value);
        } else if constexpr (std::same_as<Value, double>) {
            check(value);
        } else if constexpr (std::same_as<Value, std::optional<double>>) {
            if (value) check(*value);
        } else if constexpr (requires { value.reshaped(); }) {  // of Eigen
            for (const double number : value.reshaped()) check(number);
        }
    });
}

}  // namespace palpate

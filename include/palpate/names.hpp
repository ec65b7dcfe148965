// The names of enumerations, each written once: for files, the command line, messages and Python.
// Messages about unknown names list the known ones and suggest the one that was probably meant.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// The name that `word` probably stands for: the one that begins with it, or that differs from it
/// by the fewest missing, added, wrong or swapped letters (at most a third of them). Case does not
/// matter. Empty if no name is similar.
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

}  // namespace palpate

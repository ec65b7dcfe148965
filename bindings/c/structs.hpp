// Structs of the C interface, which grow from version to version: a caller's may be shorter or
// longer than ours. Conversions of their members to the core's values and back.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "bindings/c/status.hpp"
#include "palpate/names.hpp"
#include "palpate/progress.hpp"
#include "palpate/renderer.hpp"
#include "palpate/run/setup.hpp"

namespace palpate::c {

/// The size that a caller's struct says it has. Throws std::invalid_argument if it cannot be.
template <class T>
std::uint32_t size_of(const T& theirs, const char* name) {
    static_assert(std::is_trivially_copyable_v<T> && offsetof(T, size_of) == 0);
    std::uint32_t size = 0;
    std::memcpy(&size, &theirs, sizeof size);
    if (size < sizeof size || size > 1 << 16) {
        throw std::invalid_argument(std::string(name) + ".size_of is " + std::to_string(size) +
                                    ": declare it with PALPATE_STRUCT");
    }
    return size;
}

/// Calls the caller's progress function, if there is one. Throws Cancelled when it says so.
template <class Options>
OnProgress progress_of(const Options& asked, const char* cancelled) {
    if (!asked.progress) return progress_of_thread();
    return progress_by(asked.progress, asked.context, cancelled);
}

/// One of ours with its size, else 0.
template <class T>
T sized() {
    T ours{};
    ours.size_of = sizeof ours;
    return ours;
}

/// A caller's struct as ours: members that it lacks are 0. Throws std::invalid_argument for a size
/// that cannot be, and for members that we lack and that are not 0.
template <class T>
T taken(const T* theirs, const char* name) {
    const std::uint32_t size = size_of(given(theirs, name), name);
    T ours{};
    std::memcpy(static_cast<void*>(&ours), theirs, std::min<std::size_t>(size, sizeof ours));
    const auto* bytes = reinterpret_cast<const unsigned char*>(theirs);
    if (size > sizeof ours &&
        std::any_of(bytes + sizeof ours, bytes + size, [](unsigned char b) { return b != 0; })) {
        throw std::invalid_argument(std::string(name) +
                                    " has members that this version of libpalpate-c lacks");
    }
    ours.size_of = sizeof ours;
    return ours;
}
/// The same, but null is all defaults.
template <class T>
T taken_or_default(const T* theirs, const char* name) {
    return theirs ? taken(theirs, name) : sized<T>();
}

/// Fills in a caller's struct, as much of it as it has; what we lack becomes 0.
template <class T>
void give(T* theirs, const char* name, T ours) {
    const std::uint32_t size = size_of(given(theirs, name), name);
    ours.size_of = size;
    std::memset(static_cast<void*>(theirs), 0, size);
    std::memcpy(static_cast<void*>(theirs), &ours, std::min<std::size_t>(size, sizeof ours));
}

inline Vec3 vec3(const double* from) {
    return {from[0], from[1], from[2]};
}
inline void put(const Vec3& from, double* to) {
    std::copy_n(from.data(), 3, to);
}
/// Rows; all zeros are the identity.
Mat3 mat3(const double* rows);
void put(const Mat3& from, double* rows);
/// x, y, z, w, made unit; all zeros are the identity.
Quaternion quaternion(const double* xyzw);
void put(const Quaternion& from, double* xyzw);

/// The enumerator of this number. Throws std::invalid_argument for a number of none.
template <HasNames Enum>
Enum one_of(std::int32_t number, const char* name) {
    constexpr auto count = static_cast<std::int32_t>(names_of<Enum>.names.size());
    if (number < 0 || number >= count) {
        throw std::invalid_argument(std::string(name) + " is " + std::to_string(number) +
                                    "; the last one there is is " + std::to_string(count - 1));
    }
    return static_cast<Enum>(number);
}

Geometry geometry_from(const palpate_geometry* geometry);
palpate_geometry geometry_to(const Geometry& geometry);
/// Null is all defaults, here and below.
run::FieldSetup field_setup(const palpate_field_options* options);
/// A level that is worth feeling; nothing for constant data.
std::optional<double> usual_isovalue(const run::LoadedVolume& loaded);
/// Pairs of low and high. Throws std::invalid_argument for null or too many.
std::vector<DensityRange> ranges_from(const double* ranges, std::size_t count);
/// Reads the files of tool and layers.
run::RenderSetup render_setup(const palpate_render_options& options);
DeviceTransform transform_from(const palpate_transform* transform);
palpate_transform transform_to(const DeviceTransform& transform);
palpate_felt felt_from(const Tick& tick);

}  // namespace palpate::c

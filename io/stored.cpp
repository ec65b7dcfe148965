// How files store a sample. See the header.
#include "io/stored.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/words.hpp"

namespace palpate::io {
namespace {

constexpr std::array<std::string_view, 11> stored_names = {"int8",    "uint8",   "int16",  "uint16",
                                                           "int32",   "uint32",  "int64",  "uint64",
                                                           "float16", "float32", "float64"};

/// True where whole numbers are only shifted, and 16 bits hold all that they may become: ImageJ's
/// signed images.
bool shifted_within_int16(Stored stored, const ValueMap& values) {
    if (values.slope != 1 || values.intercept != std::floor(values.intercept)) return false;
    if (is_real(stored)) return false;
    return with_stored(stored, [&](auto type) {
        using From = std::numeric_limits<decltype(type)>;
        using To = std::numeric_limits<std::int16_t>;
        return static_cast<double>(From::lowest()) + values.intercept >= To::lowest() &&
               static_cast<double>(From::max()) + values.intercept <= To::max();
    });
}

void convert_mapped(Stored stored, const std::byte* from, SampleType type, std::byte* to,
                    std::size_t count, const ValueMap& values) {
    with_stored(stored, [&](auto source) {
        with_type(type, [&](auto target) {
            using From = decltype(source);
            for (std::size_t i = 0; i < count; ++i) {
                From number;
                std::memcpy(&number, from + i * sizeof(From), sizeof number);
                const auto value = static_cast<decltype(target)>(
                    static_cast<double>(number) * values.slope + values.intercept);
                std::memcpy(to + i * sizeof value, &value, sizeof value);
            }
        });
    });
}

}  // namespace

std::size_t size_of(Stored stored) {
    return with_stored(stored, [](auto s) { return sizeof s; });
}

bool is_real(Stored stored) {
    return stored == Stored::float16 || stored == Stored::float32 || stored == Stored::float64;
}

std::string name_of(Stored stored) {
    return std::string(stored_names[static_cast<std::size_t>(stored)]);
}

std::optional<Stored> stored_named(std::string_view name) {
    const auto* const found = std::ranges::find(stored_names, name);
    if (found == stored_names.end()) return std::nullopt;
    return static_cast<Stored>(found - stored_names.begin());
}

SampleType kept_as(Stored stored, const ValueMap& values) {
    if (values.changes()) {
        return shifted_within_int16(stored, values) ? SampleType::int16 : SampleType::float32;
    }
    switch (stored) {
        case Stored::uint8:
            return SampleType::uint8;
        case Stored::int8:
        case Stored::int16:
            return SampleType::int16;
        case Stored::uint16:
            return SampleType::uint16;
        default:
            return SampleType::float32;
    }
}

void note_conversion(Stored stored, const ValueMap& values, std::vector<std::string>& notes) {
    if (values.changes()) {
        notes.push_back("the file's slope (" + text_of(values.slope) + ") and intercept (" +
                        text_of(values.intercept) + ") were applied: " + name_of(stored) +
                        " became " + std::string(name_of(kept_as(stored, values))));
        return;
    }
    const std::string kept(name_of(kept_as(stored)));
    if (kept == name_of(stored)) return;
    const bool is_exact = stored == Stored::int8 || stored == Stored::float16;
    notes.push_back("samples of type " + name_of(stored) + " became " + kept +
                    (is_exact ? "" : " (exact to about 7 digits)"));
}

void convert(Stored stored, const std::byte* from, SampleType type, std::byte* to,
             std::size_t count, const ValueMap& values) {
    if (values.changes()) return convert_mapped(stored, from, type, to, count, values);
    if (name_of(stored) == name_of(type)) {
        std::memcpy(to, from, count * size_of(stored));
        return;
    }
    with_stored(stored, [&](auto source) {
        with_type(type, [&](auto target) {
            using From = decltype(source);
            using To = decltype(target);
            for (std::size_t i = 0; i < count; ++i) {
                From value;
                std::memcpy(&value, from + i * sizeof(From), sizeof value);
                const To kept = static_cast<To>(value);
                std::memcpy(to + i * sizeof(To), &kept, sizeof kept);
            }
        });
    });
}

}  // namespace palpate::io

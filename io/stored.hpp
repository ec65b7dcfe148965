// How files store a sample, and its conversion to the type that a volume keeps. Shared by the
// readers in the helper program and those that read by the box. Needs the core only.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::io {

enum class Stored {
    int8,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    int64,
    uint64,
    float16,
    float32,
    float64
};

/// The IEEE number of 16 bits (binary16), for which C++20 has no type.
struct Half {
    std::uint16_t bits = 0;

    operator float() const {
        // Moved to its place in a float, the exponent is 112 too small, which the factor corrects,
        // also for the least numbers, which have none.
        const std::uint32_t moved = (bits & 0x7fffU) << 13;
        const bool is_finite = (bits & 0x7c00U) != 0x7c00U;
        const float size = is_finite ? std::bit_cast<float>(moved) * 0x1p112F
                                     : std::bit_cast<float>(moved | 0x7f800000U);
        return (bits & 0x8000U) == 0 ? size : -size;
    }
};

/// What a stored number means: slope * number + intercept [data units].
struct ValueMap {
    double slope = 1, intercept = 0;
    bool changes() const { return slope != 1 || intercept != 0; }
};

std::size_t size_of(Stored stored);
/// False for whole numbers.
bool is_real(Stored stored);
std::string name_of(Stored stored);
/// The inverse of name_of; nothing for any other name.
std::optional<Stored> stored_named(std::string_view name);
/// The type its samples have in a Volume. Mapped ones are float32, unless whole numbers are only
/// shifted within what int16 holds.
SampleType kept_as(Stored stored, const ValueMap& values = {});
/// Appends a note if that is another type, or if the numbers are mapped.
void note_conversion(Stored stored, const ValueMap& values, std::vector<std::string>& notes);

/// f(T{}) with the C++ type T of a stored sample.
template <class F>
auto with_stored(Stored stored, F&& f) {
    switch (stored) {
        case Stored::int8:
            return f(std::int8_t{});
        case Stored::uint8:
            return f(std::uint8_t{});
        case Stored::int16:
            return f(std::int16_t{});
        case Stored::uint16:
            return f(std::uint16_t{});
        case Stored::int32:
            return f(std::int32_t{});
        case Stored::uint32:
            return f(std::uint32_t{});
        case Stored::int64:
            return f(std::int64_t{});
        case Stored::uint64:
            return f(std::uint64_t{});
        case Stored::float16:
            return f(Half{});
        case Stored::float32:
            return f(float{});
        case Stored::float64:
            break;
    }
    return f(double{});
}

/// Converts `count` samples; `to` has room for them; `type` is what kept_as() says. Mapped values
/// are computed in double precision and rounded once.
void convert(Stored stored, const std::byte* from, SampleType type, std::byte* to,
             std::size_t count, const ValueMap& values = {});

}  // namespace palpate::io

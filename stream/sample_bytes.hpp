// How the bytes of stored pieces become samples of a store. Private to stream/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/stored.hpp"
#include "palpate/samples.hpp"

namespace palpate::stream {

struct SampleBytes {
    io::Stored stored = io::Stored::uint8;
    bool swapped = false;  ///< in the other byte order than the machine's
    io::ValueMap values = {};
    double fill = 0;  ///< of what is not stored [data units]; NaN: it is not finite

    SampleType type() const { return io::kept_as(stored, values); }
    std::size_t size() const { return io::size_of(stored); }
    /// Converts the stored samples of `raw`, which it may change, into `to`, which has room for as
    /// many of type(). Those that are not finite stay.
    void unpack(std::span<std::byte> raw, std::byte* to) const;
};

/// Notes that samples that are not finite, if there can be any, become the least finite one.
void note_finite(const SampleBytes& bytes, std::vector<std::string>& notes);

/// A fill value as the type that is kept has it; NaN if it is not finite, 0 in whole numbers.
double fitting_fill(double fill, const SampleBytes& bytes);

/// Throws std::invalid_argument unless the box is not empty, inside the grid, and `bytes` are those
/// of its samples: a mistake of the caller.
void check_request(const Geometry& grid, const SampleBox& box, SampleType type, std::size_t bytes);

}  // namespace palpate::stream

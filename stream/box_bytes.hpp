// The bytes of boxes of samples, x fastest. Private to stream/.
#pragma once

#include "palpate/samples.hpp"

namespace palpate::stream {

std::uint64_t bytes_of(const SampleBox& box, SampleType type);

/// Copies the part of `from` that lies in `to`; `sample` bytes each.
void copy_box(const SampleBox& from, const std::byte* source, const SampleBox& to,
              std::byte* target, std::size_t sample);

}  // namespace palpate::stream

// Constants that many tests use.
#pragma once

#include <limits>

#include "palpate/volume.hpp"

namespace palpate::support {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double period = 1e-3;  ///< [s] of a tick

inline constexpr SampleType sample_types[] = {SampleType::uint8, SampleType::int16,
                                              SampleType::uint16, SampleType::float32};

}  // namespace palpate::support

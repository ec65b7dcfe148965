// The histogram of a volume, and levels that are likely to be worth feeling.
#pragma once

#include <cstdint>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::run {

struct Histogram {
    double low = 0, high = 0;  ///< [data units] ends of the first and last bin
    std::vector<std::int64_t> counts;
    double mean = 0, deviation = 0;  ///< of the samples [data units]
    bool whole_numbers = false;      ///< each bin holds (high - low) / bins whole numbers
};

/// One pass over the samples.
Histogram histogram_of(const Volume& volume, int bins);

/// Two levels between the three classes that explain most of the variance (Otsu 1979, three
/// classes); fewer for data with fewer values. In CT of a head: skin and bone.
std::vector<double> suggested_isovalues(const Histogram& histogram);

}  // namespace palpate::run

// The histogram of a volume, and levels that are likely to be worth feeling.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::run {

/// The value [data units] of samples that were not measured (outside a scanner's circle, -2000 in
/// many CT). It is the least value, if it lies below 0 and the header says so. Otherwise a
/// thousandth of the samples must have it, a tenth of the others' range below the next value.
std::optional<double> padding_of(const Volume& volume, std::optional<double> header = {},
                                 const OnProgress& progress = {});

struct Histogram {
    double low = 0, high = 0;  ///< [data units] ends of the first and last bin
    std::vector<std::int64_t> counts;
    double mean = 0, deviation = 0;  ///< of the samples [data units]
    bool whole_numbers = false;      ///< each bin holds (high - low) / bins whole numbers
    double greatest = 0;             ///< of the samples. The last bin may end above it
};

/// The histogram of the samples that are not padding.
Histogram histogram_of(const Volume& volume, int bins, std::optional<double> padding = {},
                       const OnProgress& progress = {});

/// The histogram of the gradient's magnitude [data units / mm] at some samples, spread evenly: from
/// 0 to the greatest (to 1 in constant data). It has no mean and no deviation.
Histogram gradients_of(const Volume& volume, int bins);

/// Two levels between the three classes that explain most of the variance (Otsu 1979, three
/// classes). Fewer for data with fewer values. In CT of a head: skin and bone. The best is first.
/// It is the lower one, unless that bounds the material around an object (resin, gel).
std::vector<double> suggested_isovalues(const Histogram& histogram);

}  // namespace palpate::run

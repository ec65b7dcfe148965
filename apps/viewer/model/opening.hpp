// A volume that is ready to be shown and felt.
#pragma once

#include "palpate/filters/dequantize.hpp"
#include "palpate/run/source.hpp"
#include "palpate/run/statistics.hpp"

namespace palpate::viewer {

struct Opened {
    run::LoadedVolume loaded;
    run::Histogram histogram;  ///< of 256 bins, as `palpate info`
    /// What rounding does to its surfaces; nothing where it has no levels, was dequantized, or is a
    /// store.
    std::optional<filters::Terraces> terraces = {};

    /// The grey levels that the file suggests, or those between which nearly all samples lie [data
    /// units].
    double dark() const;
    double bright() const;
};

/// Reads the volume and counts its samples. `progress` may throw to stop. Throws as run::load().
Opened open(const run::Source& source, const io::Progress& progress);

/// The level to begin with: the synthetic volume's own, else the first that the histogram suggests.
/// Throws std::invalid_argument for constant data, in which there is nothing to feel.
double first_isovalue(const Opened& opened);

}  // namespace palpate::viewer

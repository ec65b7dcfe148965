// A volume that is ready to be shown and felt, and how it is made in the background.
#pragma once

#include "apps/live/statistics.hpp"
#include "apps/live/volume_options.hpp"

namespace palpate::viewer {

struct Opened {
    app::VolumeOptions options;
    app::LoadedVolume loaded;
    app::Histogram histogram;  ///< of 256 bins, as `palpate info`

    /// The grey levels between which nearly all samples lie [data units].
    double dark() const;
    double bright() const;
};

/// Reads the volume and counts its samples. `progress` may throw to stop. Throws as app::load().
Opened open(const app::VolumeOptions& options, const io::Progress& progress);

/// The level to begin with: the synthetic volume's own, else the first that the histogram suggests.
/// Throws std::invalid_argument for constant data, in which there is nothing to feel.
double first_isovalue(const Opened& opened);

}  // namespace palpate::viewer

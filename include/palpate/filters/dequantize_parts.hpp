// Dequantization part by part, for volumes that do not fit into memory, with the same bits as
// dequantized(): the facts about the whole volume that it needs, and rounds on a part. See
// docs/dequantize.md.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "palpate/filters/dequantize.hpp"

namespace palpate::filters {

/// The values that occur, ascending. Empty for float samples of more than 65536. Those of a volume
/// are those of its parts together.
std::vector<double> values_of(const Volume& volume, const OnProgress& progress = {});
/// level_of() a volume with these values. `whole_numbers`: its samples are integers.
std::optional<double> level_of(std::span<const double> values, bool whole_numbers);

/// A part of a volume that is in memory.
struct VolumePart {
    const Volume& samples;
    Index3 low;    ///< of the whole volume's samples: the part's first
    Index3 whole;  ///< size of the whole volume [samples]
};

/// A place that counts in the choice of the coarsest step. `step` as in a round.
struct SurfaceSite {
    Index3 at;         ///< in the whole volume
    double slope = 0;  ///< [data units / sample]
    double bend = 0;   ///< bend of the data over a step [data units]
};
/// Those of the whole volume that lie in `core`, at most some 30,000 in all, in the order of the
/// samples. The part has to reach 2 max(step, 1) samples farther than the core, or to the volume's
/// border.
std::vector<SurfaceSite> sites_of(const VolumePart& part, const SampleBox& core, int step);

/// The rounds of a whole volume, and the facts about it that each of them needs.
struct DequantizePlan {
    struct Rounds {
        enum class Way {
            down,  ///< one round, in which only the samples of the next coarser grid move
            stay,
            up  ///< first, samples are interpolated from those of the next coarser grid
        };
        int step = 1;  ///< their grid has the samples whose indices are multiples of it
        int count = 1;
        Way way = Way::stay;
        /// A sample depends on samples up to this distance along each axis [samples].
        int reach() const { return 2 * step * count + (way == Way::up ? 5 * step : 0); }
    };
    double level = 1;                 ///< distance between levels [data units]
    double minimum = 0, maximum = 0;  ///< of the whole volume [data units]
    bool mask = false;                ///< samples of two values
    std::vector<Rounds> rounds;       ///< in their order
};
/// `sites(step)` returns those of the whole volume. It is called until the coarsest step is found.
/// Uses the options rounds and coarsest. Throws std::invalid_argument as dequantized() does.
DequantizePlan plan_of(double level, double minimum, double maximum,
                       const DequantizeOptions& options,
                       const std::function<std::vector<SurfaceSite>(int step)>& sites);

/// Whether a sample is dequantized depends on samples up to this distance along each axis.
inline constexpr int terrace_reach = 2 * 16 + 2;

/// Takes the samples of a part through some rounds, on `threads` threads (0: all cores). `moved`
/// (x fastest, [1/65536 level]) is the distance of each sample from its own value, before and
/// afterwards. It begins as zeros. Samples nearer than terrace_reach and the Rounds::reach() of
/// all these rounds to a border of the part that is not the volume's are wrong afterwards.
void run_rounds(const VolumePart& part, std::span<std::int16_t> moved, const DequantizePlan& plan,
                std::span<const DequantizePlan::Rounds> rounds, int threads);

/// The moved samples, as float32, as dequantized() returns them.
Volume moved_samples(const Volume& volume, std::span<const std::int16_t> moved,
                     const DequantizePlan& plan);

}  // namespace palpate::filters

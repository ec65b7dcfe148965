// Dequantization: removes the terraces that rounding makes in integer data and masks. Uses the
// core, on several threads. See docs/dequantize.md.
#pragma once

#include <optional>
#include <string>

#include "palpate/volume.hpp"

namespace palpate::filters {

/// The distance between the levels of the samples [data units]: the smallest gap between two values
/// that occur. 1 for most integer data, 255 for a mask of 0 and 255, 257 for 8 bits stretched to
/// 16. Nothing for constant data, and for float samples without levels: more than 65536 values, or
/// gaps that are not multiples of the smallest one to 1 % of it. One pass over the samples.
std::optional<double> level_of(const Volume& volume, const OnProgress& progress = {});

/// The most that the coarsest step may be [samples].
inline constexpr int greatest_step = 32;
/// The most rounds of step 1.
inline constexpr int most_rounds = 1000;

/// The effect of rounding on the surfaces of a volume.
struct Terraces {
    double level = 1;   ///< distance between levels [data units]
    bool mask = false;  ///< two values only: every surface is made of stair steps
    /// From three to 65 values, all of them whole numbers from 0 on, as label maps have them. There
    /// is no smooth field below labels.
    bool labels = false;
    /// The part of the surfaces of all isovalues that are terraces: gentle slopes on which the
    /// samples differ from a smooth field by no more than rounding explains. 0 to 1.
    double share = 0;
    /// Mean angle between the normals of that part and those of the smooth field [degrees]. A slope
    /// of g levels per sample gives 12.6 / g (measured on balls, docs/dequantize.md).
    double tilt = 0;

    /// Worth dequantizing.
    bool wide() const { return mask || (share >= 0.5 && !labels); }
    /// Suitable number of rounds: stair steps are higher and need more.
    int rounds() const { return mask ? 160 : 40; }
};
/// From up to 200,000 samples. Nothing for data without levels.
std::optional<Terraces> terraces_of(const Volume& volume, const OnProgress& progress = {});
/// The reason to dequantize a volume with these terraces, in words. Empty if there is none.
std::string reason_to_dequantize(const Terraces& terraces);

struct DequantizeOptions {
    /// Rounds of step 1, 1 to most_rounds. After coarser steps, data other than masks takes a
    /// twentieth of them. Coarser steps have fixed numbers of rounds. More rounds flatten the stair
    /// steps of masks further.
    int rounds = 40;
    /// The coarsest step [samples], a power of two up to greatest_step. Default: the largest up to
    /// 16 over which half of the surfaces are straight to within the rounding; for masks 4.
    std::optional<int> coarsest = std::nullopt;
    /// The distance between levels [data units], > 0. Default: level_of() the volume.
    std::optional<double> level = std::nullopt;
    /// Largest number of threads, at most the number of cores. 0: one per core. The result is
    /// always the same, bit for bit.
    int threads = 0;
    OnProgress progress = {};
};

/// The smoothest samples from which rounding makes the volume's own, as float32: no sample moves by
/// more than half a level, or beyond the volume's range. Samples in bricks without terraces, and
/// data without levels (level_of()), keep their values.
///
/// A round: b = B u, with B the binomial (1 2 1)/4 along each axis; u = 2b - Bb, kept within half a
/// level of the volume's sample. Rounds are done on the grids of every s-th sample, s from 1 to the
/// coarsest step and back. On the way back, a finer grid is first interpolated from the coarser
/// one. Beyond the border, samples are continued as a straight line. 2B - B^2 (Kaiser and Hamming
/// 1977, "twicing" after Tukey) keeps quadratics, so curved surfaces stay where they are. The box
/// is that of Whitaker 2000, "Reducing aliasing artifacts in iso-surfaces of binary volumes", for
/// any number of levels.
///
/// Takes 4 bytes per sample, the result's own, and an eighth of that. The volume is released at the
/// beginning if the caller has moved it here (not if its samples are floats). Throws
/// std::invalid_argument for options out of range, std::bad_alloc.
Volume dequantized(Volume volume, const DequantizeOptions& options = {});

}  // namespace palpate::filters

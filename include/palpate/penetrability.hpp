// Stage 8, penetrability: pressing through (Corenthy et al. 2012, section 5, Eq. 5 and Fig. 7).
// Past a penetration threshold the proxy gives way and the felt isovalue follows the hand inwards,
// and outwards again, so that a whole data set is explored in one stroke.
#pragma once

#include <array>
#include <limits>
#include <span>

#include "palpate/proxy.hpp"

namespace palpate {

/// Densities that may be felt, both ends included [data units].
struct DensityRange {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
};

/// What a penetrability function sees in each constrained tick.
struct Pressing {
    double isovalue;  ///< level felt now [data units]
    double pull;      ///< |SCP - HIP| [device mm]
    Vec3 scp, hip;    ///< [mm, physical]
};
/// A penetrability function: the penetration threshold PT [device mm] at which the surface gives
/// way now; infinity holds for ever. Runs on the servo thread: it must not allocate, lock or throw.
/// A negative or NaN answer counts as 0.
using PenetrabilityFunction = double (*)(const Pressing& pressing, const void* context);

/// When surfaces give way, and which levels may be felt. A plain value, so it can be sent to a
/// running servo thread; switch it between any two ticks.
struct Penetrability {
    static constexpr int most_ranges = 16;

    bool on = false;
    /// PT [device mm] where there is no function: the spring (Eq. 4) never exceeds k PT. What other
    /// effects add (damping on the way in, viscosity) comes on top.
    double threshold = 1;
    PenetrabilityFunction function = nullptr;
    const void* context = nullptr;  ///< given to `function`; must outlive its use
    /// Disjoint and in the order in which the hand meets them (rising; falling for solid below).
    std::array<DensityRange, most_ranges> ranges{};
    int range_count = 1;
};

/// Off: the level felt stays what it is now. Past the last range that is infinity, where nothing
/// is ever felt: set `proxy.isovalue` then.
Penetrability no_penetrability();
/// Threshold: gives way at PT [device mm]; no level outside `minimum` is felt, that is below it, or
/// above it where `solid` is below. Throws std::invalid_argument unless PT >= 0.
Penetrability penetrability_threshold(double threshold, double minimum, Solid solid = Solid::above);
/// Ranges of interest: only these levels are felt; between two of them the proxy is free. Ranges
/// may overlap and come in any order. Throws std::invalid_argument for PT < 0, no range, NaN, low >
/// high or more than 16.
Penetrability penetrability_ranges(double threshold, std::span<const DensityRange> ranges,
                                   Solid solid = Solid::above);

/// Throws std::invalid_argument, saying what is wrong, for a value that is on and was not made by
/// the functions above for this side: PT NaN or below 0, ranges out of order, none, too many.
void check(const Penetrability& penetrability, Solid solid);

/// Applied after a proxy update (Fig. 7): lets the proxy give way and re-levels it. Changes `proxy`
/// (SCP, isovalue, mode) and brings `update` in line. `device_per_volume`: device mm per mm of
/// physical space. Updates that are not `done` pass unchanged.
///
/// With penetrability on, G1 and G2 hold for the level felt at the end of the tick: the stretch
/// that the SCP gives way along is a passage through the solid, reported as StepKind::press. A
/// press that ends between two ranges leaves a free SCP PT away from the HIP; the next update
/// closes up. Past the last range the isovalue is infinity (minus infinity where `solid` is below).
void apply_penetrability(const Penetrability& penetrability, const Field& field,
                         double device_per_volume, Proxy& proxy, ProxyUpdate& update,
                         StepObserver observer = {});

}  // namespace palpate

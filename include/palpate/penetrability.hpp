// Stage 9, penetrability: pressing through surfaces (Corenthy et al. 2012, section 5, Eq. 5 and
// Fig. 7). Beyond a penetration threshold the proxy gives way and the felt isovalue follows the
// hand inwards, and outwards again, so that one press explores all levels of a data set.
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
/// A penetrability function returns the penetration threshold PT [device mm] at which the surface
/// gives way now; at infinity it never does. Called on the servo thread: it must not allocate, lock
/// or throw. A negative or NaN result counts as 0.
using PenetrabilityFunction = double (*)(const Pressing& pressing, const void* context);

/// When surfaces give way, and which levels may be felt. A plain value, so it can be sent to a
/// running servo thread. Switch it between any two ticks.
struct Penetrability {
    static constexpr int most_ranges = 16;

    bool on = false;
    /// PT [device mm] where there is no function. The spring force (Eq. 4) never exceeds k PT;
    /// damping and viscosity are added to it.
    double threshold = 1;
    PenetrabilityFunction function = nullptr;
    const void* context = nullptr;  ///< given to `function`. Must outlive its use
    /// Disjoint and in the order in which the hand meets them (rising; falling for solid below).
    std::array<DensityRange, most_ranges> ranges{};
    int range_count = 1;
};

/// Off: the level felt stays as it is now. Past the last range the level is infinity and nothing is
/// felt. Set `proxy.isovalue` in that case.
Penetrability no_penetrability();
/// Threshold: gives way at PT [device mm]. Levels below `minimum` are not felt, or those above it
/// where `solid` is below. Throws std::invalid_argument unless PT >= 0.
Penetrability penetrability_threshold(double threshold, double minimum, Solid solid = Solid::above);
/// Ranges of interest: only these levels are felt. Between two of them the proxy is free. Ranges
/// may overlap and come in any order. Throws std::invalid_argument for PT < 0, no range, NaN, low >
/// high or more than 16.
Penetrability penetrability_ranges(double threshold, std::span<const DensityRange> ranges,
                                   Solid solid = Solid::above);

/// Throws std::invalid_argument, with the reason, for a value that is on and that the functions
/// above would not make for this side. Reasons are PT NaN or below 0, ranges out of order, and no
/// or too many ranges.
void check(const Penetrability& penetrability, Solid solid);

/// Applied after a proxy update (Fig. 7): moves the proxy where the surface gives way and sets the
/// level felt there. Changes `proxy` (SCP, isovalue, mode) and `update` with it.
/// `device_per_volume`: device mm per mm of physical space. Updates that are not `done` are left
/// unchanged.
///
/// With penetrability on, G1 and G2 hold for the level felt at the end of the tick. When the
/// surface gives way, the SCP passes through the solid (StepKind::press). A press that
/// ends between two ranges leaves a free SCP at a distance of PT from the HIP. The next update
/// closes it. Past the last range the isovalue is infinity (minus infinity where `solid` is below).
void apply_penetrability(const Penetrability& penetrability, const Field& field,
                         double device_per_volume, Proxy& proxy, ProxyUpdate& update,
                         StepObserver observer = {});

}  // namespace palpate

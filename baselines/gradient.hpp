// Baselines: the gradient-based proxy methods that the exact one is compared with. They use the
// public API only and have the form of every ProxyMethod.
#pragma once

#include "palpate/proxy.hpp"

namespace palpate::baselines {

/// Gradient-based iso-surface display (GBID) as the paper describes it (section 2 and Fig. 6): in
/// contact, the constraint plane is taken from the local gradient at the SCP alone and the SCP
/// moves to the HIP's projection on it. No collision detection along the motion: thin walls are
/// missed, and the SCP drifts off the isosurface. No friction; it never recovers, because it does
/// not detect that it is inside.
ProxyUpdate update_gradient(Proxy& proxy, const Field& field, const Vec3& hip,
                            const ProxySettings& settings = {}, StepObserver observer = {});

/// The same with the SCP put back on the isosurface along the gradient after each move (Newton, at
/// most 8 steps): drifts less, but misses thin walls, too.
ProxyUpdate update_gradient_improved(Proxy& proxy, const Field& field, const Vec3& hip,
                                     const ProxySettings& settings = {},
                                     StepObserver observer = {});

}  // namespace palpate::baselines

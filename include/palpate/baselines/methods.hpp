// All proxy methods by their names in the command line, tables and figures, and the method of the
// paper.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/proxy.hpp"

namespace palpate::baselines {

/// The paper's method as published (Fig. 4): it takes the constraint planes of all tetrahedra at
/// the SCP, finds one goal that satisfies all of them, and moves there tetrahedron by tetrahedron.
/// It keeps G1, G2 and G5, but sticks on convex ridges, where it breaks G3. No friction. For
/// comparison. Refuses cubic fields.
ProxyUpdate update_paper(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings = {}, StepObserver observer = {});

struct NamedMethod {
    const char* name;
    ProxyMethod method;
};

/// exact, paper, gradient, gradient-improved; the default first.
std::span<const NamedMethod> methods();
std::vector<std::string> method_names();

/// Throws std::invalid_argument, listing the names, for another.
ProxyMethod method_named(std::string_view name);

}  // namespace palpate::baselines

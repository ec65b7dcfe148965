// What experiments compare: the proxy methods on the linear field, and the exact one on the smooth
// field.
#pragma once

#include <span>
#include <string>

#include "evaluation/subject.hpp"
#include "palpate/proxy.hpp"

namespace palpate::evaluation {

struct Contestant {
    std::string name;  ///< for tables and legends
    ProxyMethod method = nullptr;
    Interpolation interpolation = Interpolation::linear;
};

/// All methods on the linear field by their names, then "smooth": exact on the smooth field.
std::span<const Contestant> contestants();
/// The one of this name; throws std::invalid_argument for another.
const Contestant& contestant(std::string_view name);

/// The subject with the field that the contestant feels.
Subject as_felt_by(const Contestant& contestant, Subject subject);

}  // namespace palpate::evaluation

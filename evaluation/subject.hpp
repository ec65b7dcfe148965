// A volume for an experiment: a scene or a file, with the level that is felt.
#pragma once

#include <string>

#include "palpate/field.hpp"

namespace palpate::evaluation {

struct Subject {
    std::string name;  ///< for tables and legends
    Field field;
    double isovalue = 0;  ///< [data units]
};

/// "synthetic:NAME[:WxHxD]" or a file or folder, "@ISOVALUE" behind it: "head.nrrd@500",
/// "synthetic:cylinder@53%". The level may be left out where the scene has its own.
/// Throws std::invalid_argument (no level, no such scene) and io::InputError.
Subject subject_from(const std::string& text);

}  // namespace palpate::evaluation

// A volume for an experiment: a synthetic one, a real one from the data folder, or one that the
// user chose.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "palpate/field.hpp"

namespace palpate::evaluation {

struct Subject {
    std::string name;  ///< for tables and legends
    Field field;
    double isovalue = 0;  ///< [data units]
    /// The analytic density [data units] at a physical point [mm]; empty where there is none.
    std::function<double(const Vec3& physical)> exact = {};
    std::string note = {};  ///< what it stands for, if it stands in for another
};

/// "synthetic:NAME[:WxHxD]" or a file or folder, "@ISOVALUE" behind it: "head.nrrd@500",
/// "synthetic:cylinder@53%". The level may be left out where the scene has its own.
/// Throws std::invalid_argument (no level, no such scene) and io::InputError.
Subject subject_from(const std::string& text);

/// A scene at its own level, or at one in the data's units.
Subject synthetic(const std::string& specification, std::optional<double> isovalue = {},
                  std::optional<SampleType> type = {});

/// A real volume by its name, with the level that is felt there: lobster, daisy-pollen, orange,
/// ct-head, visible-human, neuron, engine, bonsai, iguana. Nothing if the folder lacks the file.
std::optional<Subject> real(const std::filesystem::path& data, std::string_view name);

}  // namespace palpate::evaluation

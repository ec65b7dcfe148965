// Writes an experiment's result for the Python package palpate.evaluate, which makes pages of it:
// NAME.csv, figures as SVG, and NAME.json with the rest.
#pragma once

#include <filesystem>
#include <string>

#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

/// Files go into `folder`, which exists. Throws io::OutputError.
void write_files(const std::string& name, const Result& result,
                 const std::filesystem::path& folder);

}  // namespace palpate::evaluation

// Writes an experiment's result: NAME.csv, NAME.md, figures as SVG and PNG, pictures; and the
// results of several experiments as one HTML file with everything inside.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

struct Report {
    Experiment experiment;
    Result result;
    std::string circumstances;  ///< machine, date, seed, full or quick
};

/// Files go into `folder`, which exists. Throws io::OutputError.
void write_files(const Report& report, const std::filesystem::path& folder);

/// `folder` is where write_files() put the figures; they are embedded in the page. Throws
/// io::OutputError.
void write_html(const std::vector<Report>& reports, const std::filesystem::path& folder,
                const std::filesystem::path& page);

}  // namespace palpate::evaluation

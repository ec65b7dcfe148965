// The interface of an experiment: options in; a table, figures, a paragraph and checked claims out.
// One experiment is one folder; all are listed here.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "evaluation/figure.hpp"
#include "evaluation/subject.hpp"
#include "evaluation/table.hpp"

namespace palpate::evaluation {

/// Of the guarantees G1 and G2 (proxy.hpp), relative to the field's range: how far an SCP may be in
/// the solid, and what counts as on the isosurface.
inline constexpr double granted = 1e-9;

/// What the user chose.
struct Options {
    /// Seconds instead of minutes: fewer and smaller cases, but every claim is checked.
    bool quick = false;
    std::uint64_t seed = 1;
    std::string method = "exact";   ///< for an experiment that shows one method
    std::vector<Subject> subjects;  ///< instead of the experiment's own volumes
    std::filesystem::path data;     ///< folder with the real volumes; empty: there is none
    /// Called with the part that is done, 0 to 1. May throw to stop.
    std::function<void(double)> progress = [](double) {};
    /// One line for the user about something that was left out.
    std::function<void(const std::string&)> note = [](const std::string&) {};
};

/// A statement that the run checks. It never depends on how fast the machine is.
struct Claim {
    std::string statement;
    bool held = false;
    std::string measured;  ///< the number behind it: "largest 3.1e-15 over 5,000,000 updates"
};

struct Result {
    Table table;
    Table summary;  ///< the main numbers side by side, shown in the page; may be empty
    std::vector<Figure> figures;  ///< the first is the experiment's figure
    std::string paragraph;        ///< what was done and what came out, with the figures' numbers
    std::vector<Claim> claims;
};

struct Experiment {
    const char* name;
    Result (*run)(const Options& options);
};

/// Those that are not in Python yet (bindings/python/palpate/evaluate).
std::span<const Experiment> experiments();

// Each is in the folder of its name. They throw std::invalid_argument for options that make no
// sense.
Result scaling(const Options& options);
Result streaming(const Options& options);

}  // namespace palpate::evaluation

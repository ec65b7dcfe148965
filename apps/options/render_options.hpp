// The options that say how to render: proxy method, penetrability, force.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/run/setup.hpp"

namespace palpate::app {

struct RenderOptions {
    /// Everything but penetrability, whose options come in any order: take setup().
    run::RenderSetup given;
    enum class Penetrability { off, threshold, ranges } penetrability = Penetrability::off;
    std::optional<double> threshold;  ///< PT [device mm]
    std::optional<io::Level> minimum;
    std::vector<run::LevelRange> ranges;
    std::string labels;  ///< the name of a label volume

    /// `memory`: where the limit of the program [bytes] will be when the options are read. It
    /// belongs to an option that was added before.
    void add_to(CLI::App& command, const std::optional<std::uint64_t>& memory);
    /// What it reads: layers, labels and a tool, each a file, a name, or empty.
    std::vector<std::string> inputs() const { return {layers_, labels, tool_}; }
    /// Once the command line has been read; reads the label volume. Throws std::invalid_argument
    /// for an option that makes no sense without another, io::InputError for a volume that cannot
    /// be read. Warns on standard error of options that do nothing.
    run::RenderSetup setup() const;
    /// Options whose values named() puts into the settings of a session.
    std::vector<std::string> named_options() const;
    /// Puts the values that the command line names into settings from elsewhere.
    std::function<void(RendererSettings&)> named() const;
    /// The same as setup() for rendering offline: labels lie beside this volume. A run sees to that
    /// itself.
    run::RenderSetup setup_in(const run::LoadedVolume& volume) const;

  private:
    void add_penetrability_to(CLI::App& command);
    void add_force_to(CLI::App& command);

    const CLI::App* command_ = nullptr;
    const std::optional<std::uint64_t>* memory_ = nullptr;
    std::string layers_, tool_;
};

/// "0.5,0.3" as static and dynamic coefficient; "0.5": both. Throws std::invalid_argument, naming
/// `what` (the option or command).
Friction friction_from(const std::string& what, const std::string& text);
/// "LOW:HIGH", each a level (io::level_from_text). Throws std::invalid_argument.
run::LevelRange range_from(const std::string& text);

}  // namespace palpate::app

// The options that say what to feel and which level and side of it is the surface.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>

#include "apps/options/no_effect.hpp"
#include "palpate/run/setup.hpp"
#include "palpate/run/source.hpp"

namespace palpate::app {

struct SourceOptions {
    /// The texts given, under the names that run::source_from() takes: VOLUME is "volume".
    std::map<std::string, std::string> texts;
    std::optional<int> frame;
    std::optional<double> frame_interval;  ///< [s]
    int smooth = 0;
    bool prefilter = false;
    int dequantize = 0;                   ///< rounds
    std::optional<std::uint64_t> memory;  ///< [bytes] of the process; given: read as it is felt
    bool coarse_first = false;
    bool all_times = false;
    std::string cache_folder;
    bool forbidden_is_missing = false;
    std::uint64_t cache_bytes = std::uint64_t{4} << 30;
    bool quiet = false;

    /// What a command does with a store.
    enum class For { touching, description, surfaces, conversion };

    /// Declares VOLUME and its options on a command. An `optional` VOLUME has a default.
    void add_to(CLI::App& command, For purpose = For::touching, bool optional = false);
    /// VOLUME; empty where it was not given and has no default.
    std::string& volume() { return texts["volume"]; }
    const std::string& name() const { return texts.at("volume"); }
    bool has_level() const { return texts.contains("level") && !texts.at("level").empty(); }
    /// Once the command line has been read. Throws std::invalid_argument.
    run::Source source() const;
    /// Warn on standard error of options that do nothing for this source or volume. The latter
    /// also knows the options of playback (RunOptions).
    void warn_of_no_effect(const run::Source& source) const;
    void warn_of_no_effect(const run::LoadedVolume& volume) const;

  private:
    void add_store_options(CLI::App& command);

    const CLI::App* command_ = nullptr;
    For purpose_ = For::touching;
};

/// --isovalue, --solid, --field and --background.
void add_field_options(CLI::App& command, run::FieldSetup& field);
/// All but --isovalue, for a command that takes several.
void add_side_options(CLI::App& command, run::FieldSetup& field);

/// The isovalue asked for, else the synthetic volume's own; std::invalid_argument if there is none.
/// Prints a warning on standard error where there is nothing to feel at it.
double required_isovalue(const run::LoadedVolume& loaded, const Field& field,
                         const run::FieldSetup& setup);
/// With layers, their outermost level; warns where their numbers are not in the data's unit. With
/// ranges of interest no isovalue is required: they set the level.
double required_isovalue(const run::LoadedVolume& loaded, const Field& field,
                         const run::FieldSetup& setup, const run::RenderSetup& render);
/// The same, but of a file without --isovalue the first level that its histogram suggests.
double suggested_isovalue(const run::LoadedVolume& loaded, const Field& field,
                          const run::FieldSetup& setup);
/// run::layers_warning() on standard error.
void warn_of_layers(const io::LayersFile& layers, const run::LoadedVolume& loaded);
/// The warning alone.
void warn_of_isovalue(const Field& field, double isovalue);

}  // namespace palpate::app

// The part that all demos share: a simulated hand touches a volume offline, and a folder gets
// pictures and a report.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/options/render_options.hpp"
#include "apps/options/source_options.hpp"
#include "palpate/run/offline.hpp"
#include "palpate/scenes/motions.hpp"
#include "pictures/scene.hpp"

namespace palpate::app {

struct DemoOptions {
    SourceOptions source;
    run::FieldSetup field;
    RenderOptions render;
    std::string motion;
    scenes::MotionSettings hand;
    int picture_width;                 ///< [pixels]
    std::string output;                ///< folder
    std::vector<std::string> results;  ///< names of files in it, besides those of every demo

    /// All names.
    std::vector<std::string> all_results() const;
};

/// All but the motion and its length, which add_motion_options() adds. The help shows the defaults
/// of options that are added after these.
void add_demo_options(CLI::App& command, DemoOptions& options);
/// --motion and --duration.
void add_motion_options(CLI::App& command, DemoOptions& options);

/// What is felt, and what came of it.
struct Demo {
    run::LoadedVolume loaded;
    Field field;
    double isovalue;
    std::string hand = {};  ///< what the hand is and does, to begin a sentence with
    io::Trajectory trajectory = {};
    run::RenderSetup render = {};
    /// As run::OfflineSinks::change; empty: the data do not change, and path.csv is written.
    std::function<void(Renderer&, std::int64_t tick)> change = {};
    /// Called after each tick; may be empty.
    std::function<void(const Renderer&, const io::TraceRow&)> after = {};
    std::vector<io::TraceRow> rows = {};
    run::OfflineSummary summary = {};
};

/// Loads the volume and chooses the level. Throws std::invalid_argument if a result would replace
/// an input, or if there is nothing to touch.
Demo load_demo(const DemoOptions& options);
/// The motion that the options name, over the field of the demo.
io::Trajectory motion_of(const Demo& demo, const DemoOptions& options);

/// The picture of the report: a file, what it shows, and what its colours mean.
struct DemoPicture {
    const char *file, *shows, *legend;
    /// Makes the file in the folder. io::OutputError is a note: the demo goes on without it.
    std::function<void(const std::filesystem::path& folder)> draw;
};
/// An empty scene for it.
pictures::PictureScene scene_of(const Demo& demo, const DemoOptions& options);

/// Feels, draws and reports; `more` adds files of its own to the results.
void run_demo(Demo& demo, const DemoOptions& options, const DemoPicture& picture,
              const std::function<void(const std::filesystem::path& folder)>& more = {});

}  // namespace palpate::app

// The options of a live session, and what they make: device, session, head of a recording.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "apps/live/render_options.hpp"
#include "apps/live/volume_options.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/io/frame_loader.hpp"
#include "palpate/io/recording.hpp"
#include "palpate/session.hpp"

namespace palpate::app {

struct TouchOptions {
    VolumeOptions volume;
    FieldOptions field;
    RenderOptions render;
    std::string device = "simulated";
    std::string facing = "anterior";
    std::string clutch = "auto", deadman = "none";  ///< a button's number from 1, none, auto
    std::string record, commands;
    double seconds = 0;             ///< 0: until the hand has finished or the session is stopped
    std::string brush;              ///< as the command's words: "carve 3", empty: none
    std::string save;               ///< file for the edited volume; empty: none
    double playback = 1;            ///< speed at which a sequence is played from the start
    bool once = false;              ///< a sequence stops at its end
    int sequence_memory_mb = 1024;  ///< for its frames
    bool json = false;
    bool normal_priority = false;
    /// Options that were given; the rest is what the device is rated for.
    bool limit_given = false, stiffness_given = false, scale_given = false, budget_given = false,
         device_given = false;

    /// `record` has --output in place of --record; `view` can do without a volume, and has nothing
    /// for scripts (--commands, --seconds, --json).
    enum class For { touch, record, view };
    void add_to(CLI::App& command, For purpose);
    /// To be called when the command line has been read.
    void finish(const CLI::App& command);

    io::LoaderSettings loader() const;

  private:
    void add_script_options(CLI::App& command);
    void add_data_options(CLI::App& command);
};

/// What a session is made of.
struct LiveScene {
    LoadedVolume loaded;
    Field field;
    double isovalue;
    std::unique_ptr<Device> device;
    DeviceInfo info;  ///< of the device when it was opened
    Session session;
};

/// Opens the device and fits it to the volume. Throws std::invalid_argument, io::InputError (a
/// hand's file), devices::DeviceError.
LiveScene make_scene(LoadedVolume loaded, const TouchOptions& options);

/// Puts into a recording what its session begins with. Waits where the queue is full: nobody else
/// may be using it yet.
void tell(io::RecordingWriter& recording, const std::vector<Command>& commands);

/// What a recording has to say of a session that is about to begin.
io::RecordingHead recording_head(const Session& session, const DeviceInfo& device,
                                 const TouchOptions& options);

}  // namespace palpate::app

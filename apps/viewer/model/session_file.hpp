// A session in a file: what was opened, how it was felt and how it was looked at, to go on another
// day. JSON; the format is in docs/session_files.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/live/volume_options.hpp"
#include "apps/viewer/model/look.hpp"
#include "palpate/renderer.hpp"

namespace palpate::viewer {

struct SessionFile {
    /// Only what says which volume it is and how it is read; `quiet` is not kept.
    app::VolumeOptions volume;
    Solid solid = Solid::above;
    std::optional<double> background;  ///< [data units] unless it is the usual one
    double isovalue = 0;               ///< [data units] finite
    std::string device = "simulated";  ///< as for --device, options and all
    std::string method = "exact";      ///< of the proxy, by name
    /// `method` goes with the name above when it is read, and is not looked at when it is written;
    /// a penetrability function is code and cannot be kept. Nothing: what suits device and volume.
    std::optional<RendererSettings> settings;
    Look look;
    std::optional<pictures::Camera> camera;  ///< nothing: the whole volume
    std::optional<Vec3> crosshair;           ///< [mm, physical]; nothing: the middle
    bool follow = true;                      ///< the crosshair goes with the hand
    double window_low = 0, window_high = 0;  ///< [data units] grey levels; equal: the usual ones
    bool slices_shown = true;                ///< the panes
};

/// Reads a session. A name of a volume that is relative counts from the session's folder.
/// Members that this version does not know are passed over, those that are missing have their
/// defaults, but for the format, the volume and the isovalue. Throws io::InputError, one line that
/// names the file and the member: no session, of a later version, damaged, or with values that
/// cannot be used.
SessionFile read_session(const std::filesystem::path& path);

/// Writes a session, whole or not at all. A volume that lies below the session's folder is named
/// relative to it, so that both can be moved together; any other by its whole path. Throws
/// io::OutputError; and std::invalid_argument for values that read_session would refuse.
void write_session(const std::filesystem::path& path, const SessionFile& session);

}  // namespace palpate::viewer

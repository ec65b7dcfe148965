// Session files: the volume, the settings of touch and the look, to continue another day. JSON; the
// format is in docs/session_files.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/run/setup.hpp"

namespace palpate::viewer {

struct SessionHand {
    devices::DeviceChoice device{"simulated", {}};
    double isovalue = 0;  ///< [data units] finite
    /// `settings->method` is that of the session when it is read, and ignored when it is written; a
    /// penetrability function is code and is not kept. Layers by label lack their places when they
    /// are read: run::with_labels(). Nothing: the defaults for device and volume.
    std::optional<RendererSettings> settings = {};
};

/// With the first hand.
struct SessionFile : SessionHand {
    run::Source source;
    Solid solid = Solid::above;
    Interpolation interpolation = Interpolation::cubic;
    std::optional<double> background;  ///< [data units] nothing: the usual one
    baselines::NamedMethod method = baselines::methods().front();
    run::Buttons buttons;             ///< of every device
    std::vector<SessionHand> others;  ///< beside the first
    Look look;
    std::optional<run::Source> overlay;      ///< a label map or image over the volume
    std::optional<pictures::Camera> camera;  ///< nothing: one that shows the whole volume
    std::optional<Vec3> crosshair;           ///< [mm, physical]; nothing: the middle
    bool follow = true;                      ///< the crosshair follows the hand
    double window_low = 0, window_high = 0;  ///< [data units] grey levels; equal: the usual ones
    bool slices_shown = true;                ///< the panes
    std::vector<Measurement> measurements;   ///< complete ones
};

/// Reads a session. A name of a volume that is relative counts from the session's folder.
/// Unknown members are ignored, missing ones have their defaults, except the format, the volume and
/// the isovalue, which are needed. Throws io::InputError, one line that
/// names the file and the member: no session, of a later version, damaged, or with values that
/// cannot be used.
SessionFile read_session(const std::filesystem::path& path);
/// The same in two steps: the text of a file that is not too large for a session, and the session
/// in it.
std::string session_text(const std::filesystem::path& path, const OnProgress& progress = {});
SessionFile session_from(const std::string& text, const std::filesystem::path& path);

/// Writes a session, whole or not at all. A volume that lies below the session's folder is named
/// relative to it, so that both can be moved together; any other by its whole path. So does the
/// label volume of layers by label, whose places are not in the file. Throws
/// io::OutputError; and std::invalid_argument for values that read_session would refuse.
void write_session(const std::filesystem::path& path, const SessionFile& session);

}  // namespace palpate::viewer

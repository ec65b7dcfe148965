// The settings of a run: level and solid side, rendering of forces, and the device. One plain
// value. Missing values depend on volume and device, and are filled in when these are known.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "palpate/baselines/methods.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/io/frame_loader.hpp"
#include "palpate/io/layers_file.hpp"
#include "palpate/io/level.hpp"
#include "palpate/io/tool_file.hpp"
#include "palpate/progress.hpp"
#include "palpate/run/source.hpp"
#include "palpate/session.hpp"
#include "palpate/settings.hpp"

namespace palpate::run {

struct FieldSetup {
    Solid solid = Solid::above;
    std::optional<io::Level> background;  ///< outside the data. Nothing: the default of Field
    std::optional<io::Level> isovalue;    ///< nothing: the volume's own or a suggested one
    /// Nothing: cubic, or linear for the methods that were made for it (paper and the gradients).
    std::optional<Interpolation> interpolation;
};

struct ThresholdSetup {
    double threshold = 1;              ///< PT [device mm]
    std::optional<io::Level> minimum;  ///< lowest level that is touched. Nothing: the isovalue
};
struct LevelRange {
    io::Level low, high;
};
struct RangesSetup {
    double threshold = 1;  ///< PT [device mm]
    std::vector<LevelRange> ranges;
};
/// Pressing through surfaces: not at all, beyond a threshold, or from range to range.
using PenetrabilitySetup = std::variant<std::monostate, ThresholdSetup, RangesSetup>;

struct RenderSetup {
    baselines::NamedMethod method = baselines::methods().front();
    PenetrabilitySetup penetrability;
    std::optional<io::LayersFile> layers;
    io::ToolSpec tool;                   ///< a point
    std::optional<double> tool_spacing;  ///< of its points [mm]. Nothing: half a voxel
    std::optional<Friction> friction;
    ForceSettings force;          ///< `limit` and `stiffness` only where the next two are absent
    std::optional<double> limit;  ///< [N] nothing: the device's
    std::optional<double>
        stiffness;  ///< [N/mm] nothing: the default, or the device's rated one if that is less
    std::optional<int> step_budget;  ///< nothing: ProxySettings', less above 1 kHz
    std::optional<double> scale;     ///< physical mm per device mm. Nothing: fits the workspace
    std::optional<double> rate;      ///< [Hz] nothing: rate_of()
};

/// Default rate of the loop [Hz].
inline constexpr double usual_rate = 1000;
/// Rate of the loop with this device [Hz]: the requested one, else the default. The default is 250
/// with a device that renders no force, which needs a quarter of the work (springs up to 1.2 N/mm).
double rate_of(const RenderSetup& setup, const DeviceInfo& device);

/// A button of the device, by its number from 1.
struct Button {
    int number = 1;
    bool operator==(const Button&) const = default;
};
/// The default of its purpose. The clutch is the second button, or the first if it is the only one.
/// There is no dead-man button.
struct UsualButton {
    bool operator==(const UsualButton&) const = default;
};
/// Nothing (monostate): no button.
using ButtonSetup = std::variant<std::monostate, UsualButton, Button>;
/// The text is "auto" (UsualButton), "none" or a number from 1 to 32. Throws std::invalid_argument
/// for other texts. The message begins with the purpose.
ButtonSetup button_from(const std::string& purpose, const std::string& text);
/// The inverse of button_from().
std::string text_of(const ButtonSetup& button);

/// The purposes of the device's buttons.
struct Buttons {
    ButtonSetup clutch = UsualButton{};
    ButtonSetup deadman;
    bool operator==(const Buttons&) const = default;
};

struct PlaybackSetup {
    double speed = 1;           ///< of a sequence, from the start. 0: paused
    io::LoaderSettings loader;  ///< memory for frames, and whether the sequence loops
};

/// Opens the device of this name. Throws as devices::open_device() does.
using OpenDevice = std::function<std::unique_ptr<Device>(const devices::DeviceChoice& choice,
                                                         const devices::DeviceScene& scene)>;

struct Setup {
    FieldSetup field;
    RenderSetup render;
    devices::DeviceChoice device{"simulated", {}};
    OpenDevice open_device = &devices::open_device;  ///< an application may have its own devices
    Facing facing = Facing::anterior;
    Buttons buttons;
    SessionSettings session;  ///< except for its bits of buttons, which follow from `buttons`
    PlaybackSetup playback;
    bool real_time = true;  ///< ask for real-time priority
};

/// The forces of a live run begin when the computed force is below this [N]: a tenth of the limit
/// of the smallest devices. Setups for live runs use it as `force.start_below`.
inline constexpr double live_start_below = 0.3;

/// Field of these samples. If the setup has no interpolation, the method decides. Throws
/// std::invalid_argument as Field does.
Field make_field(std::shared_ptr<const Samples> samples, const FieldSetup& setup,
                 ProxyMethod method = &update_exact);
Field make_field(const Volume& volume, const FieldSetup& setup, ProxyMethod method = &update_exact);

/// The requested level, else the volume's own, else the first that the histogram suggests. Throws
/// std::invalid_argument for constant data without a level.
double isovalue_of(const LoadedVolume& loaded, const FieldSetup& setup,
                   const OnProgress& progress = {});
/// The same, but with layers their outermost level. Throws std::invalid_argument if an isovalue is
/// requested as well.
double isovalue_of(const LoadedVolume& loaded, const Setup& setup, const OnProgress& progress = {});

/// A warning if there is nothing to touch at this level, or if all of space outside the data is
/// solid (palpate::isovalue_warning()). Otherwise empty.
std::string level_warning(const Field& field, double isovalue);
/// A warning if the volume does not declare the units of these layers, or has no densities at some
/// of their levels, or if their label volume may lie elsewhere (warning_beside()). Otherwise empty.
std::string layers_warning(const io::LayersFile& layers, const LoadedVolume& loaded);

/// The requested settings. `isovalue` is the lowest level that is touched if no minimum is given,
/// `limits` are the device's: springs have to be stable at its rate and at the requested one.
/// Without a device, only the requested rate counts. Throws std::invalid_argument, through check(),
/// for settings that cannot be rendered. Here and below, the tool may take seconds, and exceptions
/// of `progress` are passed on.
RendererSettings render_settings(const RenderSetup& setup, const Field& field, double isovalue,
                                 const std::optional<DeviceLimits>& limits = {},
                                 const OnProgress& progress = {});
/// The same for rendering without a device: only the requested force limit applies, and no time
/// between two positions counts as a pause.
RendererSettings offline_settings(const RenderSetup& setup, const Field& field, double isovalue,
                                  const OnProgress& progress = {});

/// The transform that places the device's workspace in the volume.
DeviceTransform transform_for(const Geometry& geometry, const DeviceInfo& info, const Setup& setup);
/// A session for this device: `setup` with the device's limits, stiffness and buttons. Throws
/// std::invalid_argument for a button that the device does not have.
Session make_session(const Field& field, double isovalue, const DeviceInfo& info,
                     const Setup& setup, const OnProgress& progress = {});

/// The method of this name. Throws std::invalid_argument, listing the names, for another.
baselines::NamedMethod named_method(std::string_view name);

/// "haply:port=10001", the inverse of devices::parse_device().
std::string text_of(const devices::DeviceChoice& choice);

}  // namespace palpate::run

namespace palpate {

template <>
inline constexpr auto settings_of<run::Buttons> =
    std::tuple{setting(&run::Buttons::clutch, "clutch", "",
                       "Button that attaches the volume to the hand: 1, 2, ... or none")
                   .as_option("--clutch")
                   .if_open("2, or 1 on devices with one button"),
               setting(&run::Buttons::deadman, "deadman", "",
                       "Button that must be held for any force: 1, 2, ... or none")
                   .in_files("dead-man")
                   .as_option("--dead-man")
                   .if_open("none")};

}  // namespace palpate

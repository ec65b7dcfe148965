// Stage 10, renderer: one call renders a tick, from the device's state to proxy and force. A
// renderer is a value that can be copied. render() does not allocate, lock, do I/O, read clocks or
// throw.
#pragma once

#include <memory>

#include "palpate/layers.hpp"
#include "palpate/names.hpp"
#include "palpate/tool_proxy.hpp"

namespace palpate {

/// The place of the device's workspace in the volume's physical space:
/// physical = translation + scale * rotation * device.
struct DeviceTransform {
    Mat3 rotation = Mat3::Identity();  ///< orthonormal, not mirrored, device axes to physical axes
    Vec3 translation = Vec3::Zero();   ///< [mm, physical] where the device's origin lies
    double scale = 1;                  ///< physical mm per device mm, > 0
};
template <>
inline constexpr auto settings_of<DeviceTransform> =
    std::tuple{setting(&DeviceTransform::rotation, "rotation", "",
                       "Orthonormal, device axes to physical axes, (3, 3)"),
               setting(&DeviceTransform::translation, "translation", "mm, physical",
                       "Where the device's origin lies")
                   .within(ranges::place),
               setting(&DeviceTransform::scale, "scale", "", "Physical mm per mm of hand, above 0")
                   .within(ranges::scale)};
Vec3 physical_from_device(const DeviceTransform& transform, const Vec3& device);
Vec3 device_from_physical(const DeviceTransform& transform, const Vec3& physical);

/// The device's input to a tick.
struct TickInput {
    double time = 0;               ///< [s], strictly increasing
    Vec3 position = Vec3::Zero();  ///< [device mm], device axes
    bool valid = true;             ///< false: stale or broken input. No force, proxy stays
    bool armed = true;             ///< false: a dead-man switch is open. No force at once
    bool released = false;         ///< true: no force, see ForceInput::released
    /// Unit, device axes, from the hand to the tool's tip. Zero: not known.
    Vec3 pointing = Vec3::Zero();
    Mat3 orientation = Mat3::Identity();  ///< tool axes to device axes; used with a tool
};

struct RendererSettings {
    ProxyMethod method = &update_exact;
    ProxySettings proxy;
    Penetrability penetrability;
    /// Layers replace penetrability, friction and force by their own values. Layers without
    /// surfaces leave penetrability as it is.
    std::shared_ptr<const Layers> layers;
    /// A tool touches with all its points, in six degrees of freedom, on the smooth field and with
    /// the method exact. Null: a point. With a tool there are no layers, penetrability, magnet and
    /// texture.
    std::shared_ptr<const Tool> tool;
    ForceSettings force;
    DeviceLimits device;
    DeviceTransform transform;
    bool forces_on = true;
};

/// The complete state between two ticks. Settings may be replaced between ticks, after check(). For
/// another level, call use_isovalue(). Set `force.changed` with every change of the contact.
struct Renderer {
    Field field;  ///< of the samples
    RendererSettings settings;
    Proxy proxy;
    ForceState force;
    LayerState layers = {};
    /// [data units] The isovalue to return to when layers with surfaces are removed. Set while
    /// there are such layers.
    std::optional<double> isovalue_without_layers = {};
    /// The tool's proxy, for the level `proxy.isovalue`. It has a value if there is a tool, or if
    /// make_room_for_tools() was called.
    std::optional<ToolProxy> tool_proxy = {};
    /// The proxy was placed in the solid and has not been outside since: it is on no side of a
    /// surface, and starts anew where it would have to wait for samples.
    bool starts_inside = false;
    /// The point of the surface to which the magnet pulls [mm, physical]; in contact, the SCP.
    std::optional<Vec3> drawn_to = {};
};

/// The field that the proxy touches: that of the samples or, with layers by label, the one that
/// contains the labels. The proxy lies on its lattice.
inline const Field& felt_field(const Renderer& renderer) {
    return renderer.layers.covered ? *renderer.layers.covered : renderer.field;
}

/// A monotonic clock [ns], given by the caller. The renderer has none of its own.
using Clock = std::int64_t (*)() noexcept;

/// The result of a tick with a tool, in addition to the positions of its reference point
/// (Tick::proxy).
struct ToolFelt {
    Quaternion hand = Quaternion::Identity();   ///< tool axes to physical axes
    Quaternion proxy = Quaternion::Identity();  ///< the same of the proxy
    int contacts = 0;                           ///< how many points hold the proxy
};

/// The result of one tick.
struct Tick {
    double time = 0;                ///< [s]
    ProxyUpdate proxy;              ///< HIP, SCP, mode, density, isovalue, ... in physical space
    Vec3 force = Vec3::Zero();      ///< [N], device axes
    Vec3 torque = Vec3::Zero();     ///< [N mm], device axes, about the tool's reference point
    std::uint16_t force_flags = 0;  ///< ForceFlag bits
    LayersFelt layers;
    ToolFelt tool;
    std::int64_t update_ns = 0;  ///< [ns] the proxy update alone, by the caller's clock. 0: none
};

/// Throws std::invalid_argument, with the reason, for settings that cannot be rendered. Whether
/// ranges of interest and layers are in the order of the field's solid side is left to their own
/// check(), and to that of a renderer.
void check(const RendererSettings& settings);
/// Throws std::invalid_argument for an isovalue that is NaN, or infinite so that all of space is
/// solid. The other infinity leaves all of space free.
void check_isovalue(double isovalue, Solid solid);
/// The properties of a field that stay while its samples change.
struct FieldKind {
    Geometry geometry;
    Solid solid = Solid::above;
    Interpolation interpolation = Interpolation::linear;
};
FieldKind kind_of(const Field& field);
/// Throws std::invalid_argument, with the reason, for a tool that cannot be used with this method
/// on such a field. Null, a point, is always valid.
void check_tool(const Tool* tool, ProxyMethod method, const FieldKind& field);
/// Throws std::invalid_argument, with the reason, for settings, an isovalue or a tool that cannot
/// be rendered with the renderer's field.
void check(const Renderer& renderer);
/// A renderer ready for its first tick. Throws as its check().
Renderer make_renderer(Field field, double isovalue, const RendererSettings& settings = {});
/// Another level from the next tick on or, while there are layers with surfaces, as soon as they
/// are removed. It has to pass check_isovalue().
void use_isovalue(Renderer& renderer, double isovalue) noexcept;
/// Allocates memory for any tool, so that use_tool() can change the tool between two ticks. Throws
/// std::bad_alloc.
void make_room_for_tools(Renderer& renderer);
/// Another tool, or with null a point, from the next tick on, at the proxy's place: the force
/// starts again. `orientation`: of the hand, tool axes to device axes, for a proxy that had none.
/// Allocates nothing: call make_room_for_tools() before. The settings have to pass check() with the
/// tool.
void use_tool(Renderer& renderer, std::shared_ptr<const Tool> tool,
              const Mat3& orientation) noexcept;
/// The proxy starts at the hand with the next tick, wherever it is now. The force starts again.
void lift(Renderer& renderer) noexcept;
/// A warning if there is no surface at this level (it lies outside the data's range), or if the
/// background, and so all of space outside the data, is solid. Else empty.
std::string isovalue_warning(const Field& field, double isovalue);

/// Renders one tick. A position that is not valid, not finite or extremely far does not move the
/// proxy (UpdateStatus::refused) and gives no force. A time that is not finite or did not advance
/// gives no force either, but the proxy follows. The same renderer and input give the same tick,
/// bit for bit, except for `update_ns`, which is measured if a clock is given. The proxy only moves
/// where all samples are in memory. If the hand pulls it farther, it is held
/// (UpdateStatus::waiting): the force falls to zero within its rate limit, and returns with the
/// ramp when the samples are in memory. Layers and penetrability need the whole way of the hand in
/// memory. `observer` is for a point, `pose_observer` for a tool.
Tick render(Renderer& renderer, const TickInput& device, StepObserver observer = {},
            Clock clock = nullptr, PoseObserver pose_observer = {});

}  // namespace palpate

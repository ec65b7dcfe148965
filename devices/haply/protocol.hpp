// The messages to and from the Inverse Service, as text. Pure functions, no network: service
// units (m, N) and service axes throughout.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "palpate/device.hpp"

namespace palpate::devices::haply {

constexpr std::size_t longest_message = std::size_t{1} << 20;  ///< [bytes]
constexpr int deepest_message = 32;                            ///< objects and arrays in each other
constexpr double farthest_position = 10;                       ///< [m] beyond is no position

/// The handle that gives orientation and buttons, if there is one.
struct Grip {
    std::string list;       ///< key of the list it is in; empty: none seen yet
    std::string id;         ///< its device_id; empty if it never told
    std::size_t place = 0;  ///< in the list, for messages that leave out the id
    Mat3 orientation = Mat3::Identity();
    std::uint32_t buttons = 0;
};

/// How the service maps positions and forces between the device and us. Any other program can
/// change it while we press, over HTTP.
struct Mapping {
    /// Position [m], rotation (w, x, y, z), scale.
    using Transform = std::array<double, 10>;
    static constexpr Transform identity{0, 0, 0, 1, 0, 0, 0, 1, 1, 1};

    std::string preset, basis, handedness;  ///< as the service tells them; empty: it has not
    Transform mount = identity, transform = identity;

    /// The first part that is not as in `other`, in a word; empty: all is.
    std::string_view difference(const Mapping& other) const;
};

/// What is known of the device. Messages after the first may leave out what has not changed.
struct ServiceState {
    std::string wanted;     ///< device_id that was asked for; empty: the first device
    std::string list;       ///< key of the list that ours is in: inverse3, minverse, ...
    std::string device_id;  ///< ours; empty: none yet
    std::size_t place = 0;  ///< as in Grip
    std::string attached;   ///< ids of the devices that were there when ours was not
    std::string model;      ///< as the service tells it
    Mapping mapping;
    std::optional<Vec3> position;  ///< [m]
    std::optional<Vec3> rendered;  ///< [N] the force that the service says it renders
    std::optional<bool> calibrated, ready, started, powered;
    Grip grip;
    std::string error;  ///< what was wrong with the last message, or what it complained of
};

/// What a message brought.
enum class News : std::uint8_t {
    state,    ///< of our device
    none,     ///< nothing about it
    gone,     ///< it is not (or no longer) attached
    refused,  ///< no message of this protocol: `error` says why, what was known stays
};

/// Takes a message of the service. Any text is fine; throws nothing but std::bad_alloc.
News take_message(ServiceState& state, std::string_view message);

/// `ready` only with a position and a device that says it is calibrated, started and ready.
DeviceStatus status_of(const ServiceState& state);
/// What is wrong and what to do, or empty.
std::string problem_of(const ServiceState& state);

/// Public clients write the force's three numbers under "values", the documentation of service 3.5
/// under "vector".
enum class ForceKey : std::uint8_t { values, vector };

/// The command that sets the force, and so asks for the next state. Allocates nothing.
class ForceCommand {
  public:
    struct Extras {
        std::string_view list = "inverse3";  ///< ServiceState::list
        bool wants_all = false;        ///< the answer is to tell all, also what has not changed
        std::string_view preset = {};  ///< not empty: sets this preset, and the basis XYZ
    };
    /// Throws std::invalid_argument for names that is_device_id() refuses.
    ForceCommand(std::string_view device_id, ForceKey key, const Extras& extras);
    ForceCommand(std::string_view device_id, ForceKey key) : ForceCommand(device_id, key, {}) {}
    /// [N]; what is not finite is zero. Valid until the next call.
    std::string_view with(const Vec3& force) noexcept;

  private:
    std::array<char, 640> text_{};
    std::size_t head_ = 0;
};

/// Asks for a whole snapshot while there is no device to command.
std::string_view snapshot_command();

/// 1 to 64 letters, digits, and - _ . : so that it can stand in a command as it is.
bool is_device_id(std::string_view text);

/// Rotation from service axes to ours: for right, up and towards the person the service's axis,
/// each x, y or z with an optional minus. Throws std::invalid_argument for anything else and for
/// mirrored axes.
Mat3 axes_from(std::string_view text);

}  // namespace palpate::devices::haply

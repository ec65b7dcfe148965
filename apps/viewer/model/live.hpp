// A session that runs: volume, device, servo, recording. What the window holds while somebody
// feels; knows no window.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/live/data_in_hand.hpp"
#include "apps/live/touch_options.hpp"
#include "palpate/devices/last_resort.hpp"
#include "palpate/devices/mouse.hpp"
#include "palpate/io/recording.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

/// Snapshots come out, commands go in; one thread, the window's, holds it.
class Live {
  public:
    /// Opens the device and starts the servo. `options` say which device, which level, how to
    /// render; its volume options are those that `loaded` was read with. Throws
    /// std::invalid_argument, io::InputError and devices::DeviceError as app::make_scene does, and
    /// std::system_error.
    Live(app::LoadedVolume loaded, const app::TouchOptions& options);
    /// Forces go to zero, a recording is finished.
    ~Live();
    Live(const Live&) = delete;
    Live& operator=(const Live&) = delete;

    /// As it was opened; as it is now, with edits or at a moment of a sequence, data() tells.
    const Field& field() const { return field_; }
    /// Edits and play. Whatever goes on there, goes on when the session starts anew.
    app::DataInHand& data() const { return *data_; }
    const app::TouchOptions& options() const { return options_; }
    DeviceInfo device() const { return device_->info(); }
    /// What is wrong with the device and what to do, in words; empty where all is well.
    std::string device_problem() const { return device_->problem(); }
    /// What the system granted of real time and what not.
    const std::vector<std::string>& privileges() const { return servo_->privileges(); }
    /// The device, if it is the window's own pointer; else null.
    devices::Mouse* mouse() const { return mouse_; }

    /// Throws std::invalid_argument, saying what is wrong, for a command that cannot be carried out
    /// or comes too fast.
    void send(const Command& command);
    std::optional<Snapshot> snapshot() const { return servo_->snapshot(); }
    ServoReport report() const { return servo_->report(); }
    /// As the commands that were sent have left them.
    const RendererSettings& settings() const { return settings_; }
    /// The level that was asked for last; what is felt, the snapshot tells.
    double isovalue() const { return isovalue_; }
    bool frozen() const { return frozen_; }

    /// Another device, by its option ("haply:port=10001"): the session goes on with what was asked
    /// for so far, fitted to the new device. Throws as the constructor; the old device then goes
    /// on. A recording is finished before.
    void use_device(const std::string& device);
    /// The other side is solid, or the field goes on with another background outside the grid. The
    /// session starts anew with all that was asked for but penetrability, which is switched off.
    /// A recording is finished before; should that fail, io::OutputError says so, and the field is
    /// as it was. Throws std::invalid_argument for a background that is not finite; then nothing
    /// has changed.
    void use_field(Solid solid, std::optional<double> background = {});

    /// Records from now on: the session starts anew (forces ramp up) with all that was asked for.
    /// Throws io::OutputError for a file that cannot be made; then nothing has changed. A recording
    /// that was running is finished, and should that fail io::OutputError says so, but the new one
    /// runs. After many edits it takes a while: it begins with all of them.
    void record(const std::filesystem::path& path);
    /// Ends the recording; the session starts anew. Returns the ticks in it. Throws io::OutputError
    /// for what could not be written. Nothing without a recording.
    std::int64_t stop_recording();
    /// Null while nothing is recorded.
    const io::RecordingWriter* recording() const { return recording_.get(); }

  private:
    Live(app::LiveScene scene, const app::TouchOptions& options);
    void hold(std::unique_ptr<Device> device);
    Session session_from(double isovalue, const DeviceTransform& transform,
                         std::int64_t last) const;
    std::int64_t last_tick() const;
    Session session_after() const;
    void start(Session session);
    void stop();

    app::LoadedVolume loaded_;
    app::TouchOptions options_;
    Field field_;
    std::unique_ptr<app::DataInHand> data_;
    std::unique_ptr<Device> device_;
    devices::Mouse* mouse_ = nullptr;
    std::optional<devices::LastResort> last_resort_;
    SessionSettings session_settings_;
    RendererSettings settings_;
    double isovalue_ = 0;
    bool frozen_ = false;
    /// Commands that the servo may not have carried out yet, with the tick they were sent after.
    struct Sent {
        std::int64_t after;
        Command command;
    };
    std::deque<Sent> sent_;
    std::unique_ptr<io::RecordingWriter> recording_;
    std::unique_ptr<Servo> servo_;
};

}  // namespace palpate::viewer

// A live run: a servo with its device, its data and a recording. Several runs may share the same
// data, as the hands of one session: all of them feel each edit, and if one device fails the others
// continue.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "palpate/devices/last_resort.hpp"
#include "palpate/devices/mouse.hpp"
#include "palpate/io/recording.hpp"
#include "palpate/progress.hpp"
#include "palpate/run/data.hpp"
#include "palpate/run/setup.hpp"
#include "palpate/servo.hpp"

namespace palpate::run {

/// The head of a recording for a session that is about to begin.
io::RecordingHead recording_head(const Session& session, const DeviceInfo& device,
                                 const io::VolumeIdentity& volume, const RenderSetup& setup);

/// The queue of commands is full: earlier commands have not been executed yet.
class QueueFull : public std::invalid_argument {
  public:
    using std::invalid_argument::invalid_argument;
};

/// The call is not possible now: the run was not started yet, was started before, or has stopped.
class WrongState : public std::logic_error {
  public:
    using std::logic_error::logic_error;
};

/// Gives snapshots and takes commands. Only one thread may use it; data() may be used by any.
class Run {
  public:
    /// Opens the device and fits its workspace to the data. Nothing moves before start(). Throws
    /// std::invalid_argument for an impossible setup, io::InputError for a file that the device
    /// cannot read, devices::DeviceError. `progress`, while an isovalue is looked for and before
    /// the device is opened, may throw to stop.
    Run(std::shared_ptr<Data> data, const Setup& setup, const OnProgress& progress = {});
    /// stop(), and finishes a recording silently.
    ~Run();
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    /// Starts the servo. Throws WrongState the second time, std::system_error if the system gives
    /// no thread.
    void start();
    /// The same in place of `before`, a run on the same data, whose servo ends. All settings
    /// requested there count, lowered where this device cannot render them. The buttons and the
    /// field are also the same. Motors of a device with the same name are as warm as they were. If
    /// its options are the same, too, a frozen hand stays frozen. So a program whose thread must
    /// not wait for a driver may construct a run on another thread, and destroy the one before
    /// there. Throws as make_renderer(), and as use_buttons() for a button that this device does
    /// not have. `before` then continues. If it was being recorded, the recording may have ended.
    void start_as(Run& before);
    /// The same as a further hand beside `first`, a run on the same data: on the field and with the
    /// buttons that are in use there by now. If it throws, also as use_buttons(), it is not
    /// started.
    void start_beside(const Run& first);
    bool started() const { return servo_ != nullptr; }  ///< also after stop()
    /// On data with Pace::by_steps, whose servo has no thread: computes one tick, a period after
    /// the one before, and does the work that is due for the data and the recording. The same steps
    /// and commands give the same ticks, as far as the data is in memory. Throws WrongState for
    /// other data, and before start().
    void step();
    double period() const { return period_; }  ///< [s] of its ticks; from start() on
    /// Forces go to zero and the servo ends permanently, or never starts. Waits until the device
    /// has sent the zero, but at most half a second if the device hangs. The last snapshot and
    /// report remain.
    void stop();
    /// After stop(): that the device has not got the zero, so that its force may still be on.
    /// Empty once it has.
    std::string unanswered() const;
    /// After use_device(): the same for the device before.
    const std::string& left_behind() const { return left_behind_; }

    /// The field at the start of the run; field_now() has the edits, or the moment of a sequence.
    const Field& field() const { return field_; }
    Field field_now() const;
    /// Edits and playback. They continue when the session starts anew.
    Data& data() const { return *data_; }
    /// For another run on the same data.
    const std::shared_ptr<Data>& shared_data() const { return data_; }
    const Setup& setup() const { return setup_; }
    DeviceInfo device() const { return device_->info(); }
    /// A problem of the device and its remedy; usually empty.
    std::string device_problem() const;
    /// The device, if it is a mouse that the application moves; else null.
    devices::Mouse* mouse() const { return mouse_; }

    // These are for the time after start(). Before, all but device_failure() throw WrongState.
    /// Which real-time privileges the system granted, and which not.
    const std::vector<std::string>& privileges() const { return started_servo().privileges(); }
    /// Throws std::invalid_argument, with the reason, for a command that cannot be executed, and
    /// for DeviceLimits that lower nothing; QueueFull if commands come too fast. While there are
    /// layers with surfaces, an isovalue has no effect. The last one applies when they are removed.
    /// Speed and Moment are for the player of data(), which throws if there is none. Samples are an
    /// edit of data() with a version of its own: it waits until that is computed. WrongState after
    /// stop().
    void send(const Command& asked);
    /// Commands that were sent and not carried out yet.
    std::int64_t waiting() const { return started_servo().waiting(); }
    /// Other than none: the device has failed, its force is zero and the session has ended.
    DeviceFailure device_failure() const;
    std::optional<Snapshot> snapshot() const { return started_servo().snapshot(); }
    ServoReport report() const { return started_servo().report(); }

    /// The settings after the commands sent so far.
    const RendererSettings& settings() const { return settings_; }
    /// The level that was requested last, also with layers. The snapshot has the level that is
    /// touched.
    double isovalue() const { return isovalue_; }
    bool frozen() const { return frozen_; }

    /// Continues with another device, with all settings requested so far, lowered where it
    /// cannot render them. Throws as the constructor does; the old device then continues. A
    /// recording is finished first. The same physical device is closed first and then opened with
    /// the new options. If that fails, it is opened as it was, and if that fails, too, it counts as
    /// lost. Throws WrongState before start() and after stop(), and devices::DeviceError while a
    /// call of the old device hangs, as do use_buttons() and use_field().
    void use_device(const devices::DeviceChoice& device, const OnProgress& progress = {});
    /// Continues with other buttons of the same device. The session starts anew with all settings
    /// requested so far, and with the proxy, freeze and clutch as they are. A recording is finished
    /// first. Throws std::invalid_argument for a button that the device does not have, and for one
    /// with both purposes. Then nothing has changed.
    void use_buttons(const Buttons& buttons);
    /// Continues with this solid side, this interpolation, and this background outside the grid.
    /// The session starts anew as with use_buttons(), but without penetrability and, if the solid
    /// side changes, without layers and with the proxy at the hand. A recording is finished first;
    /// if that fails, io::OutputError says so and the field stays. Throws std::invalid_argument for
    /// a background that is not finite, and with a tool for a linear field; then nothing has
    /// changed.
    void use_field(Solid solid, Interpolation interpolation, std::optional<double> background = {});

    /// Records from start() on, or from now on: the session and its force continue. Throws
    /// io::OutputError for a file that cannot be created, and if there were more edits than a
    /// recording can begin with; then nothing has changed. A recording that was running is
    /// finished; if that fails, io::OutputError says so, and if `progress` throws meanwhile, that
    /// is passed on, but the new one runs. Throws std::runtime_error or QueueFull, and leaves an
    /// empty recording, if the session takes no commands. Computes a checksum of the volume first:
    /// exceptions of `progress` are passed on, and nothing has changed.
    void record(const std::filesystem::path& path, const OnProgress& progress = {});
    /// The same for several runs on the same data, into one file: they are its hands, in this order
    /// (docs/recordings.md). The file is complete when the last of them has ended its recording.
    /// Throws std::invalid_argument for runs on different data, for no run, and for a run that is
    /// given twice, WrongState for one that has stopped.
    static void record_together(std::span<Run* const> runs, const std::filesystem::path& path,
                                const OnProgress& progress = {});
    /// Ends the recording; the session continues. Returns the number of its ticks, 0 without a
    /// recording. Throws io::OutputError if something could not be written. A pipe's reader that
    /// reads slowly is waited for until `progress` throws, or for half a second without it.
    std::int64_t stop_recording(const OnProgress& progress = {});
    /// The same in two parts, for a thread that must not wait: nothing more is recorded. The
    /// result, called once and on any thread, writes the rest and finishes the recording.
    using FinishRecording = std::function<std::int64_t(const OnProgress& progress)>;
    FinishRecording end_recording();
    /// Null unless a recording is running.
    const io::RecordingWriter* recording() const { return recording_.get(); }

  private:
    Servo& started_servo() const;
    Servo& servo_to_replace() const;
    void halt();
    std::unique_ptr<Device> open_for(const Setup& setup, double isovalue,
                                     const OnProgress& progress = {},
                                     const std::function<void()>& close = {}) const;
    void hold(std::unique_ptr<Device> device);
    void close_device();
    void reopen(double isovalue, const DeviceInfo& old);
    Session session_for(const RendererSettings& fit, const SessionSettings& settings,
                        const DeviceInfo& old) const;
    double some_isovalue(const OnProgress& progress) const;
    void take(const Session& session);
    void launch(Session session);
    void stop_servo();
    void record_from_now();
    void tell_begin();
    void drop_recording();
    void require_answer() const;
    Session session_now() const;
    Session session_stopped();

    std::shared_ptr<Data> data_;
    Setup setup_;
    Field field_;
    std::unique_ptr<Device> device_;
    devices::Mouse* mouse_ = nullptr;
    std::optional<devices::LastResort> last_resort_;
    SessionSettings session_settings_;
    RendererSettings settings_;
    double isovalue_ = 0;
    bool frozen_ = false;
    std::shared_ptr<io::RecordingWriter> recording_;  // of all its hands
    int hand_ = 1;                                    // which of them this run is
    std::filesystem::path recorded_as_;
    std::int64_t lost_before_ = 0;  // events of the recordings of this servo before
    std::unique_ptr<Servo> servo_;  // none before start()
    bool running_ = false;
    bool is_over_ = false;  // after stop(): no servo follows
    std::string left_behind_;
    double period_ = 0;           // [s] of a tick of this servo
    std::int64_t steps_ = 0;      // of this servo
    double time_ = 0, told_ = 0;  // [s] of all steps; when the data was told last
};

}  // namespace palpate::run

// A session of the page: the native servo and its session with a device that the page reads and
// writes, an editor with undo, and a recording in memory. One thread calls all of it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings/web/page_device.hpp"
#include "devices/spacenav/report.hpp"
#include "io/recording/recording_text.hpp"
#include "palpate/servo.hpp"

namespace palpate::web {

/// To the device, or nothing where the page itself is the device.
using Channel = std::unique_ptr<devices::haply::Channel>;

/// What observers see of a tick, as numbers in the order of `snapshot_names` in palpate.js.
using SnapshotNumbers = std::array<double, 24>;

class WebSession {
  public:
    /// `setup` is JSON, see SessionSetup in palpate.d.ts. Throws std::invalid_argument, and
    /// devices::DeviceError for a channel that leads to no device.
    WebSession(std::shared_ptr<const Samples> samples, const std::string& setup,
               Channel channel = nullptr);

    /// The newest reading: position [device mm], when it was measured [s, the page's clock].
    void read(double x, double y, double z, unsigned buttons, double measured);
    /// The device is gone until the next reading.
    void lose();
    /// A report of a 3D mouse (WebHID), for the device "spacenav": it moves the hand, and read() is
    /// only a sign of life.
    void puck(int number, const std::string& bytes);
    /// One tick, now, or at a time of the caller's [s] that the statistics leave out. False once
    /// the session has ended.
    bool step();
    bool step_at(double time);
    /// When the next tick is due [s, the page's clock].
    double due() const;
    void stop();

    /// A command as recordings write it, for example {"isovalue": {"value": 40}}.
    void send(const std::string& command);
    /// Each number that can be changed, with its value, as JSON (Setting in palpate.d.ts).
    std::string settings() const;
    /// Changes one of them.
    void set(const std::string& name, double value);
    /// An edit as recordings write it: {"stroke": {...}} or {"fill": {...}}. Belongs to the last
    /// step of undo if `same_step`.
    void edit(const std::string& edit, bool same_step);
    /// Carves along the SCP's way since the last call while it touches. `radius` [mm].
    bool drill(double radius, bool same_step);
    bool undo();
    bool redo();

    const SnapshotNumbers& snapshot();
    /// Counts and times of the loop (ServoReport) as JSON.
    std::string report() const;

    /// Begins a recording. `begun`: date and time, ISO 8601.
    void record(const std::string& begun);
    /// Ends it: its whole text, which `palpate replay --validate` takes.
    std::string recording();

    const std::shared_ptr<const Samples>& samples() const { return editor_.samples(); }
    const Field& field() const { return field_; }

  private:
    void move_puck();
    void push(const Command& command);
    bool make(const Edit& edit, bool same_step);
    bool go_to(const SampleBox& changed);
    std::uint64_t version_of_samples() const;
    void drain();

    io::Json setup_;
    Editor editor_;
    Field field_;  // as at the start
    PageDevice device_;
    struct Puck {
        devices::spacenav::ReportReader reports;
        devices::spacenav::Hand hand;
        double moved_at = 0;  // [s]
    };
    std::optional<Puck> puck_;
    Session start_;  // the same
    Session asked_;  // with the commands so far, without their samples
    /// Each with its recipe and number, without samples there. The first has number 0. A pointer
    /// has expired once undo cannot come back to its samples.
    std::vector<std::pair<std::weak_ptr<const Samples>, command::Samples>> versions_;
    std::uint64_t last_version_ = 0;
    std::optional<Vec3> carved_to_;  // [mm, physical]
    io::Bodies bodies_;
    Queue<SessionEvent> events_{64};  // emptied after each tick
    std::optional<io::RecordingText> text_;
    std::int64_t unrecorded_before_ = 0;
    std::unique_ptr<Servo> servo_;
    SnapshotNumbers numbers_{};
};

}  // namespace palpate::web

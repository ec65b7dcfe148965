// The live run and its device: lists devices, changes to another one, or to another field.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <optional>
#include <utility>
#include <vector>

#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/run/setup.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

struct Opened;

/// Settings from the command line for the runs to come, and the devices chosen since.
struct RunRequest {
    run::Setup setup;
    /// The device of the command line: used instead of those in a session file, with `others`.
    std::optional<devices::DeviceChoice> device;
    std::string record;  ///< recording to write; empty: none
    /// Of the hands beside the first.
    std::vector<devices::DeviceChoice> others = {};
    /// The buttons that the command line names: used instead of those in a session file.
    std::vector<std::pair<run::ButtonSetup run::Buttons::*, run::ButtonSetup>> buttons = {};

    std::vector<run::Setup> setups() const;
    void use_devices_of(const RunRequest& other);
};

class RunController : public Controller {
    Q_OBJECT

  public:
    /// `request`: the command line's, for the runs to come.
    RunController(const Desk& desk, const RunRequest& request);

    /// The request for another run. The level, the layers and the recording of the command line are
    /// for the first one only.
    RunRequest take_request();
    /// The level of the next run, unless the command line gave one.
    void set_first_isovalue(double isovalue);
    /// What find_devices() found, in a sentence.
    QString device_words() const;
    /// With the devices chosen last.
    const RunRequest& request() const { return request_; }
    void set_devices(const RunRequest& request) { request_.use_devices_of(request); }
    /// Feels the volume. Throws as Content::start_run.
    void start(std::shared_ptr<Opened> volume, const std::vector<run::Setup>& hands);

    /// Requests those of the settings for which there are commands. Not layers that
    /// lack_labels(). Not `in_place`: hands are where this run has put them, as the data lie
    /// elsewhere.
    void restore(const RendererSettings& settings, bool in_place);

    /// Whether a file that is dropped on the window is a tool: a mesh, by its name.
    static bool is_tool_file(const QString& path);
    /// Feels with the tool of a file, for which it asks by a dialog. Errors are shown; the tool
    /// before stays then.
    void ask_tool();
    void open_tool(const QString& path);
    /// Of tools.
    BackgroundTask& reader() { return reader_; }
    bool settled() const { return !reader_.busy(); }
    void find_devices();
    /// Of the chosen hand.
    void use_device(const QString& option);
    /// One more, with this device. It is chosen.
    void add_hand(const QString& option);
    void remove_hand();
    void choose_hand(int hand);
    void choose_next_hand();
    void use_field(Solid solid, Interpolation interpolation);
    /// Of all hands.
    void use_buttons(const run::Buttons& buttons);

    /// Shows the device in the panel where it has changed, and what is wrong with any hand's; a few
    /// times a second.
    void observe(const Snapshot& now);
    /// Shows how the servo loop has done since the last time; twice a second.
    void show_report();

  Q_SIGNALS:
    void device_changed();
    void devices_found();

  private:
    void show_devices();
    void show_hands();
    void show_terraces();

    RunRequest request_;
    BackgroundTask search_, reader_;
    std::vector<devices::DeviceFinding> findings_;
    std::optional<DeviceStatus> status_;
    QString problem_;
    QElapsedTimer since_report_;
    std::int64_t reported_ticks_ = 0;
};

}  // namespace palpate::viewer

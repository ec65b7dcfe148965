// Opens volumes, sessions and recordings in the background; saves sessions.
#pragma once

#include <QObject>
#include <QString>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/io/orientation.hpp"
#include "palpate/samples.hpp"

namespace palpate::viewer {

class DisplayController;
class SaveController;
class LayersControls;
class MeasureController;
class RecordingController;
class Panel;
struct Opened;
struct RunRequest;

/// Errors are shown; what was open then stays open, as long as the new file cannot be read.
class FileController : public Controller {
    Q_OBJECT

  public:
    FileController(const Desk& desk, Panel& panel, RecordingController& recordings,
                   DisplayController& display, MeasureController& measuring, SaveController& saver);

    /// A volume, a folder, a session, layers or a recording: its name tells which. Asks for the
    /// layout where lacks_layout().
    void open_path(const QString& path);
    /// The same, once unsaved work was saved or given up. With layers it stays.
    void open_dropped(const QString& path);
    /// Asks how the samples lie in a file without a header, and opens it.
    void ask_layout(const run::Source& source);
    void ask_address();
    /// Asks which level, channel and time of the store that is felt, and feels that instead: in the
    /// same view, at the same level of density where the channel is the same.
    void ask_level();
    /// Feels it, with the settings of the command line.
    void open_volume(const run::Source& source);
    /// The volume that comes with Palpate, felt at the skin.
    void open_sample();
    void open_session(const QString& path);
    void open_recording(const QString& path);
    /// Reads the volume that is felt again, dequantized or as it comes, and feels it as before,
    /// once its edits were saved or given up.
    void dequantize(bool on);
    /// Ends the playback: feels the recording's volume, at the level and in the view shown.
    void leave_playback();
    /// With its measurements. Throws io::OutputError.
    void save_session(const QString& path);
    /// Asks for a name where there is none. A session names a volume, so its edits are saved first.
    void ask_save_session(const QString& name, const std::function<void()>& then = {});
    /// `action` at once, or after unsaved edits, measurements and layers were saved or given up.
    void settle_work(const std::function<void()>& action);
    /// True if there is no such work, or it is given up. `once_saved` runs after it was saved.
    bool may_lose_work(const std::function<void()>& once_saved);
    /// Asks how the grid of the volume lies in the body, and its spacing, and reads the volume
    /// again with these: it is felt as before, but seen anew.
    void ask_grid();

    /// Of volumes.
    BackgroundTask& loader() { return loader_; }
    bool loading() const;

  private:
    using Then = std::function<void(std::shared_ptr<Opened>)>;
    /// What would be lost with the volume that is open.
    struct UnsavedWork {
        std::shared_ptr<const Samples> edits;
        std::vector<Measurement> measurements;
        SharedLayers layers;
        bool operator==(const UnsavedWork&) const = default;
    };
    UnsavedWork unsaved_work() const;
    std::function<void()> unless_changed(const std::optional<UnsavedWork>& before,
                                         std::function<void()> then);
    void read(BackgroundTask& reader, const QString& path, Worker::Task task,
              std::function<void()> then);
    void open_json(const QString& path, const std::optional<UnsavedWork>& before);
    void load(const run::Source& source, Then then);
    void feel_again(const run::Source& source);
    void use_grid(const io::GivenGrid& grid);
    void tell_choices(const Opened& opened);
    void choose_series(const io::SeriesChoice& choice, const run::Source& source, const Then& then);
    void load_or_reuse(const run::Source& source, Then then);
    void feel(std::shared_ptr<Opened> opened, const RunRequest& request, std::function<void()> then,
              std::function<void(const std::exception_ptr&)> otherwise = {});
    void tell_felt(const Opened& opened, const std::vector<run::Setup>& hands);
    void feel_session(std::shared_ptr<Opened> opened, SessionFile session, RunRequest request,
                      std::function<void()> then = {}, bool in_place = true);
    void restore_hands(const SessionFile& session, bool in_place);
    void restore(const RendererSettings& settings, bool in_place);
    RunRequest request_for_same();
    void play(std::shared_ptr<Opened> opened, const QString& path);
    SessionFile session_now() const;

    Panel& panel_;
    LayersControls& layers_;
    RecordingController& recordings_;
    DisplayController& display_;
    MeasureController& measuring_;
    SaveController& saver_;
    BackgroundTask reader_, loader_;  // of sessions, layers and heads of recordings; of volumes
};

}  // namespace palpate::viewer

// Opens volumes, sessions and recordings in the background; saves sessions.
#pragma once

#include <QObject>
#include <QString>
#include <functional>
#include <memory>
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
class LayersController;
class MeasureController;
class RecordingController;
class RunController;
struct Opened;
struct RunRequest;

/// What would be lost with the volume that is open.
struct UnsavedWork {
    std::shared_ptr<const Samples> edits;
    std::vector<Measurement> measurements;
    SharedLayers layers;
    bool operator==(const UnsavedWork&) const = default;
};

/// Errors are shown; what was open then stays open, as long as the new file cannot be read.
class FileController : public Controller {
    Q_OBJECT

  public:
    FileController(const Desk& desk, RunController& run, LayersController& layers,
                   RecordingController& recordings, DisplayController& display,
                   MeasureController& measuring);

    /// The open volume can be changed while another file is read. If it was changed, `settle` is
    /// called before that file is shown, and calls its action when the work is saved or given up.
    void guard(std::function<UnsavedWork()> unsaved,
               std::function<void(const std::function<void()>&)> settle);

    /// A volume, a folder, a session, layers or a recording: its name tells which. Asks for the
    /// layout where lacks_layout().
    void open_path(const QString& path);
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
    /// Reads the volume that is felt again, dequantized or as it comes, and feels it as before.
    void dequantize(bool on);
    /// Ends the playback: feels the recording's volume, at the level and in the view shown.
    void leave_playback();
    /// With its measurements. Throws io::OutputError.
    void save_session(const QString& path);
    /// Reads the volume again with what was asked for in place of its orientation and spacing: it
    /// is felt as before, but seen anew.
    void use_grid(const io::GivenGrid& grid);

    BackgroundTask& loader() { return loader_; }
    bool loading() const { return loader_.busy(); }

  private:
    using Then = std::function<void(std::shared_ptr<Opened>)>;
    void read(const QString& label, Worker::Task task, std::function<void()> then);
    void load(const run::Source& source, Then then);
    void feel_again(const run::Source& source);
    void tell_choices(const Opened& opened);
    void choose_series(const io::SeriesChoice& choice, const run::Source& source, const Then& then);
    void load_or_reuse(const run::Source& source, Then then);
    void feel(std::shared_ptr<Opened> opened, const RunRequest& request);
    void feel_session(std::shared_ptr<Opened> opened, const SessionFile& session,
                      RunRequest request, bool in_place = true);
    void restore_hands(const SessionFile& session, bool in_place);
    RunRequest request_for_same();
    void play(std::shared_ptr<Opened> opened, const QString& path);
    SessionFile session_now() const;

    RunController& run_;
    LayersController& layers_;
    RecordingController& recordings_;
    DisplayController& display_;
    MeasureController& measuring_;
    BackgroundTask loader_;
    std::function<UnsavedWork()> unsaved_ = [] { return UnsavedWork(); };
    std::function<void(const std::function<void()>&)> settle_;
};

}  // namespace palpate::viewer

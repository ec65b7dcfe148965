// The viewer's window: views, panel and time line; a session that runs or a recording that plays.
// It observes snapshots and sends commands.
#pragma once

#include <QElapsedTimer>
#include <QMainWindow>
#include <QTimer>
#include <functional>
#include <memory>
#include <optional>

#include "apps/live/exit_status.hpp"
#include "apps/live/view_options.hpp"
#include "apps/viewer/model/live.hpp"
#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/model/playback.hpp"
#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/model/work.hpp"

class QAction;
class QLabel;
class QMenu;

namespace palpate::viewer {

class Panel;
class SequenceBar;
struct BrushChoice;
class ProgressStrip;
class Views;
class TimeLine;

class MainWindow : public QMainWindow {
    Q_OBJECT

  public:
    /// `options` are those of the command line: device and settings of the sessions to come. Opens
    /// nothing yet.
    explicit MainWindow(const app::TouchOptions& options);
    /// Ends the session: forces are zero.
    ~MainWindow() override;
    /// The same, whatever is open; edits that were not saved go to a file of their own in the
    /// folder for temporary files, which is told on standard error.
    void end();

    /// A volume, a folder, a session or a recording, by what it is. Errors are shown.
    void open_path(const QString& path);
    /// Loads in the background and feels it, with the settings of the command line.
    void open_volume(const app::VolumeOptions& volume);
    void open_session(const QString& path);
    void open_recording(const QString& path);
    /// Throw io::OutputError.
    void save_session(const QString& path);
    void save_picture(const QString& path, bool whole_window);
    /// The volume as it is now, edits included, in the background; errors are shown.
    void save_volume(const QString& path);
    void start_recording(const QString& path);
    void stop_recording();

    Views& views() { return *views_; }
    Panel& panel() { return *panel_; }
    TimeLine& time_line() { return *time_line_; }
    SequenceBar& sequence_bar() { return *sequence_bar_; }
    const Live* live() const { return live_.get(); }
    Playback* playback() { return playback_ ? &*playback_ : nullptr; }
    /// [s] of the recording that is shown.
    double shown_time() const { return shown_time_; }
    void show_time(double time);
    /// What is shown of the hand stays as it is now, for a picture; the session goes on.
    void hold_picture();
    /// Nothing is being loaded or drawn: what is seen is what there is.
    bool settled() const;
    /// What went wrong last, as shown, and the exit status that stands for it; empty if nothing did
    /// since something was opened.
    const QString& problem() const { return problem_; }
    int problem_status() const { return problem_status_; }
    /// 0, or what a program ends with in which a recording was lost.
    int exit_status() const { return exit_status_; }

  protected:
    void closeEvent(QCloseEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;

  private:
    // main_window.cpp: what goes on.
    void connect_parts();
    void tick();
    void show_rate();
    void observe();
    void send(const Command& command);
    void guarded(const std::function<void()>& action);
    void show_problem(const QString& what, int status = app::bad_input);
    void show_done(const QString& what);
    void find_devices();
    void use_device(const QString& option);
    void use_solid(Solid solid);
    void show_devices();
    app::TouchOptions options_once();
    void give_up_work();
    void refresh_actions();
    // opening.cpp
    void run(const QString& label, Work::Task task, std::function<void()> then);
    using Then = std::function<void(std::shared_ptr<Opened>)>;
    void load(const app::VolumeOptions& volume, Then then);
    void load_or_reuse(const app::VolumeOptions& volume, Then then);
    void begin(std::shared_ptr<Opened> opened, const app::TouchOptions& options);
    void begin_with(std::shared_ptr<Opened> opened, app::TouchOptions options);
    void use_usual_look();
    void look_from_hand(const DeviceTransform& transform);
    void close_all();
    void show_volume(const Field& field, double isovalue, const RendererSettings& settings,
                     const DeviceInfo& device);
    void restore(const RendererSettings& settings);
    void resume(std::shared_ptr<Opened> opened, const SessionFile& session,
                app::TouchOptions options);
    void play(std::shared_ptr<Opened> opened, const QString& path);
    void leave_playback();
    void remember(const QString& path);
    SessionFile session_now() const;
    // living_data.cpp
    void connect_data();
    void make_data_menu();
    void show_data();
    void observe_data(const Snapshot& now);
    void use_brush(const BrushChoice& brush);
    void rescue_edits(const std::shared_ptr<const Samples>& samples);
    void undo(bool again);
    void ask_save_volume();
    bool may_lose_edits();
    // hand.cpp
    void make_hand_actions();
    void drag_probe(const Vec3& by);
    void aim_probe(const Vec3& to);
    void nudge(const Vec3& screen);
    void use_pointer_for(bool probe);
    // menus.cpp
    void make_menus();
    void make_file_menu();
    void make_session_menu();
    void make_view_menu();
    void fill_recent();
    QAction* add(QMenu* menu, const char* name, const QString& text, const QKeySequence& key,
                 std::function<void()> action);
    QAction* add_switch(QMenu* menu, const char* name, const QString& text, const QKeySequence& key,
                        std::function<void(bool)> action);
    void ask_open();
    void ask_open_folder();
    void ask_open_raw();
    QString ask_save(const QString& title, const QString& name, const QString& suffix,
                     bool replaces);
    void ask_save_session();
    void ask_save_picture(bool whole_window);
    void ask_record(bool on);

    app::TouchOptions options_;
    Views* views_;
    Panel* panel_;
    TimeLine* time_line_;
    SequenceBar* sequence_bar_;
    ProgressStrip* progress_;
    QLabel* frames_;
    QMenu* recent_ = nullptr;
    QTimer timer_;
    int rounds_ = 0;
    QElapsedTimer since_report_;
    std::int64_t reported_ticks_ = 0;

    std::unique_ptr<Work> work_, finding_, saving_;
    std::function<void()> then_;
    std::shared_ptr<Opened> opened_;  // what is shown
    std::unique_ptr<Live> live_;
    std::optional<Playback> playback_;
    double shown_time_ = 0;
    std::optional<Snapshot> held_;
    std::optional<double> shown_isovalue_;  // of the surface in the scene
    struct ShownData {
        std::shared_ptr<const Samples> samples;
        Moment moment;
    };
    ShownData shown_data_;
    QString data_problem_;
    std::optional<DeviceStatus> device_status_;
    std::vector<devices::DeviceFinding> findings_;
    QString problem_, device_problem_;
    int problem_status_ = 0, exit_status_ = 0;
};

}  // namespace palpate::viewer

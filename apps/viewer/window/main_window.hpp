// The viewer's window: builds views, panel, menus and the controllers, and connects them. It holds
// a live run or the playback of a recording; it observes snapshots and sends commands.
#pragma once

#include <QMainWindow>
#include <QTimer>

#include <functional>

#include "apps/viewer/scene/render_request.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/detail_controller.hpp"
#include "apps/viewer/window/display_controller.hpp"
#include "apps/viewer/window/file_controller.hpp"
#include "apps/viewer/window/hints.hpp"
#include "apps/viewer/window/measure_controller.hpp"
#include "apps/viewer/window/menus.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/preferences.hpp"
#include "apps/viewer/window/probe_controller.hpp"
#include "apps/viewer/window/recording_controller.hpp"
#include "apps/viewer/window/save_controller.hpp"

class QDockWidget;
class QLabel;

namespace palpate::viewer {

class Panel;
class StatusBar;
class Timeline;
class Views;
class Welcome;

class MainWindow : public QMainWindow {
    Q_OBJECT

  public:
    /// `request`: the command line's, for the runs to come. `make_painter`: as of Scene. Opens
    /// nothing yet.
    explicit MainWindow(const RunRequest& request, MakePainter make_painter = &make_render_thread);
    /// Ends the live run.
    ~MainWindow() override;
    /// Begins to end the forces, and ends the event loop. Unsaved edits are rescued:
    /// rescue_edits().
    void end();
    /// After the window was closed: waits until forces have ended, calls `forces_ended`, and waits
    /// until a recording is complete and the devices are closed. Returns the exit status: other
    /// than 0 if a recording was lost, or if a driver hangs. Only then are devices still open,
    /// has_closed_devices(), and the destructor would wait for the driver.
    int finish(const std::function<void()>& forces_ended = {});
    bool has_closed_devices() { return content_.closer().closes_within({}); }

    FileController& files() { return files_; }
    RecordingController& recordings() { return recordings_; }
    SaveController& saver() { return saver_; }
    ProbeController& probe() { return probe_; }
    MeasureController& measuring() { return measuring_; }
    DisplayController& display() { return display_; }
    DetailController& details() { return details_; }
    Messages& messages() { return messages_; }
    Content& content() { return content_; }
    const run::Run* live() const { return content_.live(); }
    Playback* playback() { return content_.playback(); }
    Views& views() { return *views_; }
    Panel& panel() { return *panel_; }
    Timeline& timeline() { return *timeline_; }
    TimelineController& playing() { return playing_; }

    /// Opens the dialog; changes are seen at once, and kept.
    void ask_preferences();
    /// Size and layout of this window are not those of the next start.
    void forget_layout();
    /// Throws io::OutputError.
    void save_picture(const QString& path, bool whole_window);
    /// Nothing is being loaded, saved or drawn.
    bool settled() const;
    /// What a timer does 60 times a second: shows what has changed.
    void tick();

  protected:
    void closeEvent(QCloseEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;

  private:
    void build();
    void connect_parts();
    void connect_welcome();
    void show_note(const QString& what);
    void show_title();
    void show_grid();
    bool lacks_grid() const;
    void show_missing();
    void restore_layout();
    void use(const Preferences& preferences);
    void show_readout(const Snapshot& now);
    void show_streaming();
    void rest_or_wake(const HandSnapshots& now);

    // The menus and the tool bar (menus.cpp).
    void make_menus();
    void fill_recent(QMenu& menu);
    void make_file_menu();
    void make_session_menu();
    void make_data_menu();
    void make_measure_and_cut_menus(QMenu& view);
    void make_view_menu();
    void make_help_menu();
    void make_tool_bar();
    /// Views from the sides of the body, or from the ends of the grid's axes where those are not
    /// known.
    void name_views(bool oriented);
    void record(bool on);

    Content content_;
    Views* views_;
    Welcome* welcome_;
    Timeline* timeline_;
    StatusBar* status_;
    QLabel *streaming_, *frame_time_;
    Messages messages_;
    Desk desk_;
    Panel* panel_;
    QDockWidget* dock_ = nullptr;  // of the panel
    MeasureController measuring_;
    DisplayController display_;
    DetailController details_;
    RecordingController recordings_;
    ProbeController probe_;
    SaveController saver_;
    TimelineController playing_;
    FileController files_;
    Hints hints_;
    Actions actions_;
    const ActionRow::Condition if_open_ = [this] { return content_.volume() != nullptr; };
    const ActionRow::Condition if_live_ = [this] { return live() != nullptr; };
    QTimer timer_;
    bool keeps_layout_ = true;
    QStringList usual_folds_, notes_;
    int rounds_ = 0, at_rest_ = 0;
    HandSnapshots seen_;  // the last ones that differed from those before
};

}  // namespace palpate::viewer

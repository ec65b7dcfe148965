// Builds the window, and updates it 60 times a second.
#include "apps/viewer/window/main_window.hpp"

#include <malloc.h>

#include <QAction>
#include <QApplication>
#include <QBoxLayout>
#include <QBuffer>
#include <QCloseEvent>
#include <QCoreApplication>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QKeyEvent>
#include <QLabel>
#include <QMimeData>
#include <QScreen>
#include <QSettings>
#include <QUrl>

#include <algorithm>
#include <chrono>
#include <utility>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/panel/application.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/sentences.hpp"
#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/hints.hpp"
#include "apps/viewer/window/layers_controls.hpp"
#include "apps/viewer/window/menus.hpp"
#include "apps/viewer/window/overlay_controls.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/status_bar.hpp"
#include "apps/viewer/window/tool_controls.hpp"
#include "apps/viewer/window/views.hpp"
#include "apps/viewer/window/welcome.hpp"
#include "io/system/system.hpp"
#include "palpate/field.hpp"
#include "palpate/io/output.hpp"

namespace palpate::viewer {
namespace {

constexpr int frame_ms = 16;
// After so many updates in which nothing moved they come less often, until something does.
constexpr int rounds_at_rest = 60, resting_frame_ms = 48;
// [frames] Intervals of updates that change slowly or take long.
constexpr int panel_rounds = 2, device_rounds = 8, report_rounds = 32;
constexpr int message_ms = 10000;
// After a volume was closed the C library is asked to give its memory back to the system.
constexpr int give_back_ms = 2000;

}  // namespace

MainWindow::MainWindow(const RunRequest& request, MakePainter make_painter)
    : content_(request),
      views_(new Views(std::move(make_painter), this)),
      welcome_(new Welcome(this)),
      timeline_(new Timeline(this)),
      status_(new StatusBar(this)),
      streaming_(new QLabel),
      frame_time_(new QLabel),
      messages_(this),
      desk_(content_, messages_, *views_),
      panel_(new Panel(desk_, this)),
      measuring_(desk_),
      display_(desk_, *panel_, measuring_),
      details_(desk_),
      recordings_(desk_),
      probe_(desk_),
      saver_(desk_, *panel_),
      playing_(desk_, *timeline_),
      files_(desk_, *panel_, recordings_, display_, measuring_, saver_),
      hints_(desk_, recordings_),
      actions_(this, messages_) {
    setObjectName("palpate");
    setWindowTitle("Palpate");
    setAcceptDrops(true);
    build();
    make_menus();
    connect_parts();
    connect_welcome();
    restore_layout();
    use(saved_preferences());
    panel_->device_controls().find_devices();
    timer_.start(frame_ms);
    if (auto* application = dynamic_cast<Application*>(qApp)) {
        application->on_failure = [this](const std::exception&) {
            messages_.guarded([] { throw; });
        };
    }
}

MainWindow::~MainWindow() {
    timer_.stop();
    if (auto* application = dynamic_cast<Application*>(qApp)) application->on_failure = nullptr;
    content_.end_run();  // before anything that takes time
    delete panel_;       // it may still ask for something when it loses the focus
}

void MainWindow::build() {
    auto* centre = new QWidget;
    auto* layout = column_in(centre, {welcome_, views_, timeline_});
    layout->setStretch(0, 1);
    layout->setStretch(1, 1);
    views_->hide();
    layout->setSpacing(0);
    for (BackgroundTask* task : messages_.tasks()) layout->addWidget(make_progress_strip(*task));
    setCentralWidget(centre);
    dock_ = named(new QDockWidget(tr("Feel and look")), "dock");
    dock_->setWidget(panel_);
    addDockWidget(Qt::RightDockWidgetArea, dock_);
    setStatusBar(status_);
    streaming_->setObjectName("streaming");
    status_->insertPermanentWidget(0, streaming_);
    frame_time_->setObjectName("frames");
    status_->addPermanentWidget(frame_time_);
    status_->showMessage(tr("Open a volume, or drop one here (Ctrl+O); ? lists the shortcuts"));
}

void MainWindow::connect_parts() {
    connect(&timer_, &QTimer::timeout, this, &MainWindow::tick);
    connect(&messages_, &Messages::done, this, &MainWindow::show_note);
    connect(&views_->scene(), &Scene::problem, this,
            [this](const QString& what) { messages_.show_problem(in_words(what.toStdString())); });
    connect(&probe_, &ProbeController::lifted, &panel_->brush_controls(), &BrushControls::rest);
    for (const auto changed :
         {&Content::closed, &Content::run_started, &Content::playback_started, &Content::renamed}) {
        connect(&content_, changed, this, &MainWindow::show_title);
    }
    connect(&panel_->overlay_controls(), &OverlayControls::overlay_changed, this,
            &MainWindow::show_missing);
    connect(views_, &Views::missing_asked, this, [this] {
        if (lacks_grid()) return actions_.find("choose_grid")->trigger();
        panel_->show_section(panel_->overlay_controls());
    });
    // A closed volume goes back to the system: large blocks at once, the rest once the threads that
    // draw have released it.
    io::return_large_blocks();
    connect(&content_, &Content::closed, this,
            [this] { QTimer::singleShot(give_back_ms, this, [] { malloc_trim(0); }); });
    const auto refresh = [this] { actions_.refresh(); };
    for (const auto changed : {&Content::closed, &Content::run_changed, &Content::playback_started,
                               &Content::hand_changed, &Content::device_changed}) {
        connect(&content_, changed, this, refresh);
    }
    connect(&recordings_, &RecordingController::changed, this, refresh);
    connect(&panel_->brush_controls(), &BrushControls::history_changed, this, refresh);
}

/// Notes that come together are shown together. The newest comes first, as a narrow window cuts the
/// end off.
void MainWindow::show_note(const QString& what) {
    if (notes_.isEmpty()) QTimer::singleShot(0, this, [this] { notes_.clear(); });
    notes_.prepend(what);
    status_->showMessage(notes_.join("; "), message_ms);
}

/// It stands in for the views while nothing is open.
void MainWindow::connect_welcome() {
    const auto show_views = [this] {
        show_grid();
        welcome_->hide();
        views_->show();
    };
    connect(&content_, &Content::run_started, this, show_views);
    connect(&content_, &Content::playback_started, this, show_views);
    // Later: what was closed usually makes room for what is opened.
    const auto show_welcome = [this] {
        if (content_.volume() || panel_->device_controls().connector().task().busy()) return;
        views_->hide();
        welcome_->refresh();
        welcome_->show();
    };
    connect(&content_, &Content::closed, this, show_welcome, Qt::QueuedConnection);
    connect(&panel_->device_controls().connector().task(), &BackgroundTask::ended, this,
            show_welcome, Qt::QueuedConnection);
    connect(&panel_->device_controls(), &DeviceControls::devices_found, welcome_,
            &Welcome::set_devices);
    connect(welcome_, &Welcome::open_asked, actions_.find("open"), &QAction::trigger);
    connect(welcome_, &Welcome::folder_asked, actions_.find("open_folder"), &QAction::trigger);
    connect(welcome_, &Welcome::sample_asked, this, [this] { files_.open_sample(); });
    connect(welcome_, &Welcome::recent_chosen, this,
            [this](const QString& path) { files_.open_path(path); });
}

/// Volume, a mark while it has unsaved edits, and session.
void MainWindow::show_title() {
    if (!content_.volume()) return setWindowTitle("Palpate");
    QString volume = short_name(QString::fromStdString(run::name_of(content_.source())));
    volume.replace("[*]", "[*][*]");
    const QString session =
        content_.session().isEmpty() ? "" : QString(" (%1)").arg(short_name(content_.session()));
    setWindowTitle(tr("%1[*]%2 – Palpate").arg(volume, session));
}

/// Names the views for the sides of the body or the axes of the grid.
void MainWindow::show_grid() {
    name_views(content_.volume()->loaded.volume.geometry().oriented);
    use(saved_preferences());
    show_missing();
}

bool MainWindow::lacks_grid() const {
    if (!content_.volume() || !content_.from_file()) return false;
    const Geometry& grid = content_.volume()->loaded.volume.geometry();
    return !(grid.oriented && grid.measured);
}

/// Tells which facts about the grids of volume and overlay are missing.
void MainWindow::show_missing() {
    const QString sides =
        tr("Sides of the body are not known: say how the volume lies, and its spacing");
    if (!lacks_grid()) {
        const QString warning = panel_->overlay_controls().warning();
        if (warning.isEmpty()) return views_->set_missing({}, sides);
        return views_->set_missing(tr("The overlay may lie elsewhere"), warning);
    }
    const Geometry& grid = content_.volume()->loaded.volume.geometry();
    views_->set_missing(grid.oriented   ? tr("No spacing in the file")
                        : grid.measured ? tr("No orientation in the file")
                                        : tr("No orientation and no spacing in the file"),
                        sides);
}

void MainWindow::restore_layout() {
    const QSettings settings;
    if (!restoreGeometry(settings.value("geometry").toByteArray())) {
        resize(QSize(1360, 860).boundedTo(0.9 * screen()->availableSize()));
    }
    restoreState(settings.value("state").toByteArray());
    usual_folds_ = panel_->folded();
    panel_->fold(settings.value("folded", usual_folds_).toStringList());
}

void MainWindow::forget_layout() {
    keeps_layout_ = false;
    panel_->fold(usual_folds_);
}

/// Uses all preferences but the appearance, which belongs to the application.
void MainWindow::use(const Preferences& preferences) {
    const auto& volume = content_.volume();
    Shown next = views_->shown();
    next.unit =
        volume ? unit_in(volume->loaded.volume.geometry(), preferences.unit) : preferences.unit;
    next.wheel_px = preferences.wheel_px;
    next.most_triangles = static_cast<std::size_t>(1e6 * preferences.surface_millions);
    views_->set_shown(next);
}

void MainWindow::ask_preferences() {
    const auto change = [this](const Preferences& preferences) {
        if (preferences.appearance != saved_preferences().appearance) {
            set_appearance(preferences.appearance);
        }
        save_preferences(preferences);
        use(preferences);
    };
    messages_.ask(make_preferences_dialog(saved_preferences(), this, change));
}

void MainWindow::tick() {
    ++rounds_;
    playing_.advance();
    const HandSnapshots all = display_.observe();
    const std::optional<Snapshot>& now = all[content_.hand()];
    details_.observe(now);
    rest_or_wake(all);
    probe_.observe();
    hints_.observe(all, content_.editor() && panel_->brush_controls().choice().on);
    if (now) panel_->layers_controls().show_snapshot(*now);
    if (now && rounds_ % panel_rounds == 0) {
        content_.effect().observe(*now);
        show_readout(*now);
        panel_->brush_controls().observe();
        playing_.observe();
    }
    if (rounds_ % panel_rounds == 0) hints_.show_notes(panel_->notes());
    if (now && rounds_ % device_rounds == 0) {
        panel_->hand_switch().show_hands();
        panel_->device_controls().observe(*now);
    }
    if (rounds_ % device_rounds == 0) {
        show_streaming();
        actions_.refresh();
        setWindowModified(saver_.unsaved() != nullptr);
    }
    if (rounds_ % report_rounds == 0) recordings_.check();
    // New numbers make the whole window be composed again, which takes software 30 ms.
    const bool resting = at_rest_ > rounds_at_rest;
    if (rounds_ % (resting ? 4 * report_rounds : report_rounds) != 0) return;
    panel_->loop_view().observe();
    const double seconds = views_->scene().frame_seconds();
    frame_time_->setText(seconds > 0 ? tr("%1 ms a frame").arg(1e3 * seconds, 0, 'f', 0)
                                     : QString());
}

/// Position, value and gradient at the proxy.
void MainWindow::show_readout(const Snapshot& now) {
    const Vec3& at = now.session.tick.proxy.scp;
    if (!at.allFinite()) return status_->show_readout({});
    const QString units = QString::fromStdString(content_.volume()->loaded.values.units);
    const Ruler ruler = ruler_of(content_.volume()->loaded.volume.geometry());
    const auto number = [&](double mm) { return QString::fromStdString(ruler.number(mm)); };
    QString words = felt_text(now.session.tick.layers, content_.layers());
    if (!words.isEmpty()) words += "   ";
    const QString unit = QCoreApplication::translate("Units", ruler.unit);
    words += QString("%1, %2, %3 %4").arg(number(at[0]), number(at[1]), number(at[2]), unit);
    if (const auto field = content_.felt_round(now, at)) {
        const double slope = gradient_at(*field, at).norm() / ruler.per_mm;
        words += "   " +
                 tr("%1 %2   slope %3 /%4")
                     .arg(number_text(value_at(*field, at), 4), units, number_text(slope, 3), unit);
    }
    status_->show_readout(words);
}

/// Shows levels and missing data of a store. Unchanged words are not drawn again.
void MainWindow::show_streaming() {
    streaming_->setVisible(details_.active());
    if (!details_.active()) return;
    const auto hand = content_.data() ? content_.data()->streaming() : stream::BrickLoaderStatus{};
    const DetailController::State seen = details_.state();
    const QString words = streaming_words(hand, seen);
    if (streaming_->text() != words) streaming_->setText(words);
    streaming_->setToolTip(streaming_tip(hand, seen));
}

/// Looks less often at hands that rest.
void MainWindow::rest_or_wake(const HandSnapshots& now) {
    constexpr double unseen_mm = 1e-6;
    const bool same = std::ranges::equal(now, seen_, [](const auto& a, const auto& b) {
        return a && b ? looks_same(*a, *b, unseen_mm) : !a && !b;
    });
    at_rest_ = same && !probe_.travelling() ? at_rest_ + 1 : 0;
    if (!same) seen_ = now;
    const int wanted = at_rest_ > rounds_at_rest ? resting_frame_ms : frame_ms;
    if (timer_.interval() != wanted) timer_.setInterval(wanted);
}

bool MainWindow::settled() const {
    return std::ranges::none_of(messages_.tasks(), &BackgroundTask::busy) && !probe_.travelling() &&
           panel_->overlay_controls().settled() &&
           (!content_.volume() || (views_->scene().settled() && details_.settled()));
}

void MainWindow::save_picture(const QString& path, bool whole_window) {
    const QImage image = whole_window ? grab().toImage() : views_->scene().picture();
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    image.save(&buffer, "PNG");
    io::write_file(path.toStdString(), {bytes.constData(), std::size_t(bytes.size())});
    messages_.show_done(tr("Saved %1").arg(path));
}

void MainWindow::end() {
    timer_.stop();
    const bool edits = saver_.unsaved() != nullptr;
    const std::shared_ptr<run::Data> felt = content_.data();
    content_.end_run();  // forces first
    panel_->device_controls().connector().task().abandon();
    if (edits) rescue_edits(*felt);
    QApplication::exit(0);
}

void MainWindow::closeEvent(QCloseEvent* event) {
    // Later: a window that is closing does not close.
    const auto close_again = [this] { QTimer::singleShot(0, this, [this] { close(); }); };
    if (!files_.may_lose_work(close_again)) return event->ignore();
    if (keeps_layout_) {
        QSettings settings;
        settings.setValue("geometry", saveGeometry());
        settings.setValue("state", saveState());
        settings.setValue("folded", panel_->folded());
    }
    timer_.stop();
    content_.end_run();
    panel_->device_controls().connector().task().abandon();
    event->accept();
}

int MainWindow::finish(const std::function<void()>& forces_ended) {
    constexpr std::chrono::seconds patience{2};
    content_.closer().forces_end_within(patience);
    if (forces_ended) forces_ended();
    recordings_.finish();
    content_.closer().wait_for_recordings();
    QCoreApplication::sendPostedEvents(&content_, QEvent::MetaCall);  // tells what went wrong
    const bool hangs = !content_.closer().closes_within(patience);
    const int lost = recordings_.exit_status();
    return lost == app::done && hangs ? app::no_device : lost;
}

void MainWindow::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Escape && measuring_.cancel()) return;
    QMainWindow::keyPressEvent(event);
}

/// A window that has become narrower leaves the room to the picture.
void MainWindow::resizeEvent(QResizeEvent* event) {
    QMainWindow::resizeEvent(event);
    if (!dock_->isFloating() && 4 * dock_->width() > width()) {
        resizeDocks({dock_}, {panel_->sizeHint().width()}, Qt::Horizontal);
    }
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    if (event->mimeData()->hasUrls()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
    const auto urls = event->mimeData()->urls();
    if (urls.isEmpty()) return;
    event->acceptProposedAction();
    if (urls.size() > 1) {
        return messages_.show_problem(
            tr("%n files were dropped: drop one, or the folder of slices", nullptr, urls.size()));
    }
    const QUrl& url = urls.front();
    const QString path = url.isLocalFile() ? url.toLocalFile() : url.toString();
    // The volume stays, with its edits.
    if (ToolControls::is_tool_file(path)) return panel_->tool_controls().open(path);
    files_.open_dropped(path);
}

}  // namespace palpate::viewer

// What goes on in the window: snapshots to who shows them, wishes to the session.
#include "apps/viewer/window/main_window.hpp"

#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QLabel>
#include <QMessageBox>
#include <QMimeData>
#include <QScreen>
#include <QScrollArea>
#include <QSettings>
#include <QStatusBar>
#include <QVBoxLayout>
#include <cmath>
#include <cstdio>
#include <utility>

#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/panel/sequence_bar.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/slices/time_line.hpp"
#include "apps/viewer/window/progress_strip.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {
namespace {

constexpr int frame_ms = 16;
// In frames: how often what changes slowly, or is slow to show, is looked at.
constexpr int panel_rounds = 2, device_rounds = 8, report_rounds = 32;

}  // namespace

MainWindow::MainWindow(const app::TouchOptions& options)
    : options_(options),
      views_(new Views),
      panel_(new Panel),
      time_line_(new TimeLine),
      sequence_bar_(new SequenceBar),
      progress_(new ProgressStrip),
      frames_(new QLabel) {
    setObjectName("palpate");
    setWindowTitle("Palpate");
    setAcceptDrops(true);
    auto* centre = new QWidget;
    auto* layout = new QVBoxLayout(centre);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(0);
    layout->addWidget(views_, 1);
    layout->addWidget(time_line_);
    layout->addWidget(sequence_bar_);
    layout->addWidget(progress_);
    time_line_->hide();
    sequence_bar_->hide();
    setCentralWidget(centre);
    auto* scroll = new QScrollArea;
    scroll->setWidget(panel_);
    scroll->setWidgetResizable(true);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setMinimumWidth(panel_->minimumSizeHint().width() + 24);
    auto* dock = new QDockWidget(tr("Feel and look"));
    dock->setObjectName("dock");
    dock->setWidget(scroll);
    addDockWidget(Qt::RightDockWidgetArea, dock);
    frames_->setObjectName("frames");
    statusBar()->addPermanentWidget(frames_);
    statusBar()->showMessage(tr("Open a volume, or drop one here (Ctrl+O); ? lists the shortcuts"));
    panel_->clear();
    make_menus();
    connect_parts();
    connect_data();
    const QSettings settings;
    if (!restoreGeometry(settings.value("geometry").toByteArray())) {
        resize(QSize(1360, 860).boundedTo(0.9 * screen()->availableSize()));
    }
    restoreState(settings.value("state").toByteArray());
    find_devices();
    since_report_.start();
    timer_.start(frame_ms);
}

MainWindow::~MainWindow() {
    timer_.stop();
    live_.reset();  // before anything that takes time
    finding_.reset();
    work_.reset();
    saving_.reset();
}

void MainWindow::connect_parts() {
    connect(&timer_, &QTimer::timeout, this, &MainWindow::tick);
    connect(views_, &Views::probe_dragged, this, &MainWindow::drag_probe);
    connect(views_, &Views::probe_aimed, this, &MainWindow::aim_probe);
    connect(&views_->scene(), &Scene::problem, this,
            [this](const QString& what) { show_problem(what); });
    connect(panel_, &Panel::asked, this, &MainWindow::send);
    connect(panel_, &Panel::device_chosen, this, &MainWindow::use_device);
    connect(panel_, &Panel::devices_wanted, this, &MainWindow::find_devices);
    connect(panel_, &Panel::solid_chosen, this, &MainWindow::use_solid);
    connect(panel_, &Panel::look_changed, this, [this](const Look& look) {
        views_->set_look(look);
        refresh_actions();
    });
    connect(time_line_, &TimeLine::time_chosen, this, [this](double time) { shown_time_ = time; });
    connect(progress_, &ProgressStrip::cancelled, this, [this] {
        if (work_) work_->cancel();
    });
}

void MainWindow::tick() {
    ++rounds_;
    observe();
    if (rounds_ % report_rounds != 0) return;
    show_rate();
    const double seconds = views_->scene().frame_seconds();
    frames_->setText(seconds > 0 ? tr("%1 ms a frame").arg(1e3 * seconds, 0, 'f', 0) : QString());
    // One that cannot be written any more is ended: that tells why.
    if (live_ && live_->recording() && !live_->recording()->problem().empty()) stop_recording();
}

/// How the loop has done since the last time.
void MainWindow::show_rate() {
    if (!live_) return;
    const ServoReport report = live_->report();
    const double seconds = 1e-3 * static_cast<double>(since_report_.restart());
    const std::int64_t ticks = report.ticks - std::exchange(reported_ticks_, report.ticks);
    // Fewer than before: another servo.
    if (ticks >= 0 && seconds > 0)
        panel_->show_report(report, static_cast<double>(ticks) / seconds);
}

void MainWindow::observe() {
    std::optional<Snapshot> now;
    if (live_) {
        now = held_ ? held_ : live_->snapshot();
    } else if (playback_) {
        now = playback_->at(shown_time_);
    }
    views_->show_snapshot(now);
    if (!now) return;
    observe_data(*now);
    const double felt = now->session.tick.proxy.isovalue;
    if (std::isfinite(felt) && shown_isovalue_ != felt) {
        shown_isovalue_ = felt;
        views_->set_isovalue(felt);
    }
    if (rounds_ % panel_rounds == 0) panel_->show_snapshot(*now);
    if (live_ && rounds_ % device_rounds == 0) {
        const DeviceStatus status = now->session.device.status;
        const QString problem = QString::fromStdString(live_->device_problem());
        if (status != device_status_ || problem != device_problem_) {
            device_status_ = status;
            device_problem_ = problem;
            panel_->show_device(live_->device(), status, problem);
        }
        refresh_actions();
    }
}

void MainWindow::send(const Command& command) {
    if (!live_) {
        panel_->show_refused(playback_ ? tr("A recording is played: nothing here changes it.")
                                       : tr("There is no volume to feel."));
        return;
    }
    try {
        live_->send(command);
    } catch (const std::invalid_argument& e) {
        panel_->show_refused(QString::fromStdString(e.what()));
    }
}

/// Runs what may throw; what it throws is shown.
void MainWindow::guarded(const std::function<void()>& action) {
    try {
        action();
    } catch (const std::exception& e) {
        const app::Failure failure = app::failure_of(e);
        show_problem(QString::fromStdString(failure.text), failure.status);
    }
}

void MainWindow::show_problem(const QString& what, int status) {
    problem_ = what;
    problem_status_ = status;
    std::fprintf(stderr, "palpate: %s\n", what.toLocal8Bit().constData());
    auto* box = new QMessageBox(QMessageBox::Warning, tr("Palpate"), what, QMessageBox::Ok, this);
    box->setObjectName("problem");
    box->setTextInteractionFlags(Qt::TextSelectableByMouse);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->open();  // the session goes on behind it
}

void MainWindow::show_done(const QString& what) {
    statusBar()->showMessage(what, 10'000);
}

void MainWindow::find_devices() {
    if (finding_ && !finding_->ended()) return;
    auto found = std::make_shared<std::vector<devices::DeviceFinding>>();
    finding_ =
        std::make_unique<Work>([found](const io::Progress&) { *found = devices::find_devices(); },
                               [this, found] {
                                   QMetaObject::invokeMethod(
                                       this,
                                       [this, found] {
                                           if (!finding_ || !finding_->ended()) return;
                                           findings_ = *found;
                                           show_devices();
                                       },
                                       Qt::QueuedConnection);
                               });
}

void MainWindow::show_devices() {
    const std::string current = live_ ? live_->options().device : options_.device;
    panel_->set_devices(findings_, QString::fromStdString(current));
    device_status_.reset();
}

void MainWindow::use_device(const QString& option) {
    guarded([&] {
        (void)devices::parse_device(option.toStdString());
        if (live_) {
            const io::RecordingWriter* recording = live_->recording();
            const std::int64_t ticks = recording ? recording->ticks() : 0;
            live_->use_device(option.toStdString());
            if (ticks > 0) show_done(tr("%1 ticks recorded, up to the other device").arg(ticks));
            use_pointer_for(live_->mouse() != nullptr);
            panel_->set_session(live_->field(), opened_->histogram, live_->isovalue(),
                                live_->settings(), live_->device());
            show_data();
        }
        options_.device = option.toStdString();
    });
    show_devices();
    refresh_actions();
}

void MainWindow::use_solid(Solid solid) {
    if (!live_ || live_->field().solid() == solid) return;
    guarded([&] {
        live_->use_field(solid);
        show_volume(live_->field(), live_->isovalue(), live_->settings(), live_->device());
        show_data();
    });
}

void MainWindow::hold_picture() {
    if (live_) held_ = live_->snapshot();
}

bool MainWindow::settled() const {
    return !work_ && !saving_ && (!opened_ || views_->scene().settled());
}

void MainWindow::closeEvent(QCloseEvent* event) {
    if (!may_lose_edits()) return event->ignore();
    QSettings settings;
    settings.setValue("geometry", saveGeometry());
    settings.setValue("state", saveState());
    stop_recording();
    event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    if (event->mimeData()->hasUrls()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
    const auto urls = event->mimeData()->urls();
    if (urls.isEmpty()) return;
    event->acceptProposedAction();
    if (!may_lose_edits()) return;
    open_path(urls.front().toLocalFile());
}

}  // namespace palpate::viewer

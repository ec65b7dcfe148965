// Opening and saving: volumes, sessions, recordings, pictures.
#include <fmt/format.h>

#include <QBuffer>
#include <QDir>
#include <QFileInfo>
#include <QSettings>
#include <filesystem>
#include <utility>

#include "apps/live/recorded_scene.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/slices/time_line.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/progress_strip.hpp"
#include "apps/viewer/window/views.hpp"
#include "palpate/io/output.hpp"

namespace palpate::viewer {
namespace {

constexpr int most_recent = 10;

std::filesystem::path path_of(const QString& name) {
    return std::filesystem::path(name.toStdString());
}

/// As one would write it in a sentence.
QString short_name(const QString& path) {
    return path.startsWith("synthetic:") ? path : QFileInfo(QDir::cleanPath(path)).fileName();
}

}  // namespace

/// Does it in the background, with progress; `then` runs here once it is done. Work that is under
/// way is given up for it.
void MainWindow::run(const QString& label, Work::Task task, std::function<void()> then) {
    give_up_work();
    then_ = std::move(then);
    progress_->begin(label);
    const auto look = [this] {
        if (!work_) return;
        progress_->at(work_->progress());
        if (!work_->ended()) return;
        const auto ended = std::move(work_);
        const auto next = std::move(then_);
        progress_->end();
        guarded([&] {
            if (ended->finish()) next();
        });
        refresh_actions();
    };
    work_ = std::make_unique<Work>(std::move(task), [this, look] {
        QMetaObject::invokeMethod(this, look, Qt::QueuedConnection);
    });
}

void MainWindow::give_up_work() {
    work_.reset();
    then_ = nullptr;
    progress_->end();
}

void MainWindow::load(const app::VolumeOptions& volume, Then then) {
    auto result = std::make_shared<std::shared_ptr<Opened>>();
    run(
        tr("Reading %1").arg(short_name(QString::fromStdString(volume.volume))),
        [result, volume](const io::Progress& progress) {
            *result = std::make_shared<Opened>(open(volume, progress));
        },
        [result, then = std::move(then)] { then(*result); });
}

/// The same, without reading what is open already.
void MainWindow::load_or_reuse(const app::VolumeOptions& volume, Then then) {
    if (!opened_ || app::to_names(opened_->options) != app::to_names(volume)) {
        return load(volume, std::move(then));
    }
    give_up_work();
    guarded([&] { then(opened_); });
}

void MainWindow::open_path(const QString& path) {
    if (!path.startsWith("synthetic:")) {
        QSettings().setValue("folder", QFileInfo(path).absolutePath());
    }
    if (path.endsWith(".json", Qt::CaseInsensitive)) return open_session(path);
    if (path.endsWith(".csv", Qt::CaseInsensitive)) return open_recording(path);
    app::VolumeOptions volume;
    volume.volume = path.toStdString();
    open_volume(volume);
}

/// Those of the command line. Its level and recording are for the first volume only.
app::TouchOptions MainWindow::options_once() {
    app::TouchOptions options = options_;
    options_.field.isovalue.clear();
    options_.record.clear();
    return options;
}

void MainWindow::open_volume(const app::VolumeOptions& volume) {
    problem_.clear();
    load(volume, [this, options = options_once()](std::shared_ptr<Opened> opened) mutable {
        options.volume = opened->options;
        options.device = options_.device;
        if (options.field.isovalue.empty()) {
            options.field.isovalue = fmt::format("{}", first_isovalue(*opened));
        }
        begin(std::move(opened), options);
        use_usual_look();
    });
}

/// Feels it. What was felt before ends first: a device serves one session.
void MainWindow::begin(std::shared_ptr<Opened> opened, const app::TouchOptions& options) {
    close_all();
    live_ = std::make_unique<Live>(opened->loaded, options);
    opened_ = std::move(opened);
    show_volume(live_->field(), live_->isovalue(), live_->settings(), live_->device());
    show_data();
    look_from_hand(live_->settings().transform);
    views_->set_window(opened_->dark(), opened_->bright());
    QString words = tr("Felt through the device %1").arg(QString::fromStdString(options.device));
    for (const std::string& sentence : live_->privileges()) {
        words += "; " + QString::fromStdString(sentence);
    }
    show_done(words);
    show_devices();
    use_pointer_for(live_->mouse() != nullptr);
    if (!options.record.empty()) start_recording(QString::fromStdString(options.record));
    remember(QString::fromStdString(opened_->options.volume));
    for (const std::string& note : opened_->loaded.notes) show_done(QString::fromStdString(note));
}

void MainWindow::use_usual_look() {
    const Volume& volume = opened_->loaded.volume;
    Look look = panel_->look();
    look.transfer =
        preset(suggested_preset(opened_->histogram, volume), opened_->histogram, volume);
    panel_->set_look(look);
    views_->set_look(look);
}

/// The whole volume, as the person sees it who holds the device.
void MainWindow::look_from_hand(const DeviceTransform& transform) {
    views_->scene().reset_camera();
    views_->scene().look_from({transform.rotation.col(2), transform.rotation.col(1)});
}

/// Back to an empty window.
void MainWindow::close_all() {
    stop_recording();
    live_.reset();
    playback_.reset();
    held_.reset();
    opened_.reset();
    shown_isovalue_.reset();
    time_line_->hide();
    show_data();
    views_->clear();
    panel_->clear();
    setWindowTitle("Palpate");
    refresh_actions();
}

void MainWindow::show_volume(const Field& field, double isovalue, const RendererSettings& settings,
                             const DeviceInfo& device) {
    shown_isovalue_ = isovalue;
    views_->set_field(field, isovalue);
    panel_->set_session(field, opened_->histogram, isovalue, settings, device);
    setWindowTitle(short_name(QString::fromStdString(opened_->loaded.name)) + " – Palpate");
    refresh_actions();
}

void MainWindow::open_recording(const QString& path) {
    problem_.clear();
    guarded([&] {
        const io::RecordingReader reader(path_of(path));
        const auto volume = app::recorded_volume(reader.head(), path_of(path));
        (void)options_once();  // they were for a volume to feel
        load_or_reuse(volume, [this, path](std::shared_ptr<Opened> opened) {
            play(std::move(opened), path);
        });
    });
}

void MainWindow::play(std::shared_ptr<Opened> opened, const QString& path) {
    auto result = std::make_shared<std::optional<Playback>>();
    run(
        tr("Reading %1").arg(short_name(path)),
        [result, opened, path](const io::Progress& progress) {
            *result = Playback::read(path_of(path), opened->loaded, progress);
        },
        [this, result, opened, path] {
            const bool same = opened_ == opened;
            close_all();
            opened_ = opened;
            playback_ = std::move(*result);
            const io::RecordingHead& head = playback_->head();
            DeviceInfo device;
            device.name = device.model = head.device;
            device.limits = head.settings.device;
            show_volume(playback_->field(), head.isovalue, head.settings, device);
            if (!same) use_usual_look();
            look_from_hand(head.settings.transform);
            views_->set_window(opened->dark(), opened->bright());
            panel_->set_observing(true);
            use_pointer_for(false);
            time_line_->set_playback(*playback_);
            time_line_->show();
            show_time(playback_->begin());
            remember(path);
            QString words = tr("%1 ticks").arg(playback_->ticks());
            if (!playback_->complete()) words += tr("; the recording was cut off before its end");
            if (playback_->different() > 0) {
                words += tr("; %1 of them come out otherwise than they were recorded")
                             .arg(playback_->different());
            }
            show_done(words);
        });
}

void MainWindow::show_time(double time) {
    if (!playback_) return;
    shown_time_ = time;
    time_line_->set_time(time);
}

/// Feels the volume of the recording, at the level and in the view that were shown.
void MainWindow::leave_playback() {
    if (!playback_) return;
    SessionFile session = session_now();
    session.isovalue = shown_isovalue_.value_or(session.isovalue);
    session.settings.reset();  // the recorded device's
    resume(opened_, session, options_);
}

void MainWindow::start_recording(const QString& path) {
    if (!live_) return;
    guarded([&] {
        live_->record(path_of(path));
        show_done(tr("Recording to %1").arg(path));
    });
    refresh_actions();
}

void MainWindow::stop_recording() {
    if (!live_ || !live_->recording()) return;
    guarded([&] {
        const int before = std::exchange(exit_status_, app::bad_output);  // unless it is whole
        show_done(tr("%1 ticks recorded").arg(live_->stop_recording()));
        exit_status_ = before;
    });
    refresh_actions();
}

void MainWindow::save_picture(const QString& path, bool whole_window) {
    const QImage image = whole_window ? grab().toImage() : views_->scene().picture();
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    image.save(&buffer, "PNG");
    io::PendingFile file(path_of(path));
    file.write({bytes.constData(), static_cast<std::size_t>(bytes.size())});
    file.commit();
    show_done(tr("Saved %1").arg(path));
}

void MainWindow::remember(const QString& path) {
    const QString name = path.startsWith("synthetic:") ? path : QFileInfo(path).absoluteFilePath();
    QSettings settings;
    QStringList recent = settings.value("recent").toStringList();
    recent.removeAll(name);
    recent.prepend(name);
    settings.setValue("recent", QStringList(recent.mid(0, most_recent)));
}

}  // namespace palpate::viewer

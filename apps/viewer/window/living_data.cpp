// Data that change while they are felt: the brush, undo, saving; and sequences.
#include <QAction>
#include <QApplication>
#include <QDir>
#include <QFileInfo>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <cstdio>
#include <utility>

#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/panel/sequence_bar.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/views.hpp"
#include "palpate/io/raw_options.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::viewer {
namespace {

std::optional<app::HandBrush> hand_brush(const BrushChoice& choice) {
    if (!choice.on) return std::nullopt;
    return app::HandBrush{choice.kind, choice.radius, choice.hardness, choice.rate, choice.value};
}

SequenceView sequence_view(const app::PlayView& play) {
    SequenceView view;
    view.begin = play.begin;
    view.end = play.end;
    view.frames = play.frames;
    view.time = play.time;
    view.speed = play.speed;
    view.loop = play.loop;
    view.loaded_from = play.loaded_from;
    view.loaded_to = play.loaded_to;
    view.live = play.live;
    return view;
}

}  // namespace

void MainWindow::connect_data() {
    connect(panel_, &Panel::brush_changed, this, &MainWindow::use_brush);
    connect(panel_, &Panel::undo_asked, this, [this] { undo(false); });
    connect(panel_, &Panel::redo_asked, this, [this] { undo(true); });
    connect(panel_, &Panel::save_asked, this, &MainWindow::ask_save_volume);
    const auto play = [this](auto&& action) {
        if (live_ && live_->data().is_sequence()) guarded([&] { action(live_->data().player()); });
    };
    connect(sequence_bar_, &SequenceBar::speed_asked, this,
            [play](double speed) { play([&](app::Player& player) { player.play(speed); }); });
    connect(sequence_bar_, &SequenceBar::moment_asked, this,
            [play](double time) { play([&](app::Player& player) { player.seek(time); }); });
    connect(sequence_bar_, &SequenceBar::loop_asked, this,
            [play](bool loop) { play([&](app::Player& player) { player.set_loop(loop); }); });
}

void MainWindow::make_data_menu() {
    QMenu* menu = menuBar()->addMenu(tr("&Data"));
    add(menu, "brush_action", tr("&Brush at the probe"), QKeySequence("B"),
        [this] { panel_->toggle_brush(); });
    add(menu, "undo_action", tr("&Undo"), QKeySequence::Undo, [this] {
        undo(false);
    })->setAutoRepeat(true);
    add(menu, "redo_action", tr("&Redo"), QKeySequence("Ctrl+Shift+Z"), [this] {
        undo(true);
    })->setAutoRepeat(true);
    add(menu, "save_volume", tr("&Save the volume…"), QKeySequence("Ctrl+Shift+S"),
        [this] { ask_save_volume(); });
    menu->addSeparator();
    add(menu, "play_sequence", tr("&Play the sequence, or pause it"), QKeySequence("K"),
        [this] { sequence_bar_->toggle_playing(); });
    add(menu, "frame_back", tr("A frame &back"), QKeySequence(","), [this] {
        sequence_bar_->step(-1);
    })->setAutoRepeat(true);
    add(menu, "frame_on", tr("A frame &on"), QKeySequence("."), [this] {
        sequence_bar_->step(1);
    })->setAutoRepeat(true);
}

/// What the data are when a session begins.
void MainWindow::show_data() {
    const bool sequence = live_ && live_->data().is_sequence();
    sequence_bar_->setVisible(sequence);
    shown_data_ = {};
    if (!live_) return;
    panel_->set_edit_reason(
        sequence ? tr("A sequence cannot be edited: open one frame of it (--time-step).") : "");
    use_brush(panel_->brush());
    if (sequence) sequence_bar_->set_view(sequence_view(live_->data().player().view()));
}

/// Brings scene and slices to the samples that are felt.
void MainWindow::observe_data(const Snapshot& now) {
    Field field = live_ ? live_->data().field() : playback_->field_at(now);
    field.set_time(now.session.moment);
    const Moment& moment = field.moment();
    const Moment& shown = shown_data_.moment;
    const bool same = field.shared_samples() == shown_data_.samples && moment.from == shown.from &&
                      moment.to == shown.to && moment.weight == shown.weight;
    if (!same) {
        shown_data_ = {field.shared_samples(), moment};
        views_->update_field(field);
    }
    if (!live_ || rounds_ % 2 != 0) return;
    if (live_->data().is_sequence()) {
        const app::PlayView play = live_->data().player().view();
        sequence_bar_->set_view(sequence_view(play));
        const QString problem = QString::fromStdString(play.problem);
        if (problem != std::exchange(data_problem_, problem) && !problem.isEmpty()) {
            show_problem(problem);
        }
        return;
    }
    const app::Work work = live_->data().sculptor().work();
    panel_->set_history(work.undo_steps, work.redo_steps, work.changed);
    const QString problem = QString::fromStdString(work.problem);
    if (problem != std::exchange(data_problem_, problem) && !problem.isEmpty()) {
        show_done(problem);
    }
}

void MainWindow::use_brush(const BrushChoice& brush) {
    if (!live_ || live_->data().is_sequence()) return;
    try {
        live_->data().sculptor().set_brush(hand_brush(brush));
    } catch (const std::invalid_argument& e) {
        panel_->show_refused(QString::fromStdString(e.what()));
    }
}

void MainWindow::undo(bool again) {
    if (!live_ || live_->data().is_sequence()) return;
    guarded([&] {
        app::Sculptor& sculptor = live_->data().sculptor();
        if (!(again ? sculptor.redo() : sculptor.undo())) {
            show_done(again ? tr("There is nothing to redo") : tr("There is nothing to undo"));
        }
    });
}

/// Under the extension that the volume has, if it can be written.
void MainWindow::ask_save_volume() {
    if (!live_) return;
    const QString name = QString::fromStdString(opened_->options.volume);
    const std::string kind(io::written_extension_of(opened_->options.volume));
    const QString suffix = kind.empty() ? "nrrd" : QString::fromStdString(kind.substr(1));
    QString base = QFileInfo(name).fileName();
    if (base.startsWith("synthetic:")) base = base.section(':', 1, 1);
    if (base.endsWith("." + suffix, Qt::CaseInsensitive)) base.chop(suffix.size() + 1);
    const QString path = ask_save(tr("Save the volume"), base + "-edited." + suffix, suffix, true);
    if (!path.isEmpty()) save_volume(path);
}

/// In the background; the session goes on.
void MainWindow::save_volume(const QString& path) {
    if (!live_ || saving_) return;
    // Held until it is written: the samples as they are now, whatever is done to them meanwhile.
    const Field field = live_->data().field();
    bool good = false;
    guarded([&] {
        app::check_volume_name(path.toStdString(), field.geometry());
        good = true;
    });
    if (!good) return;
    auto samples = std::make_shared<std::shared_ptr<const Samples>>(field.shared_samples());
    const Moment moment = field.moment();
    const std::filesystem::path file(path.toStdString());
    show_done(tr("Saving %1").arg(path));
    const auto words = QString::fromStdString(io::opening_words(file, field.volume()));
    const auto look = [this, path, words, samples] {
        if (!saving_ || !saving_->ended()) return;
        const auto ended = std::move(saving_);
        guarded([&] {
            if (!ended->finish()) return;
            if (live_ && !live_->data().is_sequence()) {
                live_->data().sculptor().set_saved(*samples);
            }
            show_done(tr("Saved %1").arg(path) + words);
        });
    };
    saving_ = std::make_unique<Work>(
        [file, samples, moment](const io::Progress& progress) {
            io::WriteOptions options;
            options.progress = progress;
            io::write_volume(flattened(**samples, moment), file, options);
        },
        [this, look] { QMetaObject::invokeMethod(this, look, Qt::QueuedConnection); });
}

/// For a signal: nobody is asked, and nothing is lost.
void MainWindow::end() {
    timer_.stop();
    std::shared_ptr<const Samples> edited;
    if (live_ && !live_->data().is_sequence()) {
        const app::Work work = live_->data().sculptor().work();
        if (work.changed) edited = work.samples;
    }
    stop_recording();
    live_.reset();  // forces first
    if (edited) rescue_edits(edited);
    QApplication::exit(0);
}

void MainWindow::rescue_edits(const std::shared_ptr<const Samples>& samples) {
    const QString name = QDir::temp().filePath(
        QString("palpate-edits-%1.nrrd").arg(QCoreApplication::applicationPid()));
    try {
        io::write_volume(flattened(*samples), name.toStdString());
        std::fprintf(stderr, "palpate: the edits that were not saved are in %s\n",
                     name.toLocal8Bit().constData());
    } catch (const std::exception& e) {
        std::fprintf(stderr, "palpate: the edits could not be kept: %s\n", e.what());
    }
}

/// False if the person would rather keep edits that were not saved.
bool MainWindow::may_lose_edits() {
    if (saving_) {
        show_done(tr("The volume is still being saved"));
        return false;
    }
    if (!live_ || live_->data().is_sequence() || !live_->data().sculptor().work().changed) {
        return true;
    }
    QMessageBox box(QMessageBox::Question, tr("Palpate"),
                    tr("The volume was edited, and not saved since. Lose the edits?"),
                    QMessageBox::Discard | QMessageBox::Cancel, this);
    box.setObjectName("lose_edits");
    box.setDefaultButton(QMessageBox::Cancel);
    return box.exec() == QMessageBox::Discard;
}

}  // namespace palpate::viewer

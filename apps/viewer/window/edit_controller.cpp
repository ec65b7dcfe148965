// Passes brush and undo to the editor of the live run; saves the volume in the background.
#include "apps/viewer/window/edit_controller.hpp"

#include <QCoreApplication>
#include <QDir>
#include <QFileInfo>
#include <QMessageBox>
#include <cstdio>
#include <utility>

#include "apps/viewer/panel/brush_controls.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/io/raw_options.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::viewer {
EditController::EditController(Content& content, Panel& panel, Messages& messages, QWidget* window)
    : content_(content), panel_(panel), messages_(messages), window_(window), saving_(messages) {
    connect(&content, &Content::run_changed, this, &EditController::show);
    connect(&panel, &Panel::brush_changed, this, &EditController::use_brush);
    connect(&panel, &Panel::undo_asked, this, &EditController::undo);
    connect(&panel, &Panel::redo_asked, this, &EditController::redo);
    connect(&panel, &Panel::save_asked, this, &EditController::ask_save);
}

void EditController::show() {
    panel_.brush_controls().set_reason(
        content_.player() ? "A sequence cannot be edited: open one frame of it (--time-step)."
                          : QString());
    use_brush(panel_.brush());
}

void EditController::use_brush(const BrushChoice& brush) {
    run::VolumeEditor* editor = content_.editor();
    if (!editor) return;
    try {
        editor->set_brush(brush.on ? std::optional<run::HandBrush>(brush) : std::nullopt);
    } catch (const std::invalid_argument& e) {
        panel_.show_refused(QString::fromStdString(e.what()));
    }
}

void EditController::undo() {
    step(&run::VolumeEditor::undo, "There is nothing to undo");
}

void EditController::redo() {
    step(&run::VolumeEditor::redo, "There is nothing to redo");
}

void EditController::step(bool (run::VolumeEditor::*take)(), const char* if_none) {
    messages_.guarded([&] {
        run::VolumeEditor* editor = content_.editor();
        if (editor && !(editor->*take)()) messages_.show_done(if_none);
    });
}

void EditController::observe() {
    const run::VolumeEditor* editor = content_.editor();
    if (!editor) return;
    const run::EditState state = editor->state();
    panel_.brush_controls().set_history(state.undo_steps, state.redo_steps, state.changed);
    const QString problem = QString::fromStdString(state.problem);
    if (problem != std::exchange(problem_, problem) && !problem.isEmpty()) {
        messages_.show_done(problem);
    }
}

void EditController::ask_save() {
    if (!content_.live()) return;
    const std::string& volume = content_.volume()->loaded.name;
    const std::string kind(io::written_extension_of(volume));
    const QString suffix = kind.empty() ? "nrrd" : QString::fromStdString(kind.substr(1));
    QString base = QFileInfo(QString::fromStdString(volume)).fileName();
    if (base.startsWith("synthetic:")) base = base.section(':', 1, 1);
    if (base.endsWith("." + suffix, Qt::CaseInsensitive)) base.chop(suffix.size() + 1);
    const QString path =
        ask_save_name(window_, "Save the volume", base + "-edited." + suffix, suffix);
    if (!path.isEmpty()) save(path);
}

void EditController::save(const QString& path) {
    if (!content_.live() || saving()) return;
    const std::filesystem::path file(path.toStdString());
    // The samples as they are now, whatever is done to them while they are written.
    const Field field = content_.live()->field_now();
    if (!messages_.guarded([&] { run::check_volume_name(file.string(), field.geometry()); })) {
        return;
    }
    const auto samples = field.shared_samples();
    const QString words = QString::fromStdString(io::opening_words(file, field.volume()));
    messages_.show_done(QString("Saving %1").arg(path));
    saving_.start(
        QString("Saving %1").arg(path),
        [file, samples, moment = field.moment()](const io::Progress& progress) {
            io::WriteOptions options;
            options.progress = progress;
            io::write_volume(flattened(*samples, moment), file, options);
        },
        [this, path, words, samples] {
            if (run::VolumeEditor* editor = content_.editor()) editor->set_saved(samples);
            messages_.show_done(QString("Saved %1").arg(path) + words);
        });
}

bool EditController::may_lose_edits() {
    if (saving()) {
        messages_.show_done("The volume is still being saved");
        return false;
    }
    if (!unsaved()) return true;
    QMessageBox box(QMessageBox::Question, "Palpate",
                    "The volume was edited, and not saved since. Lose the edits?",
                    QMessageBox::Discard | QMessageBox::Cancel, window_);
    box.setObjectName("lose_edits");
    box.setDefaultButton(QMessageBox::Cancel);
    return box.exec() == QMessageBox::Discard;
}

std::shared_ptr<const Samples> EditController::unsaved() const {
    const run::VolumeEditor* editor = content_.editor();
    if (!editor) return nullptr;
    const run::EditState state = editor->state();
    return state.changed ? state.samples : nullptr;
}

void rescue_edits(const Samples& samples) {
    const QString name = QDir::temp().filePath(
        QString("palpate-edits-%1.nrrd").arg(QCoreApplication::applicationPid()));
    try {
        io::write_volume(flattened(samples), name.toStdString());
        std::fprintf(stderr, "palpate: the edits that were not saved are in %s\n",
                     name.toLocal8Bit().constData());
    } catch (const std::exception& e) {
        std::fprintf(stderr, "palpate: the edits could not be kept: %s\n", e.what());
    }
}

}  // namespace palpate::viewer

// Saves the volume and its surface in the background.
#include "apps/viewer/window/save_controller.hpp"

#include <QCoreApplication>
#include <QDir>
#include <QFileInfo>
#include <QMessageBox>
#include <QPushButton>
#include <cstdio>
#include <utility>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/scene/render_mesh.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/layers_controls.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/panel.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/io/raw_options.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::viewer {
namespace {

/// The source that opens this file or folder again.
run::Source source_of(const QString& path, const Volume& volume) {
    run::Source source =
        run::source_from({{"volume", QFileInfo(path).absoluteFilePath().toStdString()}});
    if (auto* file = std::get_if<run::FileSource>(&source.from); file && path.endsWith(".raw")) {
        const Geometry& geometry = volume.geometry();
        file->raw = io::RawLayout{geometry.size, volume.type(), geometry.spacing};
        file->spacing = geometry.spacing;
    }
    return source;
}

SurfaceMesh surface_of(const Field& field, double isovalue, const io::Progress& progress) {
    SurfaceOptions options;
    options.normals = true;
    options.progress = [&](double fraction) {
        progress(fraction);
        return true;
    };
    return extract_surface(field, isovalue, options);
}

/// The filter of a dialog: all that a volume can be saved as.
QString saved_volumes() {
    QStringList patterns;
    for (const std::string_view extension : io::written_extensions()) {
        patterns << "*" + QString::fromUtf8(extension.data(), int(extension.size()));
    }
    return SaveController::tr("Volumes (%1)").arg((patterns << "*.zarr").join(' '));
}

}  // namespace

SaveController::SaveController(const Desk& desk, Panel& panel)
    : Controller(desk), panel_(panel), saving_(messages_) {
    connect(&panel_.brush_controls(), &BrushControls::save_wanted, this, [this] { ask_save(); });
}

void SaveController::ask_save(std::function<void()> then) {
    if (!content_.live()) return;
    const std::string volume = run::name_of(content_.source());
    const std::string kind(io::written_extension_of(volume));
    const bool streamed = content_.data()->is_streamed();
    const QString suffix = streamed       ? "zarr"
                           : kind.empty() ? "nrrd"
                                          : QString::fromStdString(kind.substr(1));
    const QFileInfo name(QDir::cleanPath(QString::fromStdString(volume)));
    QString base = streamed ? name.completeBaseName() : name.fileName();
    if (base.startsWith("synthetic:")) base = base.section(':', 1, 1);
    if (base.endsWith("." + suffix, Qt::CaseInsensitive)) base.chop(suffix.size() + 1);
    if (!content_.saved_elsewhere()) base += "-edited";
    const QString path =
        ask_save_name(messages_.window(), tr("Save the volume"), base + "." + suffix, suffix,
                      streamed ? tr("Zarr images (*.zarr)") : saved_volumes());
    if (!path.isEmpty()) save(path, std::move(then));
}

void SaveController::save(const QString& path, std::function<void()> then) {
    if (!content_.live() || saving()) return;
    const std::filesystem::path file(path.toStdString());
    const std::shared_ptr<run::Data> data = content_.data();
    const auto check = [&] {
        data->require_saving();
        data->check_save_name(file.string());
    };
    if (!messages_.guarded(check)) return;
    const QString words =
        data->is_streamed()
            ? tr(": it opens as the edited volume while the original stays where it is")
            : QString::fromStdString(io::opening_words(file, data->loaded().volume));
    saving_.start(
        tr("Saving %1").arg(short_name(path)),
        [file, data](const io::Progress& progress) { data->save(file, progress); },
        [this, path, words, data, then = std::move(then)] {
            // Of a sequence only one frame was saved.
            if (content_.data() == data && content_.editor()) {
                // The source can be determined only now.
                content_.set_saved(source_of(path, data->loaded().volume));
                remember_file(path);
            }
            messages_.show_done(tr("Saved %1").arg(path) + words);
            if (then) then();
        });
}

void SaveController::ask_save_surface() {
    const std::string volume = run::name_of(content_.source());
    const auto kind = static_cast<int>(io::written_extension_of(volume).size());  // .nii.gz is one
    const QFileInfo name(QString::fromStdString(volume));
    const QString base = kind > 0 ? name.fileName().chopped(kind) : name.completeBaseName();
    const QString path = ask_save_name(
        messages_.window(), tr("Save the surface (.ply, .stl, .obj or .vtp)"),
        base.section(':', -1) + ".ply", "ply", tr("Meshes (*.ply *.stl *.obj *.vtp)"));
    if (!path.isEmpty()) save_surface(path);
}

void SaveController::save_surface(const QString& path) {
    if (!content_.live() || saving()) return;
    const std::filesystem::path file(path.toStdString());
    if (!messages_.guarded([&] { (void)io::mesh_format_from(file); })) return;
    const Field field = content_.seen(content_.felt());
    const double isovalue =
        panel_.layers_controls().chosen_level().value_or(content_.live()->isovalue());
    const auto mesh = std::make_shared<SurfaceMesh>();
    saving_.start(
        tr("Making the surface"),
        [=](const io::Progress& progress) { *mesh = surface_of(field, isovalue, progress); },
        [this, path, mesh] { write_surface(path, mesh); });
}

/// Offers to simplify a large one.
void SaveController::write_surface(const QString& path, const std::shared_ptr<SurfaceMesh>& mesh) {
    std::size_t most = mesh->triangles.size();
    if (most > many_triangles_) {
        QMessageBox box(QMessageBox::Question, "Palpate",
                        tr("The surface has %1 triangles, more than many programs can work with. "
                           "Simplify it to about %2? It stays closed, and what is left of its "
                           "points stays on the surface.")
                            .arg(count_text(double(most)), count_text(double(many_triangles_))),
                        QMessageBox::Yes | QMessageBox::No | QMessageBox::Cancel,
                        messages_.window());
        box.setObjectName("simplify");
        box.button(QMessageBox::Yes)->setText(tr("Simplify"));
        box.button(QMessageBox::No)->setText(tr("All triangles"));
        const int answer = messages_.answer_to(box);
        if (answer == QMessageBox::Cancel) return;
        if (answer == QMessageBox::Yes) most = many_triangles_;
    }
    const auto write = [=](const io::Progress& progress) {
        if (most < mesh->triangles.size()) *mesh = decimated(*mesh, most, progress);
        io::write_mesh(*mesh, path.toStdString(), progress);
    };
    saving_.start(tr("Saving %1").arg(short_name(path)), write, [this, path, mesh] {
        const auto triangles = static_cast<int>(mesh->triangles.size());
        messages_.show_done(
            tr("Saved %1, %2 triangles", nullptr, triangles).arg(path, count_text(triangles)));
    });
}

bool SaveController::may_lose_edits(const std::function<void()>& once_saved) {
    return go_on(tr("The volume was edited, and not saved since. Save it?"), {}, once_saved);
}

void SaveController::save_edits_first(const std::function<void()>& action) {
    const bool at_once = go_on(tr("This will name the volume's file, which has not the latest "
                                  "edits. Save the volume first?"),
                               tr("Without the edits"), action);
    if (at_once) action();
}

/// Asks, if there are unsaved edits.
bool SaveController::go_on(const QString& question, const QString& without,
                           const std::function<void()>& once_saved) {
    if (saving()) {
        messages_.show_done(tr("The volume is still being saved"));
        return false;
    }
    return !unsaved() || messages_.may_lose("lose_edits", question, without,
                                            [this, once_saved] { ask_save(once_saved); });
}

std::shared_ptr<const Samples> SaveController::unsaved() const {
    const run::VolumeEditor* editor = content_.editor();
    if (!editor) return nullptr;
    const run::EditState state = editor->state();
    return state.changed ? state.samples : nullptr;
}

void rescue_edits(run::Data& data) {
    try {
        std::fprintf(stderr, "palpate: the edits that were not saved are in %s\n",
                     data.rescue().c_str());
    } catch (const std::exception& e) {
        std::fprintf(stderr, "palpate: the edits could not be kept: %s\n", e.what());
    }
}

}  // namespace palpate::viewer

// Reads and writes sets of layers, and says what a person should know of them.
#include "apps/viewer/window/layers_controller.hpp"

#include <QFile>
#include <QRegularExpression>
#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/panel/layers_controls.hpp"
#include "apps/viewer/panel/look_controls.hpp"
#include "apps/viewer/panel/overlay_controls.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/overlay_controller.hpp"
#include "palpate/run/labels.hpp"

namespace palpate::viewer {

LayersController::LayersController(const Desk& desk, OverlayController& overlays)
    : Controller(desk), overlays_(overlays), reader_(messages_) {
    try {
        for (io::LayersPreset& preset : io::layers_presets()) {
            files_.push_back(std::move(preset.file));
        }
    } catch (const io::InputError&) {
        // Without the folder of the built-in ones there are those that are opened.
    }
    connect(&content_, &Content::closed, this, [this] { reader_.abandon(); });
    connect(&content_, &Content::run_changed, this, [this] {
        offer();
        show_overlay();
    });
    connect(&overlays, &OverlayController::changed, this, &LayersController::offer);
    connect(&panel_.look_controls(), &LookControls::look_changed, this, [this] {
        if (overlays_.overlay() && overlays_.overlay()->is_label_map()) offer();
    });
    LayersControls& controls = panel_.layers_controls();
    connect(&controls, &LayersControls::open_wanted, this, &LayersController::ask_open);
    connect(&controls, &LayersControls::save_wanted, this, &LayersController::ask_save);
    connect(&controls, &LayersControls::labels_wanted, this, &LayersController::place);
    connect(&panel_.overlay_controls(), &OverlayControls::feel_wanted, this,
            &LayersController::feel_labels);
}

bool LayersController::is_layers_file(const QString& path) {
    constexpr qint64 largest = qint64{16} << 20;  // [bytes] far more than any has
    QFile file(path);
    if (!path.endsWith(".json", Qt::CaseInsensitive)) return false;
    if (file.size() > largest || !file.open(QIODevice::ReadOnly)) return false;
    const QByteArray text = file.readAll();
    return text.contains("\"palpate_layers\"") && !text.contains("\"palpate-session\"");
}

/// What a label map has to have, and whether there is one.
void LayersController::limit_to_labels(LayersChoice& choice) const {
    const auto& overlay = overlays_.overlay();
    if (!overlay || !overlay->is_label_map()) {
        choice.possible = false;
        choice.note =
            tr("These layers are by label: open a label map over the volume first (page Data)");
        return;
    }
    const std::string missing = missing_labels(*choice.layers, *overlay);
    if (missing.empty()) return;
    choice.note = tr("The label map has no label %1").arg(QString::fromStdString(missing));
}

LayersChoice LayersController::choice_of(const io::LayersFile& file) const {
    const run::LoadedVolume& loaded = content_.volume()->loaded;
    LayersChoice choice;
    const auto layers =
        std::make_shared<const Layers>(io::layers_for(file, content_.live()->field().volume()));
    choice.layers = layers;
    choice.about = QString::fromStdString(file.about);
    choice.note = QString::fromStdString(run::layers_warning(file, loaded));
    if (!choice.note.isEmpty()) choice.note[0] = choice.note[0].toUpper();
    const std::string& units = loaded.values.units;
    const bool own_units = file.units.empty() || file.units == "%";
    choice.possible = own_units || units.empty() || units == file.units;
    if (layers->by_label) limit_to_labels(choice);
    try {
        check(*layers, content_.live()->field().solid());
    } catch (const std::invalid_argument& e) {
        choice.possible = false;
        choice.note = QString::fromStdString(e.what());
    }
    return choice;
}

/// Of those that are shown.
LayersChoice LayersController::choice_of_labels(const Overlay& labels) const {
    const auto& hidden = panel_.look_controls().look().overlay.hidden;
    LayersChoice choice = choice_of(layers_of(labels, hidden));
    choice.about = tr(
        "A layer for each label of the label map. A surface between two labels has the properties "
        "of the later one in the list.");
    return choice;
}

/// Those that suit the volume without a note come first, and the labels of a label map before all.
void LayersController::offer() {
    if (!content_.live()) return;
    std::vector<LayersChoice> choices;
    const auto& overlay = overlays_.overlay();
    const bool labels = overlay && overlay->is_label_map();
    if (labels) {
        choices.push_back(choice_of_labels(*overlay));
    }
    for (const io::LayersFile& file : files_) {
        choices.push_back(choice_of(file));
        if (!labels) continue;
        if (const auto named = by_name(file, *overlay)) choices.push_back(choice_of(*named));
    }
    const auto rank = [](const LayersChoice& choice) {
        return choice.possible ? choice.note.isEmpty() ? 0 : 1 : 2;
    };
    std::ranges::stable_sort(choices, {}, rank);
    panel_.layers_controls().set_choices(std::move(choices));
}

void LayersController::feel_labels() {
    const auto& overlay = overlays_.overlay();
    if (!overlay || !content_.live()) return;
    const LayersChoice choice = choice_of_labels(*overlay);
    if (choice.layers->layers.empty()) {
        return messages_.show_problem(tr("All labels are hidden: show those to feel"));
    }
    if (!choice.possible) {
        return messages_.show_problem(
            tr("%1. Hide labels in the list to feel the others").arg(choice.note));
    }
    use(choice);
}

void LayersController::use(const LayersChoice& choice) {
    if (lack_labels(choice.layers)) return place(choice.layers);
    panel_.layers_controls().use(choice.layers);
    panel_.layers_controls().say(choice.note);
}

/// Looks up where their labels lie, and feels them.
void LayersController::place(const SharedLayers& layers) {
    const std::shared_ptr<const Overlay> overlay = overlays_.overlay();
    if (!overlay || !overlay->is_label_map()) return;
    const auto found = std::make_shared<SharedLayers>();
    reader_.start(
        tr("Looking for the labels"),
        [layers, overlay, found](const io::Progress&) {
            *found = std::make_shared<const Layers>(placed(*layers, *overlay));
        },
        [this, found] { panel_.layers_controls().use(*found); });
}

void LayersController::restore(const SessionFile& session, const QString& file) {
    const auto read = std::make_shared<std::map<int, SharedLayers>>();  // by hand
    const auto note = [&](const SessionHand& one, int hand) {
        if (one.settings && lack_labels(one.settings->layers)) {
            read->emplace(hand, one.settings->layers);
        }
    };
    note(session, 1);
    int hand = 1;
    for (const SessionHand& other : session.others) note(other, ++hand);
    if (read->empty()) return;
    reader_.start(
        tr("Reading the labels"),
        [read, from = std::filesystem::path(file.toStdString())](const io::Progress&) {
            for (auto& [hand, layers] : *read) layers = run::with_labels(layers, from);
        },
        [this, read] { content_.use_layers(*read); });
}

/// Layers by label are seen in their label map.
void LayersController::show_overlay() {
    const SharedLayers layers = content_.layers();
    if (!layers || !layers->by_label || layers->label_volume.empty()) return;
    if (overlays_.overlay() || overlays_.loader().busy()) return;
    overlays_.open(run::source_named(layers->label_volume));
}

void LayersController::ask_open() {
    if (!content_.live()) return;
    const QString path = ask_open_layers_name(messages_.window());
    if (!path.isEmpty()) open(path);
}

void LayersController::open(const QString& path) {
    messages_.forget();
    if (!content_.live()) {
        return messages_.show_problem(
            tr("%1: these are layers: open a volume first, and feel it, then open them")
                .arg(short_name(path)));
    }
    messages_.guarded([&] {
        const io::LayersFile file = io::read_layers(path.toStdString());
        const LayersChoice choice = choice_of(file);
        remember_folder(path);
        if (choice.possible || file.layers.by_label) {
            files_.push_back(file);
            offer();
        }
        if (!choice.possible) {
            return messages_.show_problem(QString("%1: %2").arg(short_name(path), choice.note));
        }
        use(choice);
    });
}

void LayersController::ask_save() {
    const SharedLayers layers = panel_.layers_controls().layers();
    if (!layers || !content_.volume()) return;
    QString name = QString::fromStdString(layers->name).simplified().toLower();
    name.replace(QRegularExpression("[^a-z0-9]+"), "-");
    const QString path = ask_save_name(messages_.window(), tr("Save the layers"),
                                       (name.isEmpty() ? tr("layers") : name) + ".json", "json");
    if (!path.isEmpty()) save(path);
}

/// Levels are in the volume's units by now.
void LayersController::save(const QString& path) {
    const SharedLayers layers = panel_.layers_controls().layers();
    if (!layers || !content_.volume()) return;
    messages_.guarded([&] {
        io::LayersFile file;
        file.layers = *layers;
        file.units = content_.volume()->loaded.values.units;
        const auto from = std::ranges::find_if(
            files_, [&](const io::LayersFile& one) { return one.layers.name == layers->name; });
        if (from != files_.end()) file.about = from->about;
        io::write_layers(path.toStdString(), file);
        panel_.layers_controls().set_saved();
        messages_.show_done(tr("Saved %1").arg(path));
    });
}

}  // namespace palpate::viewer

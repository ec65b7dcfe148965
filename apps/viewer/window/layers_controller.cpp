// Reads and writes sets of layers, and says what a person should know of them.
#include "apps/viewer/window/layers_controller.hpp"

#include <QRegularExpression>
#include <algorithm>
#include <utility>

#include "apps/viewer/panel/layers_controls.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

LayersController::LayersController(Content& content, Panel& panel, Messages& messages)
    : content_(content), panel_(panel), messages_(messages) {
    try {
        for (io::LayersPreset& preset : io::layers_presets()) {
            files_.push_back(std::move(preset.file));
        }
    } catch (const io::InputError&) {
        // Without the folder of the built-in ones there are those that are opened.
    }
    connect(&content, &Content::run_changed, this, &LayersController::offer);
    LayersControls& controls = panel.layers_controls();
    connect(&controls, &LayersControls::open_wanted, this, &LayersController::ask_open);
    connect(&controls, &LayersControls::save_wanted, this, &LayersController::ask_save);
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
    try {
        check(*layers, content_.live()->field().solid());
    } catch (const std::invalid_argument& e) {
        choice.possible = false;
        choice.note = QString::fromStdString(e.what());
    }
    return choice;
}

/// Those that suit the volume without a note come first.
void LayersController::offer() {
    std::vector<LayersChoice> choices;
    for (const io::LayersFile& file : files_) choices.push_back(choice_of(file));
    const auto rank = [](const LayersChoice& choice) {
        return choice.possible ? choice.note.isEmpty() ? 0 : 1 : 2;
    };
    std::ranges::stable_sort(choices, {}, rank);
    panel_.layers_controls().set_choices(std::move(choices));
}

void LayersController::ask_open() {
    if (!content_.live()) return;
    const QString path = ask_open_layers_name(messages_.window());
    if (!path.isEmpty()) open(path);
}

void LayersController::open(const QString& path) {
    if (!content_.live()) return;
    messages_.guarded([&] {
        const io::LayersFile file = io::read_layers(path.toStdString());
        const LayersChoice choice = choice_of(file);
        if (!choice.possible) {
            return messages_.show_problem(QString("%1: %2").arg(short_name(path), choice.note));
        }
        remember_folder(path);
        files_.push_back(file);
        offer();
        panel_.layers_controls().use(choice.layers);
        panel_.layers_controls().say(choice.note);
    });
}

void LayersController::ask_save() {
    const SharedLayers layers = panel_.layers_controls().layers();
    if (!layers || !content_.volume()) return;
    QString name = QString::fromStdString(layers->name).simplified().toLower();
    name.replace(QRegularExpression("[^a-z0-9]+"), "-");
    const QString path = ask_save_name(messages_.window(), "Save the layers",
                                       (name.isEmpty() ? "layers" : name) + ".json", "json");
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
        messages_.show_done(QString("Saved %1").arg(path));
    });
}

}  // namespace palpate::viewer

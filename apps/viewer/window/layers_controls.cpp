// Offers, reads and writes sets of layers, says what a person should know of them, and changes
// those in use.
#include "apps/viewer/window/layers_controls.hpp"

#include <QRegularExpression>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/sentences.hpp"
#include "apps/viewer/panel/stroke_plot.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/overlay_controls.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/run/labels.hpp"

namespace palpate::viewer {
namespace {

/// [range] Levels stay so far apart.
constexpr double least_gap = 1e-3;

}  // namespace

LayersControls::LayersControls(const Desk& desk, LookControls& look, OverlayControls& overlays)
    : EffectForm(desk.effect()),
      Desk(desk),
      look_(look),
      overlays_(overlays),
      reader_(messages_),
      choice_(named(new QComboBox, "layers", tr("Layers: several surfaces in one stroke"))),
      note_(new Note(this, "layers_note", Note::Kind::plain)),
      touched_(named(new QLabel, "touched_layers",
                     tr("The layer that is touched, and those that the proxy is in"))),
      list_(named(new QListWidget, "layer_list")),
      factors_(new LevelChart),
      plot_(new StrokePlot) {
    setObjectName("layers_controls");
    each_time(this, [this](QWidget&) {
        show_choice();
        show_list();
        if (!layers()) plot_->clear();
    });
    touched_->setTextFormat(Qt::PlainText);
    touched_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
    auto* clear = button(
        {"clear_stroke", tr("Clear"), tr("Clear the plot of force by depth"), tr("Clear the plot")},
        [this] { plot_->clear(); });
    auto* body = column_of({row_of({touched_, clear}, 0), plot_, make_list()});
    each_time(body, [this](QWidget& one) { one.setVisible(layers() != nullptr); });
    column_in(this, {make_choice(), body});
    try {
        for (io::LayersPreset& preset : io::layers_presets()) {
            files_.push_back(std::move(preset.file));
        }
    } catch (const io::InputError&) {
        // Without the folder of the built-in ones there are those that are opened.
    }
    built_in_ = files_.size();
    connect(&content_, &Content::closed, this, [this] { reader_.abandon(); });
    connect(&content_, &Content::run_changed, this, [this] {
        offer();
        show_label_map();
    });
    connect(&overlays, &OverlayControls::overlay_changed, this, &LayersControls::offer);
    connect(&overlays, &OverlayControls::feel_wanted, this, &LayersControls::feel_labels);
    connect(&look, &LookControls::look_changed, this, [this] {
        if (overlays_.overlay() && overlays_.overlay()->is_label_map()) offer();
    });
    refresh();
}

void LayersControls::choose_set(int at) {
    const auto set = static_cast<std::size_t>(at) - 1;
    if (at == 0) return use(nullptr);
    if (set >= choices_.size()) return;  // the one in use
    const SharedLayers layers = choices_[set].layers;
    if (!lack_labels(layers)) return use(layers);
    show_choice();  // the one in use, until it has its labels
    place(layers);
}

/// There is nothing to undo.
void LayersControls::begin() {
    constexpr int bins = 256;
    const Volume& volume = effect_.field().volume();
    low_ = volume.minimum();
    high_ = low_ + volume.range();
    factors_->set_data(run::gradients_of(volume, bins), {});
    history_.clear();
    note_->say({});
    plot_->clear();
    plot_->set_ruler(ruler_of(effect_.field().geometry()));
}

void LayersControls::clear() {
    history_.clear();
    choices_.clear();
    note_->say({});
}

void LayersControls::set_choices(std::vector<LayersChoice> choices) {
    choices_ = std::move(choices);
    show_choice();
}

bool LayersControls::unsaved() const {
    if (!layers() || !history_.can_undo() || same(layers(), saved_)) return false;
    const auto is_it = [this](const LayersChoice& one) { return same(one.layers, layers()); };
    return std::ranges::none_of(choices_, is_it);
}

/// A change that continues the last one is one step with it.
void LayersControls::edit(const SharedLayers& next, const QString& key) {
    const bool goes_on = !key.isEmpty() && key == last_key_ && since_edit_.isValid() &&
                         since_edit_.elapsed() < one_step_ms_;
    const SharedLayers before = layers();
    if (!request(next)) return;
    history_.keep(before, goes_on);
    last_key_ = key;
    since_edit_.start();
    refresh();
}

bool LayersControls::request(const SharedLayers& next) {
    // Edited layers keep their names: what gave way stays open.
    const bool same_surfaces =
        layers() && next &&
        std::ranges::equal(layers()->layers, next->layers, {}, &Layer::name, &Layer::name);
    return effect_.request(command::UseLayers{next, same_surfaces});
}

void LayersControls::change(const QString& key, const std::function<void(Layers&)>& how) {
    if (!layers()) return;
    Layers next = *layers();
    how(next);
    edit(std::make_shared<const Layers>(std::move(next)), key);
}

Parts<Layers> LayersControls::whole(const QString& key) {
    return {[this]() -> const Layers& { return all(); },
            [this, key](const std::function<void(Layers&)>& how) { change(key, how); }};
}

Parts<Layer> LayersControls::chosen_part(const QString& key) {
    return {[this]() -> const Layer& {
                static const Layer none;
                return chosen() < 0 ? none : all().layers[static_cast<std::size_t>(chosen())];
            },
            [this, key](const std::function<void(Layer&)>& how) {
                if (chosen() < 0) return;
                const auto row = static_cast<std::size_t>(chosen());
                change(key + QString::number(row), [&](Layers& next) { how(next.layers[row]); });
            }};
}

void LayersControls::use(const SharedLayers& layers) {
    const auto known = std::ranges::find_if(
        choices_, [&](const LayersChoice& one) { return same(one.layers, layers); });
    note_->say(layers && known != choices_.end() ? known->note : QString());
    edit(layers);
    choose_layer(0);
}

LevelRoom LayersControls::room(int layer) const {
    return room_of(all(), static_cast<std::size_t>(layer), gap());
}

void LayersControls::move_level(int layer, double level) {
    if (layer < 0 || layer >= levels()) return;
    const auto [low, high] = room(layer);
    const double within = std::isfinite(level) ? std::clamp(level, low, high) : level;
    change(QString("level %1").arg(layer), [layer, within](Layers& next) {
        next.layers[static_cast<std::size_t>(layer)].level = within;
    });
}

void LayersControls::set_knots(Curve PropertyCurves::*curve, const Knots& knots) {
    const char* const which = curve == &PropertyCurves::density ? "curve" : "factors";
    change(QString("%1 %2").arg(which).arg(knots.size()),
           [&](Layers& next) { (next[property_].*curve).knots = knots; });
}

void LayersControls::set_curve(const Knots& knots) {
    set_knots(&PropertyCurves::density, knots);
}

void LayersControls::add_layer() {
    if (!effect_.there()) return;
    const std::string name = tr("layer", "name of a new one, before its number").toStdString();
    if (!have_surfaces(layers())) {
        Layers first = first_layer(std::clamp(effect_.isovalue(), low_, high_), name);
        if (layers()) {  // curves without a surface
            Layers next = *layers();
            next.layers = first.layers;
            first = std::move(next);
        }
        return use(std::make_shared<const Layers>(std::move(first)));
    }
    auto [next, at] = with_another(all(), effect_.field().solid(), low_, high_, name);
    edit(std::make_shared<const Layers>(std::move(next)));
    choose_layer(static_cast<int>(at));
}

void LayersControls::remove_layer() {
    const int row = chosen();
    if (row < 0) return;
    if (count() == 1) return use(nullptr);
    change({}, [row](Layers& next) {
        next = without_layer(std::move(next), static_cast<std::size_t>(row));
    });
}

/// Of layers by label: those of levels are in the order of their levels.
void LayersControls::shift_layer(int by) {
    const int row = chosen(), to = row + by;
    if (std::min(row, to) < levels() || to >= count()) return;
    change({}, [row, to](Layers& next) {
        next = moved_layer(std::move(next), static_cast<std::size_t>(row),
                           static_cast<std::size_t>(to));
    });
    choose_layer(to);
}

void LayersControls::step(bool back) {
    const LayersHistory history = history_;
    const auto next = back ? history_.undo(layers()) : history_.redo(layers());
    if (!next) return refresh();
    last_key_.clear();
    note_->say({});
    if (request(*next)) return;
    history_ = history;
    refresh();
}

int LayersControls::chosen() const {
    return std::min(list_->currentRow(), count() - 1);
}

const Layers& LayersControls::all() const {
    static const Layers none;
    return layers() ? *layers() : none;
}

double LayersControls::gap() const {
    return least_gap * (high_ - low_);
}

std::optional<double> LayersControls::chosen_level() const {
    if (chosen() < 0 || chosen() >= levels()) return std::nullopt;
    return all().layers[static_cast<std::size_t>(chosen())].level;
}

void LayersControls::choose_layer(int layer) {
    last_key_.clear();  // what comes next is another step
    if (layer < list_->count()) list_->setCurrentRow(layer);
}

void LayersControls::show_snapshot(const Snapshot& now) {
    if (!layers()) return;
    plot_->add(now, layers());
    const QString words = felt_text(now.session.tick.layers, layers());
    const QString text = words.isEmpty() ? tr("touches no layer") : words;
    if (touched_->text() != text) touched_->setText(text);
}

bool LayersControls::is_layers(const std::string& text) {
    return text.find("\"palpate_layers\"") != text.npos &&
           text.find("\"palpate-session\"") == text.npos;
}

/// What a label map has to have, and whether there is one.
void LayersControls::limit_to_labels(LayersChoice& choice) const {
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

LayersChoice LayersControls::choice_of(const io::LayersFile& file) const {
    const run::LoadedVolume& loaded = content_.volume()->loaded;
    LayersChoice choice;
    const auto layers =
        std::make_shared<const Layers>(io::layers_for(file, content_.live()->field().volume()));
    choice.layers = layers;
    choice.about = QString::fromStdString(file.about);
    choice.note = in_words(run::layers_warning(file, loaded));
    if (!choice.note.isEmpty()) choice.note[0] = choice.note[0].toUpper();
    const std::string& units = loaded.values.units;
    const bool own_units = file.units.empty() || file.units == "%";
    choice.possible = own_units || units.empty() || units == file.units;
    if (layers->by_label) limit_to_labels(choice);
    try {
        palpate::check(*layers, content_.live()->field().solid());
    } catch (const std::invalid_argument& e) {
        choice.possible = false;
        choice.note = in_words(e.what());
    }
    return choice;
}

/// Of those that are shown.
LayersChoice LayersControls::choice_of_labels(const Overlay& labels) const {
    const auto& hidden = look_.look().overlay.hidden;
    LayersChoice choice = choice_of(layers_of(labels, hidden));
    choice.about = tr(
        "A layer for each label of the label map. A surface between two labels has the properties "
        "of the later one in the list.");
    return choice;
}

/// Those that suit the volume without a note come first, and the labels of a label map before all.
void LayersControls::offer() {
    if (!content_.live()) return;
    std::vector<LayersChoice> choices;
    const auto& overlay = overlays_.overlay();
    const bool labels = overlay && overlay->is_label_map();
    if (labels) {
        choices.push_back(choice_of_labels(*overlay));
    }
    const run::LoadedVolume& loaded = content_.volume()->loaded;
    const bool may_be_ct = !loaded.values.units.empty() || looks_like_hounsfield(loaded.volume);
    for (std::size_t i = 0; i < files_.size(); ++i) {
        const io::LayersFile& file = files_[i];
        choices.push_back(choice_of(file));
        LayersChoice& choice = choices.back();
        if (i < built_in_ && choice.possible && file.units == "HU" && !may_be_ct) {
            choice.possible = false;
            choice.note = tr("For CT in Hounsfield units, which these data do not look like");
        }
        if (!labels) continue;
        if (const auto named = by_name(file, *overlay)) choices.push_back(choice_of(*named));
    }
    const auto rank = [](const LayersChoice& choice) {
        return choice.possible ? choice.note.isEmpty() ? 0 : 1 : 2;
    };
    std::ranges::stable_sort(choices, {}, rank);
    set_choices(std::move(choices));
}

void LayersControls::feel_labels() {
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
    feel(choice);
}

void LayersControls::feel(const LayersChoice& choice) {
    if (lack_labels(choice.layers)) return place(choice.layers);
    use(choice.layers);
    note_->say(choice.note);
}

/// Looks up where their labels lie, and feels them.
void LayersControls::place(const SharedLayers& layers) {
    const std::shared_ptr<const Overlay> overlay = overlays_.overlay();
    if (!overlay || !overlay->is_label_map()) return;
    const auto found = std::make_shared<SharedLayers>();
    reader_.start(
        tr("Looking for the labels"),
        [layers, overlay, found](const io::Progress&) {
            *found = std::make_shared<const Layers>(placed(*layers, *overlay));
        },
        [this, found] { use(*found); });
}

void LayersControls::restore(const SessionFile& session, const QString& file) {
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
        [read, from = std::filesystem::path(file.toStdString()),
         volume = content_.volume()](const io::Progress&) {
            for (auto& [its, layers] : *read) {
                layers = run::with_labels(layers, from, volume->loaded);
            }
        },
        [this, read] { content_.use_layers(*read); });
}

/// Layers by label are seen in their label map.
void LayersControls::show_label_map() {
    if (!by_label() || layers()->label_volume.empty()) return;
    if (overlays_.overlay() || overlays_.loader().busy()) return;
    overlays_.open(run::source_named(layers()->label_volume));
}

void LayersControls::ask_open() {
    const QString path =
        ask_open_name(messages_.window(), tr("Open layers"), tr("Layers (*.json);;All files (*)"));
    if (!path.isEmpty()) open(path);
}

void LayersControls::open(const QString& path) {
    messages_.forget();
    remember_folder(path);
    const auto read = std::make_shared<io::LayersFile>();
    reader_.start(
        tr("Reading %1").arg(short_name(path)),
        [read, name = path.toStdString()](const io::Progress& progress) {
            *read = io::layers_from_text(io::read_text(name, progress), name);
        },
        [this, read, path] { take(path, *read); });
}

void LayersControls::take(const QString& path, const io::LayersFile& file) {
    if (!content_.live()) {
        return messages_.show_problem(
            tr("%1: these are layers: open a volume first, and feel it, then open them")
                .arg(short_name(path)));
    }
    const LayersChoice choice = choice_of(file);
    if (choice.possible || file.layers.by_label) {
        files_.push_back(file);
        offer();
    }
    if (!choice.possible) {
        return messages_.show_problem(QString("%1: %2").arg(short_name(path), choice.note));
    }
    feel(choice);
}

void LayersControls::ask_save() {
    QString name = QString::fromStdString(all().name).simplified().toLower();
    name.replace(QRegularExpression("[^a-z0-9]+"), "-");
    const QString path = ask_save_name(messages_.window(), tr("Save the layers"),
                                       (name.isEmpty() ? tr("layers") : name) + ".json", "json",
                                       tr("Layers (*.json)"));
    if (!path.isEmpty()) save(path);
}

/// Levels are in the volume's units by now.
void LayersControls::save(const QString& path) {
    messages_.guarded([&] {
        io::LayersFile file;
        file.layers = all();
        file.units = content_.volume()->loaded.values.units;
        const auto from = std::ranges::find_if(
            files_, [&](const io::LayersFile& one) { return one.layers.name == all().name; });
        if (from != files_.end()) file.about = from->about;
        io::write_layers(path.toStdString(), file);
        set_saved();
        messages_.show_done(tr("Saved %1").arg(path));
    });
}

}  // namespace palpate::viewer

// Keeps choice, list and editor of layers in step.
#include "apps/viewer/panel/layers_controls.hpp"

#include <QBoxLayout>
#include <QSignalBlocker>
#include <QStandardItemModel>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/viewer/panel/names.hpp"
#include "apps/viewer/panel/stroke_plot.hpp"

namespace palpate::viewer {
namespace {

/// [range] Levels stay so far apart.
constexpr double least_gap = 1e-3;
constexpr int most_rows = 6;  // of the list without scrolling

/// Long tips in lines.
QString wrapped(const QString& text) {
    return "<p>" + text.toHtmlEscaped() + "</p>";
}

}  // namespace

LayersControls::LayersControls(Effect& effect)
    : EffectForm(effect),
      choice_(named(new QComboBox, "layers", tr("Layers: several surfaces in one stroke"))),
      note_(new Note("layers_note", Note::Kind::plain)),
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
    column_in(this, {make_choice(), note_, body});
    refresh();
}

QWidget* LayersControls::make_choice() {
    let_wheel_pass(*choice_);
    choice_->setAccessibleName(tr("Layers"));
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choice_->setMinimumContentsLength(12);
    connect(choice_, qOverload<int>(&QComboBox::activated), this, &LayersControls::choose_set);
    auto* open = button(
        {"open_layers", tr("Open…"), tr("A set of layers from a file (JSON)"), tr("Open layers")},
        [this] { Q_EMIT open_wanted(); });
    auto* save = button(
        {"save_layers", tr("Save as…"),
         tr("This set of layers to a file (JSON), for these and other data"), tr("Save layers")},
        [this] { Q_EMIT save_wanted(); }, [this] { return layers() != nullptr; });
    auto* add = button({"add_layer", tr("Add"), {}, tr("Add a layer")}, [this] { add_layer(); });
    each_time(add, [this](QWidget& one) {
        const bool full = count() >= Layers::most_layers;
        one.setEnabled(!by_label() && !full);
        one.setToolTip(
            by_label() ? tr("The labels are chosen in the label map: show those to feel, on the "
                            "page Data, and feel them again")
            : full     ? tr("There are %1 layers at most").arg(Layers::most_layers)
                       : tr("Another layer, where levels leave the most room; the first at the "
                                "isovalue"));
    });
    auto* undo = button(
        {"undo_layers", "↶", tr("Undo the last change of layers"), tr("Undo, layers")},
        [this] { step(true); }, [this] { return history_.can_undo(); });
    auto* redo = button(
        {"redo_layers", "↷", tr("Redo the change of layers that was undone"), tr("Redo, layers")},
        [this] { step(false); }, [this] { return history_.can_redo(); });
    for (QWidget* one : {undo, redo}) one->setMaximumWidth(2 * fontMetrics().height());
    return column_of({choice_, row_of({open, save, add, undo, redo}, 1)});
}

/// Layers by label have an order instead of levels.
QWidget* LayersControls::make_list() {
    list_->setAccessibleName(tr("Layers, from outside in"));
    list_->setUniformItemSizes(true);
    connect(list_, &QListWidget::currentRowChanged, this, &LayersControls::refresh);
    each_time(list_, [this](QWidget& one) {
        one.setToolTip(by_label() ? tr("Layers by label; choose one to change it. The order says "
                                       "which one counts where two meet")
                                  : tr("Layers from outside in; choose one to change it. Their "
                                       "levels are lines to drag on the histogram"));
    });
    auto* remove = button(
        {"remove_layer", tr("Remove"), tr("Remove the chosen layer"), tr("Remove the layer")},
        [this] { remove_layer(); }, [this] { return chosen() >= 0; });
    auto* earlier = button(
        {"layer_earlier", "▲",
         tr("Earlier in the list: a surface between two labels has the "
            "properties of the later one"),
         tr("Layer earlier in the list")},
        [this] { shift_layer(-1); }, [this] { return chosen() > levels(); });
    auto* later = button(
        {"layer_later", "▼",
         tr("Later in the list: a surface between two labels has the properties "
            "of the later one"),
         tr("Layer later in the list")},
        [this] { shift_layer(1); },
        [this] { return chosen() >= levels() && chosen() + 1 < count(); });
    for (QWidget* one : {earlier, later}) {
        one->setMaximumWidth(2 * fontMetrics().height());
        each_time(one, [this](QWidget& shown) { shown.setVisible(by_label()); });
    }
    auto* buttons = row_of({remove, earlier, later});
    buttons->layout()->setAlignment(Qt::AlignLeft);
    return column_of({list_, buttons, make_layer(), make_needle(), make_curves()});
}

void LayersControls::choose_set(int at) {
    const auto set = static_cast<std::size_t>(at) - 1;
    if (at == 0) return use(nullptr);
    if (set >= choices_.size()) return;  // the one in use
    const SharedLayers layers = choices_[set].layers;
    if (!lack_labels(layers)) return use(layers);
    show_choice();  // the one in use, until it has its labels
    Q_EMIT labels_wanted(layers);
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
    history_.keep(layers(), goes_on);
    last_key_ = key;
    since_edit_.start();
    request(next);
}

void LayersControls::request(const SharedLayers& next) {
    // Edited layers keep their names: what gave way stays open.
    const bool same_surfaces =
        layers() && next &&
        std::ranges::equal(layers()->layers, next->layers, {}, &Layer::name, &Layer::name);
    effect_.request(command::UseLayers{next, same_surfaces});
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
    const auto next = back ? history_.undo(layers()) : history_.redo(layers());
    if (!next) return refresh();
    last_key_.clear();
    note_->say({});
    request(*next);
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

/// None, the sets that can be had, and the one in use where it is none of them.
void LayersControls::show_choice() {
    const QSignalBlocker quiet(choice_);
    choice_->clear();
    choice_->addItem(tr("No layers: one surface"));
    choice_->setItemData(0, wrapped(tr("The surface of the isovalue is felt")), Qt::ToolTipRole);
    int now = 0;
    bool changed = false;  // the one in use was made from one that is offered
    for (const LayersChoice& one : choices_) {
        choice_->addItem(shown_set(one.layers->name));
        const int at = choice_->count() - 1;
        choice_->setItemData(at,
                             wrapped(one.note.isEmpty() ? one.about : one.note + ". " + one.about),
                             Qt::ToolTipRole);
        auto* model = qobject_cast<QStandardItemModel*>(choice_->model());
        if (!one.possible) model->item(at)->setEnabled(false);
        if (layers() && now == 0 && same(one.layers, layers())) now = at;
        changed = changed || one.layers->name == all().name;
    }
    if (layers() && now == 0) {
        const QString name = shown_set(layers()->name);
        choice_->addItem(changed ? tr("%1 (changed)").arg(name) : name);
        now = choice_->count() - 1;
    }
    choice_->setCurrentIndex(now);
    choice_->setToolTip(now == 0 ? wrapped(tr("Several surfaces in one stroke, each with its own "
                                              "stiffness, friction and puncture force"))
                                 : choice_->itemData(now, Qt::ToolTipRole).toString());
}

/// With a mark where the device cannot render what a layer asks for.
void LayersControls::show_list() {
    const QSignalBlocker quiet(list_);
    const int row = std::clamp(list_->currentRow(), count() > 0 ? 0 : -1, count() - 1);
    while (list_->count() > count()) delete list_->takeItem(list_->count() - 1);
    while (list_->count() < count()) list_->addItem("");
    for (std::size_t at = 0; at < all().layers.size(); ++at) {
        const Layer& layer = all().layers[at];
        QListWidgetItem& item = *list_->item(static_cast<int>(at));
        item.setIcon(icon_of(colour_of(layer)));
        item.setText((is_label(all(), at) ? tr("%1   label %2") : QString("%1   %2"))
                         .arg(QString::fromStdString(layer.name), number_text(layer.level)));
        item.setToolTip({});
        const auto lowered = lowered_stiffness(all(), at, effect_.settings());
        if (!lowered) continue;
        const double asked = property_at(all(), at, HapticProperty::stiffness, effect_.settings());
        const QString rendered = number_text(*lowered, 3);
        item.setText(item.text() + "   ⚠ " + tr("rendered at %1 N/mm").arg(rendered));
        item.setToolTip(tr("The device cannot render %1 N/mm stably with this damping and "
                           "viscosity: it renders %2 N/mm")
                            .arg(number_text(asked, 3), rendered));
    }
    list_->setCurrentRow(row);
    const int rows = std::clamp(count(), 2, most_rows);
    list_->setFixedHeight(rows * (fontMetrics().height() + 4) + 6);
}

void LayersControls::show_snapshot(const Snapshot& now) {
    if (!layers()) return;
    plot_->add(now, layers());
    const QString words = felt_text(now.session.tick.layers, layers());
    const QString text = words.isEmpty() ? tr("touches no layer") : words;
    if (touched_->text() != text) touched_->setText(text);
}

}  // namespace palpate::viewer

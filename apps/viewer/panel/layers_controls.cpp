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
    : effect_(effect),
      choice_(named(new QComboBox, "layers", tr("Layers: several surfaces in one stroke"))),
      note_(new Note("layers_note", Note::Kind::plain)),
      touched_(named(new QLabel, "touched_layers",
                     tr("The layer that is touched, and those that the proxy is in"))),
      list_(named(new QListWidget, "layer_list")),
      factors_(new LevelChart),
      plot_(new StrokePlot) {
    setObjectName("layers_controls");
    factors_->setObjectName("gradient_chart");
    factors_->setAccessibleName(tr("Factor over the gradient"));
    factors_->setToolTip(
        tr("Factor over the gradient's magnitude [data units / mm]; behind it, how often there is "
           "which (logarithm).\nPoints: drag; double click adds one, right click or Del deletes. "
           "By keys:\nPage keys choose a point, arrows move it, Insert adds one.\n"
           "Ctrl-wheel zooms, shift-wheel moves, Ctrl+0 shows all again."));
    auto* body = column_of({make_stroke(), make_list()});
    each_time(body, [this](QWidget& one) { one.setVisible(layers_ != nullptr); });
    column_in(this, {make_choice(), note_, body});
    connect(&effect_, &Effect::begun, this, &LayersControls::begin);
    connect(&effect_, &Effect::ended, this, &LayersControls::clear);
    connect(&effect_, &Effect::changed, this, [this] {
        layers_ = effect_.settings().layers;
        if (!layers_) plot_->clear();
        show();
    });
    show();
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
        [this] { Q_EMIT save_wanted(); }, [this] { return layers_ != nullptr; });
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

/// What is touched, and the force so far.
QWidget* LayersControls::make_stroke() {
    touched_->setTextFormat(Qt::PlainText);
    touched_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
    auto* clear = button(
        {"clear_stroke", tr("Clear"), tr("Clear the plot of force by depth"), tr("Clear the plot")},
        [this] { plot_->clear(); });
    return column_of({row_of({touched_, clear}, 0), plot_});
}

/// Layers by label have an order instead of levels.
QWidget* LayersControls::make_list() {
    list_->setAccessibleName(tr("Layers, from outside in"));
    list_->setUniformItemSizes(true);
    connect(list_, &QListWidget::currentRowChanged, this, [this] { show(); });
    each_time(list_, [this](QWidget& one) {
        one.setToolTip(by_label() ? tr("Layers by label; choose one to change it. The order says "
                                       "which one counts where two meet")
                                  : tr("Layers from outside in; choose one to change it. Their "
                                       "levels are lines to drag on the histogram"));
    });
    const auto levels = [this] { return static_cast<int>(levels_in(layers_)); };
    auto* remove = button(
        {"remove_layer", tr("Remove"), tr("Remove the chosen layer"), tr("Remove the layer")},
        [this] { remove_layer(); }, [this] { return chosen() >= 0; });
    auto* earlier = button(
        {"layer_earlier", "▲",
         tr("Earlier in the list: a surface between two labels has the "
            "properties of the later one"),
         tr("Layer earlier in the list")},
        [this] { shift_layer(-1); }, [this, levels] { return chosen() > levels(); });
    auto* later = button(
        {"layer_later", "▼",
         tr("Later in the list: a surface between two labels has the properties "
            "of the later one"),
         tr("Layer later in the list")},
        [this] { shift_layer(1); },
        [this, levels] { return chosen() >= levels() && chosen() + 1 < count(); });
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
    layers_.reset();
    history_.clear();
    choices_.clear();
    note_->say({});
    plot_->clear();
    show();
}

void LayersControls::set_choices(std::vector<LayersChoice> choices) {
    choices_ = std::move(choices);
    show_choice();
}

bool LayersControls::unsaved() const {
    if (!layers_ || !history_.can_undo() || same(layers_, saved_)) return false;
    const auto is_it = [this](const LayersChoice& one) { return same(one.layers, layers_); };
    return std::ranges::none_of(choices_, is_it);
}

void LayersControls::request(const SharedLayers& layers) {
    if (!effect_.there()) return;
    const SharedLayers& before = effect_.settings().layers;
    // Edited layers keep their names: what gave way stays open.
    const bool same_surfaces =
        before && layers &&
        std::ranges::equal(before->layers, layers->layers, {}, &Layer::name, &Layer::name);
    effect_.request(command::UseLayers{layers, same_surfaces});
}

void LayersControls::say(const QString& note) {
    note_->say(note);
}

/// A change that continues the last one is one step with it.
void LayersControls::edit(const SharedLayers& next, const QString& key) {
    const bool goes_on = !key.isEmpty() && key == last_key_ && since_edit_.isValid() &&
                         since_edit_.elapsed() < one_step_ms_;
    history_.keep(layers_, goes_on);
    last_key_ = key;
    since_edit_.start();
    request(next);
}

void LayersControls::change(const QString& key, const std::function<void(Layers&)>& how) {
    if (!layers_) return;
    Layers next = *layers_;
    how(next);
    edit(std::make_shared<const Layers>(std::move(next)), key);
}

void LayersControls::change_layer(const QString& key, const std::function<void(Layer&)>& how) {
    if (chosen() < 0) return;
    const auto row = static_cast<std::size_t>(chosen());
    change(QString("%1 %2").arg(key).arg(row), [&](Layers& layers) { how(layers.layers[row]); });
}

void LayersControls::use(const SharedLayers& layers) {
    const auto known = std::ranges::find_if(
        choices_, [&](const LayersChoice& one) { return same(one.layers, layers); });
    note_->say(layers && known != choices_.end() ? known->note : QString());
    edit(layers, {});
    choose_layer(0);
}

LevelRoom LayersControls::room(int layer) const {
    return room_of(*layers_, static_cast<std::size_t>(layer), gap());
}

void LayersControls::move_level(int layer, double level) {
    if (layer < 0 || layer >= static_cast<int>(levels_in(layers_))) return;
    const auto [low, high] = room(layer);
    const double within = std::isfinite(level) ? std::clamp(level, low, high) : level;
    change(QString("level %1").arg(layer), [layer, within](Layers& layers) {
        layers.layers[static_cast<std::size_t>(layer)].level = within;
    });
}

void LayersControls::set_curve(const std::vector<Curve::Knot>& knots) {
    change(QString("curve %1").arg(knots.size()),
           [&](Layers& layers) { layers[property_].density.knots = knots; });
}

void LayersControls::set_factors(const std::vector<Curve::Knot>& knots) {
    change(QString("factors %1").arg(knots.size()),
           [&](Layers& layers) { layers[property_].gradient.knots = knots; });
}

/// One point, at the chosen layer's level.
void LayersControls::begin_curve() {
    const double middle = rounded_to(0.5 * (low_ + high_), gap());
    const double at = std::clamp(chosen_level().value_or(middle), low_, high_);
    set_curve({first_knot(property_, at, effect_.settings())});
}

void LayersControls::add_layer() {
    if (!effect_.there()) return;
    const std::string name = tr("layer", "name of a new one, before its number").toStdString();
    if (!have_surfaces(layers_)) {
        Layers first = first_layer(std::clamp(effect_.isovalue(), low_, high_), name);
        if (layers_) {  // curves without a surface
            Layers next = *layers_;
            next.layers = first.layers;
            first = std::move(next);
        }
        return use(std::make_shared<const Layers>(std::move(first)));
    }
    auto [next, at] = with_another(*layers_, effect_.field().solid(), low_, high_, name);
    edit(std::make_shared<const Layers>(std::move(next)), {});
    choose_layer(static_cast<int>(at));
}

void LayersControls::remove_layer() {
    const int row = chosen();
    if (row < 0) return;
    if (layers_->layers.size() == 1) return use(nullptr);
    change({}, [row](Layers& layers) {
        layers = without_layer(std::move(layers), static_cast<std::size_t>(row));
    });
}

/// Of layers by label: those of levels are in the order of their levels.
void LayersControls::shift_layer(int by) {
    const int row = chosen(), to = row + by, levels = static_cast<int>(levels_in(layers_));
    if (row < levels || to < levels || to >= static_cast<int>(layers_->layers.size())) return;
    change({}, [row, to](Layers& layers) {
        layers = moved_layer(std::move(layers), static_cast<std::size_t>(row),
                             static_cast<std::size_t>(to));
    });
    choose_layer(to);
}

void LayersControls::step(bool back) {
    const auto next = back ? history_.undo(layers_) : history_.redo(layers_);
    if (!next) return show();
    last_key_.clear();
    note_->say({});
    request(*next);
}

int LayersControls::chosen() const {
    return std::min(list_->currentRow(), count() - 1);
}

const Layers& LayersControls::all() const {
    static const Layers none;
    return layers_ ? *layers_ : none;
}

const Layer& LayersControls::layer() const {
    static const Layer none;
    return chosen() < 0 ? none : all().layers[static_cast<std::size_t>(chosen())];
}

double LayersControls::gap() const {
    return least_gap * (high_ - low_);
}

std::optional<double> LayersControls::chosen_level() const {
    if (chosen() < 0 || chosen() >= static_cast<int>(levels_in(layers_))) return std::nullopt;
    return layer().level;
}

void LayersControls::choose_layer(int layer) {
    last_key_.clear();  // what comes next is another step
    if (layer < list_->count()) list_->setCurrentRow(layer);
}

void LayersControls::show() {
    show_choice();
    show_list();
    refresh();
}

/// None, the sets that can be had, and the one in use where it is none of them.
void LayersControls::show_choice() {
    const QSignalBlocker quiet(choice_);
    choice_->clear();
    choice_->addItem(tr("No layers: one surface"));
    choice_->setItemData(0, wrapped(tr("The surface of the isovalue is felt")), Qt::ToolTipRole);
    int now = 0;
    for (const LayersChoice& one : choices_) {
        choice_->addItem(shown_set(one.layers->name));
        const int at = choice_->count() - 1;
        choice_->setItemData(at,
                             wrapped(one.note.isEmpty() ? one.about : one.note + ". " + one.about),
                             Qt::ToolTipRole);
        auto* model = qobject_cast<QStandardItemModel*>(choice_->model());
        if (!one.possible) model->item(at)->setEnabled(false);
        if (layers_ && now == 0 && same(one.layers, layers_)) now = at;
    }
    if (layers_ && now == 0) {
        const auto made_from = std::ranges::find_if(choices_, [this](const LayersChoice& one) {
            return one.layers->name == layers_->name;
        });
        QString name = shown_set(layers_->name);
        if (made_from != choices_.end()) name = tr("%1 (changed)").arg(name);
        choice_->addItem(name);
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
    for (int i = 0; i < count(); ++i) show_item(i);
    list_->setCurrentRow(row);
    const int rows = std::clamp(count(), 2, most_rows);
    list_->setFixedHeight(rows * (fontMetrics().height() + 4) + 6);
}

void LayersControls::show_item(int row) {
    const auto at = static_cast<std::size_t>(row);
    const Layer& layer = layers_->layers[at];
    QListWidgetItem& item = *list_->item(row);
    item.setIcon(icon_of(colour_of(layer)));
    QString text = (is_label(*layers_, at) ? tr("%1   label %2") : QString("%1   %2"))
                       .arg(QString::fromStdString(layer.name), number_text(layer.level));
    const auto lowered = lowered_stiffness(*layers_, at, effect_.settings());
    if (lowered) text += "   ⚠ " + tr("rendered at %1 N/mm").arg(number_text(*lowered, 3));
    item.setText(text);
    const double asked = property_at(*layers_, at, HapticProperty::stiffness, effect_.settings());
    item.setToolTip(lowered ? tr("The device cannot render %1 N/mm stably with this damping "
                                 "and viscosity: it renders %2 N/mm")
                                  .arg(number_text(asked, 3), number_text(*lowered, 3))
                            : QString());
}

void LayersControls::show_snapshot(const Snapshot& now) {
    if (!layers_) return;
    plot_->add(now, layers_);
    const QString words = felt_text(now.session.tick.layers, layers_);
    const QString text = words.isEmpty() ? tr("touches no layer") : words;
    if (touched_->text() != text) touched_->setText(text);
}

}  // namespace palpate::viewer

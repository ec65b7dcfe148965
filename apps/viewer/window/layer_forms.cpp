// The controls of layers: the choice of a set, the list, the forms of the chosen layer, of the
// needle, and of the curves of a property.
#include <QBoxLayout>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QStandardItemModel>
#include <QToolButton>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/window/layers_controls.hpp"

namespace palpate::viewer {
namespace {

constexpr int most_rows = 6;  // of the list without scrolling

/// Long tips in lines.
QString wrapped(const QString& text) {
    return "<p>" + text.toHtmlEscaped() + "</p>";
}

}  // namespace

QWidget* LayersControls::make_choice() {
    let_wheel_pass(*choice_);
    choice_->setAccessibleName(tr("Layers"));
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choice_->setMinimumContentsLength(6);
    connect(choice_, qOverload<int>(&QComboBox::activated), this, &LayersControls::choose_set);
    auto* open = button(
        {"open_layers", tr("Open…"), tr("A set of layers from a file (JSON)"), tr("Open layers")},
        [this] { ask_open(); });
    auto* save = button(
        {"save_layers", tr("Save as…"),
         tr("This set of layers to a file (JSON), for these and other data"), tr("Save layers")},
        [this] { ask_save(); }, [this] { return layers() != nullptr; });
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
    return column_of({row_of({choice_, undo, redo}, 0), row_of({open, save, add}, 1)});
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

QWidget* LayersControls::make_layer() {
    auto* editor = named(new QWidget, "layer_editor");
    each_time(editor, [this](QWidget& one) { one.setVisible(chosen() >= 0); });
    auto* form = form_in(editor);
    auto* name = named(new QLineEdit, "layer_name", tr("Name of the layer"));
    connect(name, &QLineEdit::editingFinished, this, [this, name] {
        if (!name->isModified()) return;
        name->setModified(false);
        chosen_part("name")[&Layer::name].set(name->text().trimmed().toStdString());
    });
    each_time(name, [get = chosen_part({})[&Layer::name].get](QLineEdit& edit) {
        const QString text = QString::fromStdString(get());
        if (edit.text() != text && !(edit.hasFocus() && edit.isModified())) edit.setText(text);
    });
    const auto its = chosen_part("colour");
    auto* its_colour =
        colour({"layer_colour", "", tr("Colour of the layer")},
               {[its] { return colour_of(its.get()); },
                [its](const Colour& c) {
                    its.change([&](Layer& one) { one.colour = {c.red, c.green, c.blue}; });
                }});
    add_row(*form, tr("Name"), row_of({name, its_colour}, 0), tr("Name and colour of the layer"));
    auto* level = number(
        {"layer_level", "", {}, tr("Level of the layer")},
        {chosen_part({})[&Layer::level].get, [this](double to) { move_level(chosen(), to); }});
    add_row(*form, tr("Level"), level, {});
    each_time(level, [this, head = qobject_cast<QLabel*>(form->labelForField(level))](auto& box) {
        const bool label = chosen() >= 0 && is_label(all(), static_cast<std::size_t>(chosen()));
        box.setSingleStep(rounded_to(gap(), 1e-6));
        box.setEnabled(!label);
        head->setText(label ? tr("Label") : tr("Level"));
        for (QWidget* one : std::initializer_list<QWidget*>{&box, head}) {
            one->setToolTip(
                label ? tr("Its label: the number that its samples have in the label map")
                      : tr("Its level [data units]; also a line to drag on the histogram"));
        }
    });
    quantity_in(*form,
                {"layer_opacity", tr("Opacity"), tr("Opacity of the layer in the scene, 0 to 1"),
                 tr("Opacity of the layer")},
                parts_span, as_part(chosen_part("opacity")[&Layer::opacity]));
    for (const PropertyWords& words : property_words) add_property(*form, words);
    return editor;
}

/// A value that is not the layer's own stands in italics; a button clears one that is.
void LayersControls::add_property(QFormLayout& form, const PropertyWords& words) {
    const HapticProperty property = words.property;
    const QString name = words.name, label = tr(words.label), tip = tr(words.tip);
    auto* value = quantity(
        {name, "", {}, tr("%1 of the layer").arg(label)}, {words.unit, 0, words.high, words.step},
        {[this, property] {
             if (chosen() < 0) return 0.0;
             return property_at(all(), std::size_t(chosen()), property, effect_.settings());
         },
         [part = chosen_part(name), property](double to) {
             part.change([=](Layer& one) { one[property] = to; });
         }});
    auto* clear = named(new QToolButton, name + "_clear", tr("Clear the layer's own value"));
    clear->setText("×");
    clear->setAutoRaise(true);
    clear->setFocusPolicy(Qt::TabFocus);
    clear->setAccessibleName(tr("Clear the layer's own value: %1").arg(label));
    connect(clear, &QToolButton::clicked, this, [this, property] {
        last_key_.clear();
        chosen_part({}).change([=](Layer& one) { one[property].reset(); });
    });
    QWidget* both = row_of({value, clear}, 0);
    both->layout()->setSpacing(2);
    both->setFocusProxy(value);
    add_row(form, label, both, tip);
    if (property == HapticProperty::puncture_force) form.addRow("", make_never(*value));
    if (property == HapticProperty::drag) {
        each_time(value, [this](QWidget& one) { one.setEnabled(all().needle.has_value()); });
    }
    each_time(both, [this, property, tip, value, clear](QWidget& row) {
        if (chosen() < 0) return;
        const auto at = static_cast<std::size_t>(chosen());
        Layers cleared = all();
        cleared.layers[at][property].reset();
        const bool own = all().layers[at][property].has_value();
        const bool curve = !all()[property].density.knots.empty();
        QFont font = value->box().font();
        font.setItalic(!own);
        value->box().setFont(font);
        row.setToolTip(own     ? tip
                       : curve ? tr("%1.\nNow from its curve over density").arg(tip)
                               : tr("%1.\nNow from the session's value (Force)").arg(tip));
        clear->setEnabled(own);
        const double without = property_at(cleared, at, property, effect_.settings());
        clear->setToolTip(
            (curve ? tr("Clear the layer's own value: then its curve over density, %1, counts")
                   : tr("Clear the layer's own value: then the session's value (Force), %1, "
                        "counts"))
                .arg(std::isfinite(without) ? number_text(without, 3) : tr("never gives way")));
    });
}

QWidget* LayersControls::make_never(Quantity& puncture) {
    puncture.box().set_infinite(true);
    each_time(&puncture, [this](Quantity& one) {
        if (std::isfinite(one.value())) last_puncture_ = one.value();
        one.setEnabled(std::isfinite(one.value()));
    });
    return check({"layer_never", tr("never gives way"),
                  tr("The surface holds, however hard the hand presses")},
                 {[&puncture] { return !std::isfinite(puncture.value()); },
                  [this, part = chosen_part("never")](bool never) {
                      const double most =
                          never ? std::numeric_limits<double>::infinity() : last_puncture_;
                      part.change([=](Layer& one) { one[HapticProperty::puncture_force] = most; });
                  }});
}

QWidget* LayersControls::make_needle() {
    auto *both = new QWidget, *numbers = new QWidget;
    auto *form = form_in(both), *rows = form_in(numbers);
    length_in(*form,
              {"layers_closing", tr("Closes after"),
               tr("A surface that gave way closes when the proxy is farther than this from where "
                  "it did, in the volume"),
               tr("Distance at which surfaces close")},
              {"mm", 0.1, 20, 0.1, Quantity::Scale::factors}, whole("closing")[&Layers::closing]);
    const auto needle = whole("needle")[&Layers::needle];
    form->addRow(check(
        {"needle", tr("Needle"),
         tr("The hand holds a needle: after the first puncture it moves along a line")},
        {[needle] { return needle.get().has_value(); },
         [needle](bool on) { needle.set(on ? std::optional<Needle>(Needle{}) : std::nullopt); }}));
    form->addRow(numbers);
    each_time(numbers, [needle](QWidget& one) { one.setVisible(needle.get().has_value()); });
    const auto add = [&](const Words& words, double Needle::*member, const Span& span) {
        const auto its = whole(words.name)[&Layers::needle];
        quantity_in(*rows, words, span,
                    {[its, member] { return its.get().value_or(Needle{}).*member; },
                     [its, member](double value) {
                         Needle next = its.get().value_or(Needle{});
                         next.*member = value;
                         its.set(next);
                     }});
    };
    add({"needle_lateral", tr("Lateral stiffness"),
         tr("How stiffly the needle is drawn to its line [N/mm]")},
        &Needle::lateral_stiffness, {"N/mm", 0, 1, 0.05});
    add({"needle_static_ratio", tr("Static ratio"),
         tr("Friction along the shaft at rest, of that in motion (no unit, 1 or more)")},
        &Needle::static_ratio, {"", 1, 3, 0.05});
    add({"needle_stick_speed", tr("Stick speed"),
         tr("Slower than this along its line, the shaft sticks [mm/s]")},
        &Needle::stick_speed, {"mm/s", 0, 10, 0.5});
    return both;
}

/// Buttons to begin a curve with one knot, and to remove it.
QWidget* LayersControls::make_curve(Curve PropertyCurves::*curve, const QString& label,
                                    const Words& start, const Words& remove,
                                    std::function<Curve::Knot()> first) {
    const auto there = [this, curve] { return !(all()[property_].*curve).knots.empty(); };
    auto* begin = button(
        start, [this, curve, first] { set_knots(curve, {first()}); }, [there] { return !there(); });
    auto* end = button(
        remove, [this, curve] { set_knots(curve, {}); }, there);
    return row_of({new QLabel(label), begin, end}, 0);
}

/// Over density, which lies on the histogram, and over the gradient, on a chart of its own.
QWidget* LayersControls::make_curves() {
    each_time(new Note(this, "curve_note", Note::Kind::plain), [this](Note& note) {
        const bool hidden = !all()[property_].density.knots.empty() && count() > 0 &&
                            std::ranges::all_of(all().layers, [this](const Layer& one) {
                                return one[property_].has_value();
                            });
        note.say(hidden ? tr("Each layer has a value of its own: clear one (×) to let the curve "
                             "count.")
                        : "");
    });
    auto* over_density = make_curve(
        &PropertyCurves::density, tr("over density"),
        {"start_curve", tr("Start"),
         tr("Begin a curve of this property: one point, with the value that counts so far.\nOn "
            "the histogram: double click for another point, drag it, right click or Del to delete "
            "it"),
         tr("Start the curve")},
        {"remove_curve", tr("Remove"), tr("Remove this curve"), tr("Remove the curve")}, [this] {
            const double middle = rounded_to(0.5 * (low_ + high_), gap());
            const double at = std::clamp(chosen_level().value_or(middle), low_, high_);
            return first_knot(property_, at, effect_.settings());
        });
    auto* over_gradient = make_curve(
        &PropertyCurves::gradient, tr("over the gradient"),
        {"start_gradient", tr("Start"),
         tr("Begin a factor over the gradient's magnitude: the property, wherever it comes from, "
            "is multiplied by it.\nSteep places, where two tissues meet, then feel different from "
            "flat ones"),
         tr("Start the factor over the gradient")},
        {"remove_gradient", tr("Remove"), tr("Remove the factor over the gradient"),
         tr("Remove the factor over the gradient")},
        [this] {
            const LevelAxis axis = factors_->whole_axis();
            return Curve::Knot{rounded_to(0.5 * (axis.low + axis.high), axis.step()), 1};
        });
    factors_->setObjectName("gradient_chart");
    factors_->setAccessibleName(tr("Factor over the gradient"));
    factors_->setToolTip(
        tr("Factor over the gradient's magnitude [data units / mm]; behind it, how often there is "
           "which (logarithm).\nPoints: drag; double click adds one, right click or Del deletes. "
           "By keys:\nPage keys choose a point, arrows move it, Insert adds one.\n"
           "Ctrl-wheel zooms, shift-wheel moves, Ctrl+0 shows all again."));
    connect(factors_, &LevelChart::curve_changed, this,
            [this](const Knots& knots) { set_knots(&PropertyCurves::gradient, knots); });
    each_time(factors_, [this](LevelChart& chart) {
        const Knots& knots = all()[property_].gradient.knots;
        chart.set_curve({knots});
        chart.setVisible(!knots.empty());
    });
    auto* which = make_property();
    auto* column = column_of(
        {row_of({label_for(tr("Curve"), which), which}, 1), over_density, over_gradient, factors_});
    column->layout()->setSpacing(2);
    return column;
}

/// The one whose curves are shown.
QComboBox* LayersControls::make_property() {
    QStringList labels;
    for (const PropertyWords& words : property_words) labels << tr(words.label);
    auto* which = choice({"curve_property", "",
                          tr("The property whose curve over density lies over the histogram; in "
                             "brackets the number of points of its curves.\nA layer that has no "
                             "value of its own takes it from there."),
                          tr("Property of the curves")},
                         labels,
                         {[this] { return static_cast<int>(property_); },
                          [this](int at) {
                              property_ = static_cast<HapticProperty>(at);
                              last_key_.clear();
                              Q_EMIT curve_chosen();
                          }});
    which->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    which->setMinimumContentsLength(8);
    return each_time(which, [this, labels](QComboBox& box) {
        for (int i = 0; i < haptic_property_count; ++i) {
            const PropertyCurves& curves = all()[static_cast<HapticProperty>(i)];
            const auto points = curves.density.knots.size() + curves.gradient.knots.size();
            box.setItemText(
                i, points == 0 ? labels[i] : QString("%1 (%2)").arg(labels[i]).arg(points));
        }
    });
}

}  // namespace palpate::viewer

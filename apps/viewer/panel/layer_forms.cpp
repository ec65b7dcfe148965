// The forms of the chosen layer, of the needle, and of the curves of a property.
#include <QLineEdit>
#include <QToolButton>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/viewer/panel/layers_controls.hpp"

namespace palpate::viewer {

QWidget* LayersControls::make_layer() {
    auto* editor = named(new QWidget, "layer_editor");
    each_time(editor, [this](QWidget& one) { one.setVisible(chosen() >= 0); });
    auto* form = form_in(editor);
    auto* name = named(new QLineEdit, "layer_name", tr("Name of the layer"));
    connect(name, &QLineEdit::editingFinished, this, [this, name] {
        if (!name->isModified()) return;
        name->setModified(false);
        const std::string text = name->text().trimmed().toStdString();
        change_layer("name", [&](Layer& layer) { layer.name = text; });
    });
    each_time(name, [this](QLineEdit& edit) {
        const QString text = QString::fromStdString(layer().name);
        if (edit.text() != text && !(edit.hasFocus() && edit.isModified())) edit.setText(text);
    });
    auto* its_colour = colour(
        {"layer_colour", "", tr("Colour of the layer")},
        {[this] { return colour_of(layer()); },
         [this](const Colour& c) {
             change_layer("colour", [&](Layer& one) { one.colour = {c.red, c.green, c.blue}; });
         }});
    add_row(*form, tr("Name"), row_of({name, its_colour}, 0), tr("Name and colour of the layer"));
    auto* level = number(
        {"layer_level", "", tr("Its level [data units]; also a line to drag on the histogram"),
         tr("Level of the layer")},
        {[this] { return layer().level; }, [this](double to) { move_level(chosen(), to); }});
    add_row(*form, tr("Level"), level, level->toolTip());
    each_time(level, [this, head = qobject_cast<QLabel*>(form->labelForField(level))](auto& box) {
        const bool label = chosen() >= 0 && is_label(all(), static_cast<std::size_t>(chosen()));
        box.setSingleStep(rounded_to(gap(), 1e-6));
        box.setEnabled(!label);
        head->setText(label ? tr("Label") : tr("Level"));
        box.setToolTip(label ? tr("Its label: the number that its samples have in the label map")
                             : tr("Its level [data units]; also a line to drag on the histogram"));
    });
    quantity_in(*form,
                {"layer_opacity", tr("Opacity"), tr("Opacity of the layer in the scene, 0 to 1"),
                 tr("Opacity of the layer")},
                parts_span,
                as_part({[this] { return layer().opacity; },
                         [this](double opacity) {
                             change_layer("opacity", [=](Layer& one) { one.opacity = opacity; });
                         }}));
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
         [this, property, name](double to) {
             change_layer(name, [=](Layer& one) { one[property] = to; });
         }});
    auto* clear = named(new QToolButton, name + "_clear", tr("Clear the layer's own value"));
    clear->setText("×");
    clear->setAutoRaise(true);
    clear->setFocusPolicy(Qt::TabFocus);
    clear->setAccessibleName(tr("Clear the layer's own value: %1").arg(label));
    connect(clear, &QToolButton::clicked, this,
            [this, property] { change_layer({}, [=](Layer& one) { one[property].reset(); }); });
    QWidget* both = row_of({value, clear}, 0);
    both->layout()->setSpacing(2);
    both->setFocusProxy(value);
    add_row(form, label, both, tip);
    if (property == HapticProperty::puncture_force) form.addRow("", make_never(value));
    if (property == HapticProperty::drag) {
        each_time(value, [this](QWidget& one) { one.setEnabled(all().needle.has_value()); });
    }
    each_time(both, [this, property, tip, value, clear](QWidget& row) {
        if (chosen() < 0) return;
        const auto at = static_cast<std::size_t>(chosen());
        const ValueFrom from = value_from(all(), at, property);
        QFont font = value->box().font();
        font.setItalic(from != ValueFrom::layer);
        value->box().setFont(font);
        row.setToolTip(from == ValueFrom::layer ? tip
                       : from == ValueFrom::curve
                           ? tr("%1.\nNow from its curve over density").arg(tip)
                           : tr("%1.\nNow from the session's value (Force)").arg(tip));
        clear->setEnabled(from == ValueFrom::layer);
        Layers cleared = all();
        cleared.layers[at][property].reset();
        const double without = property_at(cleared, at, property, effect_.settings());
        clear->setToolTip(
            (value_from(cleared, at, property) == ValueFrom::curve
                 ? tr("Clear the layer's own value: then its curve over density, "
                      "%1, counts")
                 : tr("Clear the layer's own value: then the session's value "
                      "(Force), %1, counts"))
                .arg(std::isfinite(without) ? number_text(without, 3) : tr("never gives way")));
    });
}

QWidget* LayersControls::make_never(Quantity* puncture) {
    puncture->box().set_infinite(true);
    each_time(puncture, [this](Quantity& one) {
        if (std::isfinite(one.value())) last_puncture_ = one.value();
        one.setEnabled(std::isfinite(one.value()));
    });
    return check(
        {"layer_never", tr("never gives way"),
         tr("The surface holds, however hard the hand presses")},
        {[puncture] { return !std::isfinite(puncture->value()); },
         [this](bool never) {
             const double most = never ? std::numeric_limits<double>::infinity() : last_puncture_;
             change_layer("never", [=](Layer& one) { one[HapticProperty::puncture_force] = most; });
         }});
}

QWidget* LayersControls::make_needle() {
    auto *whole = new QWidget, *numbers = new QWidget;
    auto *form = form_in(whole), *rows = form_in(numbers);
    quantity_in(*form,
                {"layers_closing", tr("Closes after"),
                 tr("A surface that gave way closes when the proxy is farther than this from where "
                    "it did [mm of the data]"),
                 tr("Distance at which surfaces close")},
                {"mm", 0.1, 20, 0.1, Quantity::Scale::factors},
                {[this] { return all().closing; },
                 [this](double value) {
                     change("closing", [=](Layers& layers) { layers.closing = value; });
                 }});
    form->addRow(
        check({"needle", tr("Needle"),
               tr("The hand holds a needle: after the first puncture it moves along a line")},
              {[this] { return all().needle.has_value(); },
               [this](bool on) {
                   change("needle", [=](Layers& layers) {
                       layers.needle = on ? std::optional<Needle>(Needle{}) : std::nullopt;
                   });
               }}));
    form->addRow(numbers);
    each_time(numbers, [this](QWidget& one) { one.setVisible(all().needle.has_value()); });
    const auto add = [&](const Words& words, double Needle::*of, const Span& span) {
        const auto set = [this, of, name = words.name](double value) {
            change(name, [=](Layers& layers) {
                if (layers.needle) (*layers.needle).*of = value;
            });
        };
        const auto get = [this, of] { return all().needle.value_or(Needle{}).*of; };
        quantity_in(*rows, words, span, {get, set});
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
    return whole;
}

/// Of which one is possible.
QWidget* LayersControls::make_ends(const QString& label, const Words& start, const Words& remove,
                                   std::function<const Knots&()> knots, std::function<void()> begin,
                                   std::function<void()> end) {
    return row_of(
        {new QLabel(label), button(start, std::move(begin), [knots] { return knots().empty(); }),
         button(remove, std::move(end), [knots] { return !knots().empty(); })},
        0);
}

/// Over density, which lies on the histogram, and over the gradient, on a chart of its own.
QWidget* LayersControls::make_curves() {
    const auto density = [this]() -> const Knots& { return all()[property_].density.knots; };
    const auto gradient = [this]() -> const Knots& { return all()[property_].gradient.knots; };
    auto* own = new Note("curve_note", Note::Kind::plain);
    each_time(own, [this, density](Note& note) {
        const bool hidden = !density().empty() && count() > 0 &&
                            std::ranges::all_of(all().layers, [this](const Layer& one) {
                                return one[property_].has_value();
                            });
        note.say(hidden ? tr("Each layer has a value of its own: clear one (×) to let the curve "
                             "count.")
                        : "");
    });
    auto* over_density = make_ends(
        tr("over density"),
        {"start_curve", tr("Start"),
         tr("Begin a curve of this property: one point, with the value that counts so far.\nOn "
            "the histogram: double click for another point, drag it, right click or Del to delete "
            "it"),
         tr("Start the curve")},
        {"remove_curve", tr("Remove"), tr("Remove this curve"), tr("Remove the curve")}, density,
        [this] { begin_curve(); }, [this] { set_curve({}); });
    auto* over_gradient = make_ends(
        tr("over the gradient"),
        {"start_gradient", tr("Start"),
         tr("Begin a factor over the gradient's magnitude: the property, wherever it comes from, "
            "is multiplied by it.\nSteep places, where two tissues meet, then feel different from "
            "flat ones"),
         tr("Start the factor over the gradient")},
        {"remove_gradient", tr("Remove"), tr("Remove the factor over the gradient"),
         tr("Remove the factor over the gradient")},
        gradient,
        [this] {
            const LevelAxis axis = factors_->whole_axis();
            set_factors({{rounded_to(0.5 * (axis.low + axis.high), axis.step()), 1}});
        },
        [this] { set_factors({}); });
    auto* whole = new QWidget;
    column_in(whole, {make_property(), over_density, own, over_gradient, factors_})->setSpacing(2);
    connect(factors_, &LevelChart::curve_changed, this, &LayersControls::set_factors);
    each_time(factors_, [gradient](LevelChart& chart) {
        chart.set_curve({gradient()});
        chart.setVisible(!gradient().empty());
    });
    return whole;
}

/// The one whose curves are shown.
QWidget* LayersControls::make_property() {
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
    each_time(which, [this, labels](QComboBox& box) {
        for (int i = 0; i < haptic_property_count; ++i) {
            const PropertyCurves& curves = all()[static_cast<HapticProperty>(i)];
            const auto points = curves.density.knots.size() + curves.gradient.knots.size();
            box.setItemText(
                i, points == 0 ? labels[i] : QString("%1 (%2)").arg(labels[i]).arg(points));
        }
    });
    return row_of({label_for(tr("Curve"), which), which}, 1);
}

}  // namespace palpate::viewer

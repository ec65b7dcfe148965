// Makes the forms of a layer, of curves and of the needle, and draws force over depth.
#include "apps/viewer/panel/layer_editor.hpp"

#include <QBoxLayout>
#include <QFormLayout>
#include <QPainter>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/level_axis.hpp"
#include "apps/viewer/panel/level_chart.hpp"

namespace palpate::viewer {

namespace {

constexpr auto puncture_row = static_cast<std::size_t>(HapticProperty::puncture_force);
constexpr auto drag_row = static_cast<std::size_t>(HapticProperty::drag);

}  // namespace

LayerEditor::LayerEditor()
    : name_(named(new QLineEdit, "layer_name", tr("Name of the layer"))),
      level_(named(new NumberBox, "layer_level",
                   tr("Its level [data units]; also a line to drag on the histogram"))),
      colour_(new ColourButton("layer_colour", tr("Colour of the layer"))),
      opacity_(new Quantity("layer_opacity", "", 0, 1, 0.05)),
      never_(named(new QCheckBox(tr("never gives way")), "layer_never",
                   tr("The surface holds, however hard the hand presses"))) {
    setObjectName("layer_editor");
    level_->setAccessibleName(tr("Level of the layer"));
    opacity_->set_accessible_name(tr("Opacity of the layer"));
    opacity_->setToolTip(tr("Opacity of the layer in the scene, 0 to 1"));
    auto* form = new QFormLayout(this);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    add_row(*form, tr("Name"), row_of({name_, colour_}, 0), tr("Name and colour of the layer"));
    add_row(*form, tr("Level"), level_, level_->toolTip());
    level_label_ = qobject_cast<QLabel*>(form->labelForField(level_));
    add_row(*form, tr("Opacity"), opacity_, opacity_->toolTip());
    for (const PropertyWords& words : property_words) add_property(*form, words);
    connect(name_, &QLineEdit::editingFinished, this, [this] {
        const std::string name = name_->text().trimmed().toStdString();
        if (!name_->isModified()) return;
        name_->setModified(false);
        Q_EMIT changed("name", [name](Layer& layer) { layer.name = name; });
    });
    connect(level_, qOverload<double>(&NumberBox::valueChanged), this, &LayerEditor::level_wanted);
    connect(colour_, &ColourButton::wanted, this, [this](const Colour& c) {
        Q_EMIT changed("colour", [c](Layer& layer) { layer.colour = {c.red, c.green, c.blue}; });
    });
    connect(opacity_, &Quantity::wanted, this, [this](double value) {
        const double opacity = std::clamp(value, 0.0, 1.0);
        Q_EMIT changed("opacity", [opacity](Layer& layer) { layer.opacity = opacity; });
    });
    connect(never_, &QCheckBox::clicked, this, [this](bool never) {
        const double most = never ? std::numeric_limits<double>::infinity() : last_puncture_;
        Q_EMIT changed("never",
                       [most](Layer& layer) { layer[HapticProperty::puncture_force] = most; });
    });
}

void LayerEditor::add_property(QFormLayout& form, const PropertyWords& words) {
    Row row{
        new Quantity(words.name, words.unit, 0, words.high, words.step),
        named(new QToolButton, QString(words.name) + "_clear", tr("Clear the layer's own value"))};
    row.value->set_accessible_name(tr("%1 of the layer").arg(tr(words.label)));
    row.clear->setText("×");
    row.clear->setAutoRaise(true);
    row.clear->setFocusPolicy(Qt::TabFocus);
    row.clear->setAccessibleName(tr("Clear the layer's own value: %1").arg(tr(words.label)));
    QWidget* both = row_of({row.value, row.clear}, 0);
    both->layout()->setSpacing(2);
    both->setFocusProxy(row.value);
    add_row(form, tr(words.label), both, tr(words.tip));
    if (words.property == HapticProperty::puncture_force) {
        row.value->box().set_infinite(true);
        form.addRow("", never_);
    }
    connect(row.value, &Quantity::wanted, this, [this, &words](double value) {
        Q_EMIT changed(words.name,
                       [&words, value](Layer& layer) { layer[words.property] = value; });
    });
    connect(row.clear, &QToolButton::clicked, this, [this, &words, value = row.value] {
        value->drop();
        Q_EMIT changed({}, [&words](Layer& layer) { layer[words.property].reset(); });
    });
    rows_.push_back(row);
}

/// A value that is not the layer's own stands in italics.
void LayerEditor::show_property(const Row& row, const PropertyWords& words, ValueFrom from,
                                double value) {
    const bool own = from == ValueFrom::layer;
    row.value->set_value(value);
    QFont font = row.value->box().font();
    font.setItalic(!own);
    row.value->box().setFont(font);
    row.value->parentWidget()->setToolTip(
        own ? tr(words.tip)
        : from == ValueFrom::curve
            ? tr("%1.\nNow from its curve over density").arg(tr(words.tip))
            : tr("%1.\nNow from the session's value (Force)").arg(tr(words.tip)));
    row.clear->setEnabled(own);
}

void LayerEditor::show_layer(const Layers& layers, std::size_t number,
                             const RendererSettings& settings, double step) {
    const Layer& layer = layers.layers[number];
    const QString name = QString::fromStdString(layer.name);
    if (name_->text() != name && !(name_->hasFocus() && name_->isModified())) name_->setText(name);
    level_->setSingleStep(step);
    level_->show_value(layer.level);
    const bool label = is_label(layers, number);
    level_->setEnabled(!label);
    level_label_->setText(label ? tr("Label") : tr("Level"));
    level_->setToolTip(label ? tr("Its label: the number that its samples have in the label map")
                             : tr("Its level [data units]; also a line to drag on the histogram"));
    colour_->set_colour({layer.colour[0], layer.colour[1], layer.colour[2]});
    opacity_->set_value(layer.opacity);
    Layers cleared = layers;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const PropertyWords& words = property_words[i];
        show_property(rows_[i], words, value_from(layers, number, words.property),
                      property_at(layers, number, words.property, settings));
        cleared.layers[number][words.property].reset();
        const double without = property_at(cleared, number, words.property, settings);
        const QString value =
            std::isfinite(without) ? number_text(without, 3) : tr("never gives way");
        rows_[i].clear->setToolTip(
            value_from(cleared, number, words.property) == ValueFrom::curve
                ? tr("Clear the layer's own value: then its curve over density, %1, counts")
                      .arg(value)
                : tr("Clear the layer's own value: then the session's value (Force), %1, counts")
                      .arg(value));
    }
    const double puncture = rows_[puncture_row].value->value();
    const bool never = !std::isfinite(puncture);
    if (!never) last_puncture_ = puncture;
    never_->setChecked(never);
    rows_[puncture_row].value->setEnabled(!never);
    rows_[drag_row].value->setEnabled(layers.needle.has_value());
}

CurveControls::CurveControls()
    : choice_(named(new QComboBox, "curve_property",
                    tr("The property whose curve over density lies over the histogram; in "
                       "brackets the number of points of its curves.\nA layer that has no value "
                       "of its own takes it from there."))),
      start_(named(new QPushButton(tr("Start")), "start_curve",
                   tr("Begin a curve of this property: one point, with the value that counts so "
                      "far.\nOn the histogram: double click for another point, drag it, right "
                      "click or Del to delete it"))),
      remove_(named(new QPushButton(tr("Remove")), "remove_curve", tr("Remove this curve"))),
      start_factors_(named(new QPushButton(tr("Start")), "start_gradient",
                           tr("Begin a factor over the gradient's magnitude: the property, "
                              "wherever it comes from, is multiplied by it.\nSteep places, where "
                              "two tissues meet, then feel different from flat ones"))),
      remove_factors_(named(new QPushButton(tr("Remove")), "remove_gradient",
                            tr("Remove the factor over the gradient"))),
      factors_(new LevelChart),
      note_(new Note("curve_note", Note::Kind::plain)) {
    choice_->setAccessibleName(tr("Property of the curves"));
    start_->setAccessibleName(tr("Start the curve"));
    remove_->setAccessibleName(tr("Remove the curve"));
    start_factors_->setAccessibleName(tr("Start the factor over the gradient"));
    remove_factors_->setAccessibleName(tr("Remove the factor over the gradient"));
    factors_->setObjectName("gradient_chart");
    factors_->set_level_shown(false);
    factors_->setAccessibleName(tr("Factor over the gradient"));
    factors_->setToolTip(
        tr("Factor over the gradient's magnitude [data units / mm]; behind it, how often there is "
           "which (logarithm).\nPoints: drag; double click adds one, right click or Del deletes. "
           "By keys:\nPage keys choose a point, arrows move it, Insert adds one.\n"
           "Ctrl-wheel zooms, shift-wheel moves, Ctrl+0 shows all again."));
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choice_->setMinimumContentsLength(8);
    for (const PropertyWords& words : property_words) {
        choice_->addItem(LayerEditor::tr(words.label));
    }
    let_wheel_pass(*choice_);
    auto* label = new QLabel(tr("Curve"));
    label->setBuddy(choice_);
    column_in(
        this,
        {row_of({label, choice_}, 1), row_of({new QLabel(tr("over density")), start_, remove_}, 0),
         note_, row_of({new QLabel(tr("over the gradient")), start_factors_, remove_factors_}, 0),
         factors_})
        ->setSpacing(2);
    connect_inputs();
}

void CurveControls::connect_inputs() {
    connect(choice_, qOverload<int>(&QComboBox::activated), this, &CurveControls::chosen);
    connect(start_, &QPushButton::clicked, this, &CurveControls::start_wanted);
    connect(remove_, &QPushButton::clicked, this, &CurveControls::remove_wanted);
    connect(start_factors_, &QPushButton::clicked, this, [this] {
        const LevelAxis axis = factors_->whole_axis();
        Q_EMIT factors_wanted({{rounded_to(0.5 * (axis.low + axis.high), axis.step()), 1}});
    });
    connect(remove_factors_, &QPushButton::clicked, this, [this] { Q_EMIT factors_wanted({}); });
    connect(factors_, &LevelChart::curve_changed, this, &CurveControls::factors_wanted);
}

void CurveControls::set_data(const run::Histogram& gradients) {
    factors_->set_data(gradients, {});
}

HapticProperty CurveControls::property() const {
    return property_words[static_cast<std::size_t>(std::max(choice_->currentIndex(), 0))].property;
}

void CurveControls::show_layers(const Layers& layers) {
    for (std::size_t i = 0; i < property_words.size(); ++i) {
        const PropertyCurves& curves = layers[property_words[i].property];
        const auto points = curves.density.knots.size() + curves.gradient.knots.size();
        const QString label = LayerEditor::tr(property_words[i].label);
        choice_->setItemText(static_cast<int>(i),
                             points == 0 ? label : QString("%1 (%2)").arg(label).arg(points));
    }
    const bool there = !layers[property()].density.knots.empty();
    start_->setEnabled(!there);
    remove_->setEnabled(there);
    const bool hidden = there && !layers.layers.empty() &&
                        std::ranges::all_of(layers.layers, [this](const Layer& layer) {
                            return layer[property()].has_value();
                        });
    const Knots& factors = layers[property()].gradient.knots;
    start_factors_->setEnabled(factors.empty());
    remove_factors_->setEnabled(!factors.empty());
    factors_->set_curve(line_of(factors));
    factors_->setVisible(!factors.empty());
    note_->say(hidden
                   ? tr("Each layer has a value of its own: clear one (×) to let the curve count.")
                   : "");
}

namespace {

QFormLayout* form_in(QWidget* owner) {
    auto* form = new QFormLayout(owner);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    return form;
}

}  // namespace

NeedleControls::NeedleControls()
    : closing_(new Quantity("layers_closing", "mm", 0.1, 20, 0.1, Quantity::Scale::factors)),
      needle_(named(new QCheckBox(tr("Needle")), "needle",
                    tr("The hand holds a needle: after the first puncture it moves along a line"))),
      numbers_(new QWidget) {
    auto* form = form_in(this);
    closing_->set_accessible_name(tr("Distance at which surfaces close"));
    add_row(*form, tr("Closes after"), closing_,
            tr("A surface that gave way closes when the proxy is farther than this from where it "
               "did [mm of the data]"));
    form->addRow(needle_);
    form->addRow(numbers_);
    connect(closing_, &Quantity::wanted, this, [this](double value) {
        Q_EMIT changed("closing", [value](Layers& layers) { layers.closing = value; });
    });
    connect(needle_, &QCheckBox::clicked, this, [this](bool on) {
        Q_EMIT changed("needle", [on](Layers& layers) {
            layers.needle = on ? std::optional<Needle>(Needle{}) : std::nullopt;
        });
    });
    form = form_in(numbers_);
    const auto add = [&](const QString& label, const QString& tip, Quantity* box,
                         double Needle::*of) {
        box->set_accessible_name(label);
        add_row(*form, label, box, tip);
        needle_numbers_.push_back({box, of});
        connect(box, &Quantity::wanted, this, [this, of, name = box->objectName()](double value) {
            Q_EMIT changed(name, [of, value](Layers& layers) {
                if (layers.needle) (*layers.needle).*of = value;
            });
        });
    };
    add(tr("Lateral stiffness"), tr("How stiffly the needle is drawn to its line [N/mm]"),
        new Quantity("needle_lateral", "N/mm", 0, 1, 0.05), &Needle::lateral_stiffness);
    add(tr("Static ratio"),
        tr("Friction along the shaft at rest, of that in motion (no unit, 1 or more)"),
        new Quantity("needle_static_ratio", "", 1, 3, 0.05), &Needle::static_ratio);
    add(tr("Stick speed"), tr("Slower than this along its line, the shaft sticks [mm/s]"),
        new Quantity("needle_stick_speed", "mm/s", 0, 10, 0.5), &Needle::stick_speed);
}

void NeedleControls::show_layers(const Layers& layers) {
    closing_->set_value(layers.closing);
    needle_->setChecked(layers.needle.has_value());
    numbers_->setVisible(layers.needle.has_value());
    if (!layers.needle) return;
    for (const Number& number : needle_numbers_) number.box->set_value((*layers.needle).*number.of);
}

StrokePlot::StrokePlot() {
    named(this, "stroke_plot",
          tr("Force over depth: the stroke so far, from its first contact, in the colours of the "
             "layers touched.\nA stroke ends two seconds after the hand has left all layers."));
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void StrokePlot::add(const Snapshot& now, const SharedLayers& layers) {
    layers_ = layers;
    if (layers && stroke_.add(now)) update();
}

void StrokePlot::clear() {
    stroke_.clear();
    update();
}

QSize StrokePlot::sizeHint() const {
    return {18 * fontMetrics().height(), 8 * fontMetrics().height()};
}

QSize StrokePlot::minimumSizeHint() const {
    return {10 * fontMetrics().height(), 6 * fontMetrics().height()};
}

QRectF StrokePlot::plot() const {
    const double line = fontMetrics().height();
    return QRectF(rect()).adjusted(6, 3, -6, -(line + 4));
}

QColor StrokePlot::colour_of(int layer) const {
    const auto at = static_cast<std::size_t>(layer);
    if (layer < 0 || !layers_ || at >= layers_->layers.size()) {
        return palette().color(QPalette::PlaceholderText);
    }
    const auto& [red, green, blue] = layers_->layers[at].colour;
    const QColor colour = QColor::fromRgbF(red, green, blue);
    // Pale colours would vanish on white, dark ones on black.
    if (is_dark(palette())) return colour.lightnessF() < 0.45 ? colour.lighter(180) : colour;
    return colour.lightnessF() > 0.55 ? colour.darker(160) : colour;
}

void StrokePlot::paint_axes(QPainter& painter, double deepest, double highest) const {
    const QRectF p = plot();
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette().color(QPalette::Mid), 1));
    painter.drawRect(p);
    painter.setPen(palette().color(QPalette::PlaceholderText));
    const QRectF below(p.left(), p.bottom() + 2, p.width(), fontMetrics().height());
    painter.drawText(below, Qt::AlignLeft, "0");
    painter.drawText(below, Qt::AlignHCenter, tr("depth"));
    painter.drawText(below, Qt::AlignRight, number_text(deepest, 2) + " mm");
    painter.drawText(p.adjusted(3, 1, 0, 0), Qt::AlignLeft | Qt::AlignTop,
                     number_text(highest, 2) + " N");
}

/// The names of the layers that were touched, in their colours.
void StrokePlot::paint_key(QPainter& painter) const {
    std::set<int> touched;
    for (const Stroke::Point& point : stroke_.points()) {
        if (point.layer >= 0) touched.insert(point.layer);
    }
    QRectF line = plot().adjusted(0, 1, -4, 0);
    for (const int layer : touched) {
        if (!layers_ || static_cast<std::size_t>(layer) >= layers_->layers.size()) continue;
        painter.setPen(colour_of(layer));
        painter.drawText(
            line, Qt::AlignRight | Qt::AlignTop,
            QString::fromStdString(layers_->layers[static_cast<std::size_t>(layer)].name));
        line.setTop(line.top() + fontMetrics().height());
    }
}

void StrokePlot::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QRectF p = plot();
    painter.fillRect(p, palette().color(QPalette::Base));
    const auto& points = stroke_.points();
    if (points.size() < 2) {
        painter.setPen(palette().color(QPalette::PlaceholderText));
        painter.drawText(p, Qt::AlignCenter, tr("force over depth: press into a layer"));
        return;
    }
    // Round ends, so that the axes do not run along with the hand.
    double deepest = 1, highest = 0.5;
    for (const Stroke::Point& point : points) {
        while (point.depth > deepest) deepest *= 2;
        while (point.force > highest) highest *= 2;
    }
    const auto place = [&](const Stroke::Point& point) {
        return QPointF(p.left() + p.width() * std::clamp(point.depth / deepest, 0.0, 1.0),
                       p.bottom() - p.height() * std::min(point.force / highest, 1.0));
    };
    for (std::size_t i = 1; i < points.size(); ++i) {
        painter.setPen(QPen(colour_of(points[i].layer), 1.5));
        painter.drawLine(place(points[i - 1]), place(points[i]));
    }
    painter.setPen(Qt::NoPen);
    painter.setBrush(palette().color(QPalette::Text));
    painter.drawEllipse(place(points.back()), 2.5, 2.5);
    paint_axes(painter, deepest, highest);
    paint_key(painter);
}

}  // namespace palpate::viewer

// Makes the form of a layer.
#include "apps/viewer/panel/layer_editor.hpp"

#include <QBoxLayout>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/property_words.hpp"

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

}  // namespace palpate::viewer

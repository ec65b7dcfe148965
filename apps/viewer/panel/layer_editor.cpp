// Makes the form of a layer.
#include "apps/viewer/panel/layer_editor.hpp"

#include <QBoxLayout>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
namespace {

struct PropertyRow {
    HapticProperty property;
    const char *label, *name, *unit;
    double high, step;  // of the slider, the box
    const char* tip;
};

constexpr std::array property_rows{
    PropertyRow{HapticProperty::stiffness, "Stiffness", "layer_stiffness", "N/mm", 3, 0.05,
                "Stiffness of the layer's surface [N/mm]"},
    PropertyRow{HapticProperty::static_friction, "Static friction", "layer_static_friction", "",
                1.5, 0.05,
                "Coefficient past which the proxy begins to slide on the surface (no unit)"},
    PropertyRow{HapticProperty::dynamic_friction, "Dynamic friction", "layer_dynamic_friction", "",
                1.5, 0.05, "Coefficient while it slides; counts as at most the static one"},
    PropertyRow{HapticProperty::viscosity, "Viscosity", "layer_viscosity", "N s/mm", 1e-3, 1e-4,
                "Of what lies behind the surface, against all motion there [N s/mm]"},
    PropertyRow{HapticProperty::puncture_force, "Puncture force", "layer_puncture_force", "N", 3,
                0.1, "Force of the press at which the surface gives way [N]"},
    PropertyRow{HapticProperty::drag, "Drag", "layer_drag", "N/mm", 0.1, 0.005,
                "Rubbing on a needle's shaft for each millimetre of it in the layer [N/mm]"}};
constexpr std::size_t puncture_row = 4;

}  // namespace

LayerEditor::LayerEditor()
    : name_(named(new QLineEdit, "layer_name", "Name of the layer")),
      level_(named(new NumberBox, "layer_level",
                   "Its level [data units]; also a line to drag on the histogram")),
      colour_(new ColourButton("layer_colour", "Colour of the layer")),
      opacity_(new Quantity("layer_opacity", "", 0, 1, 0.05)),
      never_(named(new QCheckBox("never gives way"), "layer_never",
                   "The surface holds, however hard the hand presses")) {
    setObjectName("layer_editor");
    level_->setAccessibleName("Level of the layer");
    opacity_->set_accessible_name("Opacity of the layer");
    opacity_->setToolTip("Opacity of the layer in the scene, 0 to 1");
    auto* form = new QFormLayout(this);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    add_row(*form, "Name", row_of({name_, colour_}, 0), "Name and colour of the layer");
    add_row(*form, "Level", level_, level_->toolTip());
    add_row(*form, "Opacity", opacity_, opacity_->toolTip());
    for (std::size_t i = 0; i < property_rows.size(); ++i) add_property(*form, i);
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

void LayerEditor::add_property(QFormLayout& form, std::size_t row) {
    const PropertyRow& made = property_rows[row];
    auto* quantity = new Quantity(made.name, made.unit, 0, made.high, made.step);
    quantity->set_accessible_name(QString("%1 of the layer").arg(made.label));
    add_row(form, made.label, quantity, made.tip);
    if (row == puncture_row) {
        quantity->box().set_infinite(true);
        form.addRow("", never_);
    }
    connect(quantity, &Quantity::wanted, this, [this, &made](double value) {
        Q_EMIT changed(made.name, [&made, value](Layer& layer) { layer[made.property] = value; });
    });
    properties_.push_back(quantity);
}

void LayerEditor::show_layer(const Layers& layers, std::size_t number,
                             const RendererSettings& settings, double step) {
    const Layer& layer = layers.layers[number];
    const QString name = QString::fromStdString(layer.name);
    if (name_->text() != name && !(name_->hasFocus() && name_->isModified())) name_->setText(name);
    level_->setSingleStep(step);
    level_->show_value(layer.level);
    colour_->set_colour({layer.colour[0], layer.colour[1], layer.colour[2]});
    opacity_->set_value(layer.opacity);
    for (std::size_t i = 0; i < property_rows.size(); ++i) {
        properties_[i]->set_value(property_at(layers, number, property_rows[i].property, settings));
    }
    const double puncture = properties_[puncture_row]->value();
    const bool never = !std::isfinite(puncture);
    if (!never) last_puncture_ = puncture;
    never_->setChecked(never);
    properties_[puncture_row]->setEnabled(!never);
}

}  // namespace palpate::viewer

// Makes the form of closing and needle.
#include "apps/viewer/panel/needle_controls.hpp"

#include <QFormLayout>

#include <optional>

#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
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

}  // namespace palpate::viewer

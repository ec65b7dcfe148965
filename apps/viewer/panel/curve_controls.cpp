// Names the curves, and says where one has no effect.
#include "apps/viewer/panel/curve_controls.hpp"

#include <QBoxLayout>

#include <algorithm>

#include "apps/viewer/panel/layer_editor.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/number_box.hpp"
#include "apps/viewer/panel/property_words.hpp"

namespace palpate::viewer {

CurveControls::CurveControls()
    : choice_(named(new QComboBox, "curve_property",
                    tr("The property whose curve over density lies over the histogram; in "
                       "brackets the number of its points.\nA layer that has no value of its "
                       "own takes it from there."))),
      start_(named(new QPushButton(tr("Start")), "start_curve",
                   tr("Begin a curve of this property: one point, with the value that counts so "
                      "far.\nOn the histogram: double click for another point, drag it, right "
                      "click or Del to delete it"))),
      remove_(named(new QPushButton(tr("Remove")), "remove_curve", tr("Remove this curve"))),
      note_(new Note("curve_note", Note::Kind::plain)) {
    choice_->setAccessibleName(tr("Curve over density"));
    start_->setAccessibleName(tr("Start the curve"));
    remove_->setAccessibleName(tr("Remove the curve"));
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choice_->setMinimumContentsLength(8);
    for (const PropertyWords& words : property_words) {
        choice_->addItem(LayerEditor::tr(words.label));
    }
    let_wheel_pass(*choice_);
    auto* label = new QLabel(tr("Curve"));
    label->setBuddy(choice_);
    column_in(this, {row_of({label, choice_, start_, remove_}, 1), note_})->setSpacing(2);
    connect(choice_, qOverload<int>(&QComboBox::activated), this, &CurveControls::chosen);
    connect(start_, &QPushButton::clicked, this, &CurveControls::start_wanted);
    connect(remove_, &QPushButton::clicked, this, &CurveControls::remove_wanted);
}

HapticProperty CurveControls::property() const {
    return property_words[static_cast<std::size_t>(std::max(choice_->currentIndex(), 0))].property;
}

void CurveControls::show_layers(const Layers& layers) {
    for (std::size_t i = 0; i < property_words.size(); ++i) {
        const auto& knots = layers[property_words[i].property].density.knots;
        const QString label = LayerEditor::tr(property_words[i].label);
        choice_->setItemText(
            static_cast<int>(i),
            knots.empty() ? label : QString("%1 (%2)").arg(label).arg(knots.size()));
    }
    const bool there = !layers[property()].density.knots.empty();
    start_->setEnabled(!there);
    remove_->setEnabled(there);
    const bool hidden = there && !layers.layers.empty() &&
                        std::ranges::all_of(layers.layers, [this](const Layer& layer) {
                            return layer[property()].has_value();
                        });
    note_->say(hidden
                   ? tr("Each layer has a value of its own: clear one (×) to let the curve count.")
                   : "");
}

}  // namespace palpate::viewer

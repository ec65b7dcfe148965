// Names the curves, shows that over the gradient, and says where one has no effect.
#include "apps/viewer/panel/curve_controls.hpp"

#include <QBoxLayout>

#include <algorithm>

#include "apps/viewer/panel/layer_editor.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/panel/number_box.hpp"
#include "apps/viewer/panel/property_words.hpp"

namespace palpate::viewer {

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
    factors_->set_curve(factors);
    factors_->setVisible(!factors.empty());
    note_->say(hidden
                   ? tr("Each layer has a value of its own: clear one (×) to let the curve count.")
                   : "");
}

}  // namespace palpate::viewer

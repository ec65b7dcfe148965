// The curves of a property: over density, which lies on the histogram, and over the gradient, on a
// chart of its own; where they begin and end.
#pragma once

#include <QComboBox>
#include <QPushButton>
#include <QWidget>

#include "apps/viewer/panel/curve_line.hpp"
#include "apps/viewer/panel/section.hpp"
#include "palpate/layers.hpp"

namespace palpate::viewer {

class LevelChart;

/// Object names: curve_property, start_curve, remove_curve, curve_note; start_gradient,
/// remove_gradient, gradient_chart.
class CurveControls : public QWidget {
    Q_OBJECT

  public:
    CurveControls();

    /// Of these gradients; emits nothing.
    void set_data(const run::Histogram& gradients);
    /// Shows which curves there are; emits nothing.
    void show_layers(const Layers& layers);
    /// The property whose curves are shown.
    HapticProperty property() const;

  Q_SIGNALS:
    void chosen();
    void start_wanted();
    void remove_wanted();
    /// The curve over the gradient; empty: none.
    void factors_wanted(const palpate::viewer::Knots& knots);

  private:
    void connect_inputs();

    QComboBox* choice_;
    QPushButton *start_, *remove_, *start_factors_, *remove_factors_;
    LevelChart* factors_;
    Note* note_;
};

}  // namespace palpate::viewer

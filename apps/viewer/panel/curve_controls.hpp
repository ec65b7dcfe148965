// The curve over density: which property's is shown on the histogram, where it begins and ends.
#pragma once

#include <QComboBox>
#include <QPushButton>
#include <QWidget>

#include "apps/viewer/panel/section.hpp"
#include "palpate/layers.hpp"

namespace palpate::viewer {

/// Object names: curve_property, start_curve, remove_curve, curve_note.
class CurveControls : public QWidget {
    Q_OBJECT

  public:
    CurveControls();

    /// Shows which curves there are; emits nothing.
    void show_layers(const Layers& layers);
    /// The property whose curve is shown.
    HapticProperty property() const;

  Q_SIGNALS:
    void chosen();
    void start_wanted();
    void remove_wanted();

  private:
    QComboBox* choice_;
    QPushButton *start_, *remove_;
    Note* note_;
};

}  // namespace palpate::viewer

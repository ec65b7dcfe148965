// When surfaces of layers close again, and what the needle in the hand is like.
#pragma once

#include <QCheckBox>
#include <QWidget>

#include <functional>
#include <vector>

#include "apps/viewer/panel/quantity.hpp"
#include "palpate/layers.hpp"

namespace palpate::viewer {

/// Object names: layers_closing, needle, needle_lateral, needle_static_ratio, needle_stick_speed.
class NeedleControls : public QWidget {
    Q_OBJECT

  public:
    using Change = std::function<void(Layers&)>;

    NeedleControls();

    /// Shows theirs; emits nothing.
    void show_layers(const Layers& layers);

  Q_SIGNALS:
    /// `key`: what is changed.
    void changed(const QString& key, const palpate::viewer::NeedleControls::Change& how);

  private:
    struct Number {
        Quantity* box;
        double Needle::*of;
    };

    Quantity* closing_;
    QCheckBox* needle_;
    QWidget* numbers_;
    std::vector<Number> needle_numbers_;
};

}  // namespace palpate::viewer

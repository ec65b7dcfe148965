// Name, looks and feel of one layer, and of all of them together: their curves, the needle, and the
// force along a stroke through them.
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QCoreApplication>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QToolButton>
#include <QWidget>
#include <QtGlobal>

#include <array>
#include <functional>
#include <vector>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/stroke.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/level_axis.hpp"
#include "palpate/layers.hpp"

namespace palpate::viewer {

/// Names, units and usual ranges of what layers and their curves give.
struct PropertyWords {
    HapticProperty property;
    const char *label, *name, *unit;
    double high, step;  ///< of the slider, the box
    const char* tip;
};

/// In the order of HapticProperty.
struct PropertyTable {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::LayerEditor)
  public:
    static constexpr std::array<PropertyWords, haptic_property_count> rows{
        {{HapticProperty::stiffness, QT_TR_NOOP("Stiffness"), "layer_stiffness", "N/mm", 3, 0.05,
          QT_TR_NOOP("Stiffness of the layer's surface [N/mm]")},
         {HapticProperty::static_friction, QT_TR_NOOP("Static friction"), "layer_static_friction",
          "", 1.5, 0.05,
          QT_TR_NOOP("Coefficient past which the proxy begins to slide on the surface (no unit)")},
         {HapticProperty::dynamic_friction, QT_TR_NOOP("Dynamic friction"),
          "layer_dynamic_friction", "", 1.5, 0.05,
          QT_TR_NOOP("Coefficient while it slides; counts as at most the static one")},
         {HapticProperty::damping, QT_TR_NOOP("Damping"), "layer_damping", "N s/mm", 2e-3, 1e-4,
          QT_TR_NOOP("Of the surface, against motion along its normal [N s/mm]")},
         {HapticProperty::viscosity, QT_TR_NOOP("Viscosity"), "layer_viscosity", "N s/mm", 1e-3,
          1e-4, QT_TR_NOOP("Of what lies behind the surface, against all motion there [N s/mm]")},
         {HapticProperty::puncture_force, QT_TR_NOOP("Puncture force"), "layer_puncture_force", "N",
          3, 0.1, QT_TR_NOOP("Force of the press at which the surface gives way [N]")},
         {HapticProperty::drag, QT_TR_NOOP("Drag"), "layer_drag", "N/mm", 0.1, 0.005,
          QT_TR_NOOP("Rubbing on a needle's shaft for each millimetre of it in the "
                     "layer [N/mm]; without a needle there is none")}}};
};
inline constexpr const auto& property_words = PropertyTable::rows;

inline constexpr const PropertyWords& words_of(HapticProperty property) {
    return property_words[static_cast<std::size_t>(property)];
}

/// Object names: layer_name, layer_level, layer_colour, layer_opacity, layer_stiffness and so on
/// for the properties, layer_never; with _clear, the button that clears a property.
class LayerEditor : public QWidget {
    Q_OBJECT

  public:
    using Change = std::function<void(Layer&)>;

    LayerEditor();

    /// Shows a layer; emits nothing. `step` [data units] of the level's box.
    void show_layer(const Layers& layers, std::size_t layer, const RendererSettings& settings,
                    double step);

  Q_SIGNALS:
    /// `key`: what is changed.
    void changed(const QString& key, const palpate::viewer::LayerEditor::Change& how);
    void level_wanted(double level);

  private:
    /// Of a property: its value, and the button that clears it.
    struct Row {
        Quantity* value;
        QToolButton* clear;
    };
    void add_property(QFormLayout& form, const PropertyWords& words);
    static void show_property(const Row& row, const PropertyWords& words, ValueFrom from,
                              double value);

    QLineEdit* name_;
    NumberBox* level_;
    QLabel* level_label_;
    ColourButton* colour_;
    Quantity* opacity_;
    std::vector<Row> rows_;  // as HapticProperty
    QCheckBox* never_;
    double last_puncture_ = 1;  // [N] to go back to
};

// The curves of a property: over density, which lies on the histogram, and over the gradient, on a
// chart of its own; where they begin and end.
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

/// The force of a stroke through layers over its depth, in the layers' colours.
class StrokePlot : public QWidget {
    Q_OBJECT

  public:
    StrokePlot();

    /// Takes a snapshot of a session with these layers.
    void add(const Snapshot& now, const SharedLayers& layers);
    void clear();
    const Stroke& stroke() const { return stroke_; }

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    QRectF plot() const;
    QColor colour_of(int layer) const;
    void paint_axes(QPainter& painter, double deepest, double highest) const;
    void paint_key(QPainter& painter) const;

    Stroke stroke_;
    SharedLayers layers_;
};

}  // namespace palpate::viewer

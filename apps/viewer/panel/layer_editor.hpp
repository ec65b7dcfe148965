// Name, looks and feel of one layer.
#pragma once

#include <QCheckBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QToolButton>
#include <QWidget>

#include <functional>
#include <vector>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/panel/colour_button.hpp"
#include "apps/viewer/panel/quantity.hpp"

namespace palpate::viewer {

struct PropertyWords;

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

}  // namespace palpate::viewer

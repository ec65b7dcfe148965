// Controls of the isovalue: chart, slider, number, which side is solid, how the field continues
// between samples, whether the samples are dequantized, the level felt now.
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QSlider>
#include <QWidget>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/level_chart.hpp"

namespace palpate::viewer {

class IsovalueControls : public QWidget {
    Q_OBJECT

  public:
    explicit IsovalueControls(Effect& effect);

    /// Whether the samples are dequantized, whether they could be, and why that is worth it (or
    /// nothing).
    void set_dequantized(bool on, bool possible, const QString& reason);
    LevelChart& chart() { return *chart_; }

  Q_SIGNALS:
    void field_wanted(palpate::Solid solid, palpate::Interpolation interpolation);
    void dequantize_wanted(bool on);  ///< it shows the state before until the next set_dequantized

  private:
    void connect_inputs();
    void connect_effect();
    void begin();
    void clear();
    void show();
    void show_field();
    void show_isovalue(double isovalue);
    void show_layered(const SharedLayers& layers);
    void show_felt(double isovalue, bool penetrability_on);
    void request(double isovalue);
    void ask(double isovalue);
    LevelAxis slider_axis() const;

    Effect& effect_;
    LevelChart* chart_;
    QSlider* slider_;
    NumberBox* box_;
    QComboBox *solid_, *smoothness_;
    QCheckBox* dequantize_;
    QLabel* felt_;
    Note *warning_, *overruled_, *terraces_;
    RateLimiter limiter_;
    double isovalue_ = 0;
    int differing_ = 0;  // consecutive snapshots with another level
};

}  // namespace palpate::viewer

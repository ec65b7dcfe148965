// Controls of the isovalue: chart, slider, number, which side is solid, how the field continues
// between samples, whether the samples are dequantized, the level felt now.
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QSlider>
#include <QWidget>

#include <optional>

#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/panel/number_box.hpp"
#include "apps/viewer/panel/rate_limiter.hpp"
#include "apps/viewer/panel/section.hpp"

namespace palpate::viewer {

class IsovalueControls : public QWidget {
    Q_OBJECT

  public:
    IsovalueControls();

    void set_data(const Field& field, const run::Histogram& histogram);
    void clear();
    /// Shows the level asked for; emits nothing.
    void set_isovalue(double isovalue);
    void set_field(Solid solid, Interpolation interpolation);
    /// Whether the samples are dequantized, whether they could be, and why that is worth it (or
    /// nothing).
    void set_dequantized(bool on, bool possible, const QString& reason);
    /// Whether penetrability sets the level felt.
    void set_overruled(bool overruled);
    /// Layers are felt: the isovalue does nothing. `levels`: they have levels of their own. After
    /// set_overruled().
    void set_layered(bool layered, bool levels);
    /// The level felt now; shown separately where it differs from the level asked for.
    void show_felt(double isovalue, bool penetrability_on);
    LevelChart& chart() { return *chart_; }
    void drop() { limiter_.drop(); }

  Q_SIGNALS:
    void wanted(double isovalue);  ///< at most 60 a second while something is dragged
    void field_wanted(palpate::Solid solid, palpate::Interpolation interpolation);
    void dequantize_wanted(bool on);  ///< it shows the state before until the next set_dequantized

  private:
    void connect_inputs();
    void ask(double isovalue);
    LevelAxis slider_axis() const;

    std::optional<Field> field_;
    LevelChart* chart_;
    QSlider* slider_;
    NumberBox* box_;
    QComboBox *solid_, *smoothness_;
    QCheckBox* dequantize_;
    QLabel* felt_;
    Note *warning_, *overruled_, *terraces_;
    bool layered_ = false;
    RateLimiter limiter_;
    double isovalue_ = 0;
    int differing_ = 0;  // consecutive snapshots with another level
};

}  // namespace palpate::viewer

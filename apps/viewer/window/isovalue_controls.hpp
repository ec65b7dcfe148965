// Controls of the isovalue: chart, slider, number, which side is solid, how the field continues
// between samples, whether the samples are dequantized, the level felt now.
#pragma once

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/window/desk.hpp"

namespace palpate::viewer {

struct Opened;

class IsovalueControls : public EffectForm, protected Desk {
    Q_OBJECT

  public:
    explicit IsovalueControls(const Desk& desk);

    /// Whether the samples are dequantized, whether they could be, and why that is worth it (or
    /// nothing).
    void set_dequantized(bool on, bool possible, const QString& reason);
    LevelChart& chart() { return *chart_; }

  Q_SIGNALS:
    void dequantize_wanted(bool on);  ///< it shows the state before until the next set_dequantized

  private:
    QWidget* make_field();
    void note_overruled();
    void begin() override;
    void clear() override;
    bool layered() const;
    void use_field(Solid solid, Interpolation interpolation);
    void show_terraces();
    static QString reason_to_dequantize(const Opened& opened);
    void show_felt(double isovalue, bool penetrability_on);

    LevelChart* chart_;
    Quantity* level_;
    QCheckBox* dequantize_ = nullptr;
    QLabel* felt_;
    Note* terraces_;
    int differing_ = 0;  // consecutive snapshots with another level
};

}  // namespace palpate::viewer

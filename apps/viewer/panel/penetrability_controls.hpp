// Controls of penetrability: whether surfaces give way, past which threshold, and the ranges of
// levels that are felt, which are bands on the level chart, too.
#pragma once

#include <functional>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/level_axis.hpp"

namespace palpate::viewer {

class LevelChart;

/// Object names: penetrability, threshold, add_range, and of the ranges, from N = 1, range_N_low,
/// range_N_high, range_N_remove.
class PenetrabilityControls : public Form {
    Q_OBJECT

  public:
    /// Shows and reads its bands on the chart, which it does not own.
    PenetrabilityControls(Effect& effect, LevelChart& chart);

  private:
    /// What is shown; while it is off, it is kept for later.
    struct Pressing {
        bool on = false;
        double threshold = 1;  ///< PT [device mm]
        Ranges ranges;         ///< [data units] in any order
    };
    QWidget* make_ranges();
    QWidget* make_range(std::size_t at);
    void connect_chart();
    void begin();
    void show_effect();
    void request();
    void change(const std::function<void(Pressing&)>& how);
    void add_range(const DensityRange& range);
    void remove_range(std::size_t which);
    DensityRange room_for_a_range() const;

    Effect& effect_;
    LevelChart* chart_;
    Pressing shown_;
    bool dragging_ = false;  // a band
};

}  // namespace palpate::viewer

// Controls of penetrability: off, past a threshold, or by ranges of interest, which are bands on
// the level chart.
#pragma once

#include <QButtonGroup>
#include <QPushButton>
#include <QWidget>

#include <utility>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/panel/press_through.hpp"
#include "apps/viewer/panel/quantity.hpp"
#include "apps/viewer/panel/range_table.hpp"

namespace palpate::viewer {

class PenetrabilityControls : public QWidget {
    Q_OBJECT

  public:
    /// Shows and reads its bands on the chart, which it does not own.
    PenetrabilityControls(Effect& effect, LevelChart& chart);

  Q_SIGNALS:
    void nonsense(const QString& why);

  private:
    void connect_effect();
    void begin();
    void drop();
    void set_layered(bool layered);
    void request(const PressThrough& next);
    void ask(const PressThrough& next);
    void show(const PressThrough& next);
    void connect_inputs();
    void add_range(const DensityRange& range);
    void remove_range(int which);
    DensityRange room_for_a_range() const;

    Effect& effect_;
    LevelChart* chart_;
    QButtonGroup* modes_;
    Quantity* threshold_;
    QWidget* minimum_row_;
    NumberBox* minimum_;
    QWidget* ranges_row_;
    RangeTable* table_;
    RateLimiter limiter_;
    PressThrough shown_;
    Solid solid_ = Solid::above;
    bool dragging_ = false;  // a band
};

}  // namespace palpate::viewer

// Controls of penetrability: off, past a threshold, or by ranges of interest, which are bands on
// the level chart.
#pragma once

#include <QButtonGroup>
#include <QPushButton>
#include <QWidget>

#include <utility>

#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/panel/press_through.hpp"
#include "apps/viewer/panel/quantity.hpp"
#include "apps/viewer/panel/range_table.hpp"

namespace palpate::viewer {

class PenetrabilityControls : public QWidget {
    Q_OBJECT

  public:
    /// Shows and reads its bands on the chart, which it does not own.
    explicit PenetrabilityControls(LevelChart& chart);

    /// A new session: modes that are not in use begin at this level and range [data units]. Emits
    /// nothing.
    void set_session(const Penetrability& in_use, Solid solid, double isovalue, double low,
                     double high);
    /// Shows the setting in use; emits nothing.
    void set_in_use(const Penetrability& in_use);
    /// Layers are felt: this rests meanwhile.
    void set_layered(bool layered);
    void drop();

  Q_SIGNALS:
    /// What the user asks for, valid or not.
    void wanted(const palpate::viewer::PressThrough& next);
    void nonsense(const QString& why);

  private:
    void ask(const PressThrough& next);
    void show(const PressThrough& next);
    void connect_inputs();
    void add_range(const DensityRange& range);
    void remove_range(int which);
    DensityRange room_for_a_range() const;

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
    double low_ = 0, high_ = 1;
    bool dragging_ = false;  // a band
};

}  // namespace palpate::viewer

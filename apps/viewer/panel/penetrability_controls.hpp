// Controls of penetrability: off, past a threshold, or by ranges of interest, which are bands on
// the level chart and rows of a table.
#pragma once

#include <QTableWidget>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/level_chart.hpp"

namespace palpate::viewer {

/// What the panel shows; settings of modes that are not in use are kept for later.
struct PressThrough {
    enum class Mode { off, threshold, ranges };

    Mode mode = Mode::off;
    double threshold = 1;  ///< PT [device mm]
    double minimum = 0;    ///< [data units] least level felt (greatest where below is solid)
    Ranges ranges;         ///< [data units] in any order

    PenetrabilityFunction function = nullptr;  ///< kept as it came
    const void* context = nullptr;
};

/// The core's setting. Throws std::invalid_argument as penetrability_threshold and _ranges do.
Penetrability penetrability_of(const PressThrough& shown, Solid solid);

/// How a setting is shown; modes that it does not use keep their values from `before`.
PressThrough shown_from(const Penetrability& penetrability, Solid solid, PressThrough before);

/// The defaults for data of this range [data units]: a minimum at the level, and one range that
/// begins there and spans a tenth of the data.
PressThrough first_press_through(double isovalue, double low, double high, Solid solid);

/// The bands on the chart, rising: the ranges, or everything past the minimum; none in mode off.
Ranges bands_of(const PressThrough& shown, Solid solid);
/// The inverse: bands that were dragged become ranges or the minimum.
PressThrough with_bands(PressThrough shown, const Ranges& bands, Solid solid);

/// One row for each range, LOW and HIGH [data units], "inf" and "-inf" included; its colour is the
/// band's. Del deletes the row.
class RangeTable : public QTableWidget {
    Q_OBJECT

  public:
    RangeTable();

    /// Shows ranges; emits nothing.
    void set_ranges(const Ranges& ranges);
    int chosen() const;
    void choose(int row);

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override { return sizeHint(); }

  Q_SIGNALS:
    void edited(int row, const palpate::DensityRange& range);
    void nonsense(const QString& why);  ///< the text typed is no number; the old one is restored
    void delete_wanted(int row);
    void row_chosen(int row);

  protected:
    void keyPressEvent(QKeyEvent* event) override;

  private:
    void read(int row, int column);
    void write(int row);

    Ranges ranges_;
};

class PenetrabilityControls : public Form {
    Q_OBJECT

  public:
    /// Shows and reads its bands on the chart, which it does not own.
    PenetrabilityControls(Effect& effect, LevelChart& chart);

  private:
    QLayout* make_modes();
    QWidget* make_ranges();
    void connect_chart();
    void begin();
    void show_effect();
    void request();
    void change(const std::function<void(PressThrough&)>& how);
    void add_range(const DensityRange& range);
    void remove_range(int which);
    DensityRange room_for_a_range() const;

    Effect& effect_;
    LevelChart* chart_;
    RangeTable* table_;
    PressThrough shown_;
    Solid solid_ = Solid::above;
    bool dragging_ = false;  // a band
};

}  // namespace palpate::viewer

// A table of the ranges of interest, as numbers.
#pragma once

#include <QTableWidget>

#include "apps/viewer/panel/range_bands.hpp"

namespace palpate::viewer {

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

}  // namespace palpate::viewer

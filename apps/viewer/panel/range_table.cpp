// Converts between table cells and ranges.
#include "apps/viewer/panel/range_table.hpp"

#include <QHeaderView>
#include <QKeyEvent>
#include <QSignalBlocker>

#include <algorithm>

#include "apps/viewer/panel/number_box.hpp"

namespace palpate::viewer {
RangeTable::RangeTable() : QTableWidget(0, 2) {
    setObjectName("ranges");
    setAccessibleName(tr("Ranges of interest"));
    setHorizontalHeaderLabels({tr("from"), tr("to")});
    horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
    verticalHeader()->setDefaultSectionSize(static_cast<int>(1.7 * fontMetrics().height()));
    setSelectionBehavior(QAbstractItemView::SelectRows);
    setSelectionMode(QAbstractItemView::SingleSelection);
    setTabKeyNavigation(false);  // Tab leaves the table
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    setToolTip(
        tr("Ranges of interest [data units]: only these levels are felt. Del deletes a row."));
    connect(this, &QTableWidget::cellChanged, this, &RangeTable::read);
    connect(this, &QTableWidget::itemSelectionChanged, this,
            [this] { Q_EMIT row_chosen(chosen()); });
}

void RangeTable::write(int row) {
    const DensityRange& range = ranges_[static_cast<std::size_t>(row)];
    const QString texts[] = {number_text(range.low), number_text(range.high)};
    for (int column = 0; column < 2; ++column) {
        if (!item(row, column)) setItem(row, column, new QTableWidgetItem);
        item(row, column)->setText(texts[column]);
    }
}

void RangeTable::set_ranges(const Ranges& ranges) {
    const QSignalBlocker quiet(this);
    const bool resized = ranges.size() != ranges_.size();
    ranges_ = ranges;
    setRowCount(static_cast<int>(ranges.size()));
    for (int row = 0; row < rowCount(); ++row) {
        write(row);
        if (!verticalHeaderItem(row)) {
            auto* chip = new QTableWidgetItem(QString::number(row + 1));
            QPixmap colour(16, 16);
            colour.fill(band_colour(row));
            chip->setIcon(QIcon(colour));
            setVerticalHeaderItem(row, chip);
        }
    }
    if (resized) updateGeometry();
}

int RangeTable::chosen() const {
    return selectedItems().isEmpty() ? -1 : selectedItems().front()->row();
}

void RangeTable::choose(int row) {
    const QSignalBlocker quiet(this);
    if (row < 0) {
        clearSelection();
    } else {
        selectRow(row);
    }
}

void RangeTable::read(int row, int column) {
    if (row >= static_cast<int>(ranges_.size())) return;
    DensityRange range = ranges_[static_cast<std::size_t>(row)];
    double& end = column == 0 ? range.low : range.high;
    const QString text = item(row, column)->text();
    if (text == number_text(end)) return;  // only looked at
    if (const auto number = number_from(text.trimmed())) {
        end = *number;
        Q_EMIT edited(row, range);
        return;
    }
    {
        const QSignalBlocker quiet(this);
        write(row);
    }
    Q_EMIT nonsense(tr("'%1' is not a number").arg(text));
}

void RangeTable::keyPressEvent(QKeyEvent* event) {
    if ((event->key() == Qt::Key_Delete || event->key() == Qt::Key_Backspace) &&
        currentRow() >= 0) {
        Q_EMIT delete_wanted(currentRow());
        return;
    }
    QTableWidget::keyPressEvent(event);
}

QSize RangeTable::sizeHint() const {
    const int rows = std::clamp(rowCount(), 1, 5);
    const int height = horizontalHeader()->sizeHint().height() +
                       rows * verticalHeader()->defaultSectionSize() + 2 * frameWidth();
    return {14 * fontMetrics().height(), height};
}

}  // namespace palpate::viewer

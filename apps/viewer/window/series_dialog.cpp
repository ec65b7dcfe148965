// A table of series, a picture and a line each.
#include "apps/viewer/window/series_dialog.hpp"

#include <QDialogButtonBox>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
namespace {

constexpr int picture_size = 64;

QStringList columns() {
    return {"",
            SeriesDialog::tr("Series"),
            SeriesDialog::tr("Modality"),
            SeriesDialog::tr("Slices"),
            SeriesDialog::tr("Size"),
            SeriesDialog::tr("Spacing [mm]"),
            SeriesDialog::tr("Patient"),
            SeriesDialog::tr("Study")};
}

QPixmap pixmap_of(const io::Thumbnail& picture) {
    if (picture.grey.empty()) return {};
    const QImage image(picture.grey.data(), picture.width, picture.height, picture.width,
                       QImage::Format_Grayscale8);
    return QPixmap::fromImage(
        image.scaled(picture_size, picture_size, Qt::KeepAspectRatio, Qt::SmoothTransformation));
}

QStringList texts_of(const io::SeriesInfo& s) {
    const auto text = [](const std::string& t) { return QString::fromStdString(t); };
    QString name = s.description.empty() ? text(s.uid) : text(s.description);
    if (!s.stack.empty()) name = SeriesDialog::tr("%1 (stack %2)").arg(name, text(s.stack));
    QStringList spacing;
    for (int a = 0; a < 3 && s.spacing[a] > 0; ++a)
        spacing << QString::number(s.spacing[a], 'g', 4);
    return {name,
            text(s.modality),
            QString::number(s.slices),
            QString("%1 x %2").arg(s.size[0]).arg(s.size[1]),
            spacing.join(" x "),
            text(s.patient).replace('^', ' ').simplified(),
            text(s.study)};
}

}  // namespace

SeriesDialog::SeriesDialog(const QString& name, const std::vector<io::SeriesInfo>& series,
                           QWidget* parent)
    : QDialog(parent),
      table_(named(new QTableWidget(static_cast<int>(series.size()), columns().size()), "series")) {
    setObjectName("choose-series");
    setWindowTitle(tr("Choose a series of %1").arg(name));
    table_->setAccessibleName(tr("Series"));
    table_->setHorizontalHeaderLabels(columns());
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->setSelectionMode(QAbstractItemView::SingleSelection);
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    for (int row = 0; row < table_->rowCount(); ++row) {
        const io::SeriesInfo& s = series[static_cast<std::size_t>(row)];
        auto* picture = new QLabel;
        picture->setPixmap(pixmap_of(s.picture));
        picture->setAlignment(Qt::AlignCenter);
        table_->setCellWidget(row, 0, picture);
        const QStringList texts = texts_of(s);
        for (int i = 0; i < texts.size(); ++i) {
            auto* item = new QTableWidgetItem(texts[i]);
            item->setToolTip(QString::fromStdString(s.uid));
            table_->setItem(row, i + 1, item);
        }
        table_->setRowHeight(row, picture_size + 6);
    }
    table_->resizeColumnsToContents();
    table_->setColumnWidth(0, picture_size + 10);
    // The one with the most slices is most often what is looked for.
    const auto most = std::ranges::max_element(series, {}, &io::SeriesInfo::slices);
    table_->selectRow(static_cast<int>(most - series.begin()));
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Open | QDialogButtonBox::Cancel);
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    connect(table_, &QTableWidget::cellDoubleClicked, this, &QDialog::accept);
    connect(table_, &QTableWidget::itemSelectionChanged, buttons,
            [this, buttons] { buttons->button(QDialogButtonBox::Open)->setEnabled(chosen() > 0); });
    auto* column = new QVBoxLayout(this);
    column->addWidget(table_);
    column->addWidget(buttons);
    resize(900, 420);
}

int SeriesDialog::chosen() const {
    const auto rows = table_->selectionModel()->selectedRows();
    return rows.isEmpty() ? 0 : rows.front().row() + 1;
}

}  // namespace palpate::viewer

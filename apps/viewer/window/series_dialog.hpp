// A dialog that asks which of the DICOM series of a file or folder to open.
#pragma once

#include <QDialog>

#include "palpate/io/series.hpp"

class QTableWidget;

namespace palpate::viewer {

class SeriesDialog : public QDialog {
    Q_OBJECT

  public:
    SeriesDialog(const QString& name, const std::vector<io::SeriesInfo>& series,
                 QWidget* parent = nullptr);
    /// From 1.
    int chosen() const;

  private:
    QTableWidget* table_;
};

}  // namespace palpate::viewer

// A dialog that asks for the layout of a raw file: size, type, spacing, header to skip.
#pragma once

#include <QDialog>

#include "palpate/run/source.hpp"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QSpinBox;

namespace palpate::viewer {

/// Shows at every change whether the file is long enough.
class RawDialog : public QDialog {
  public:
    explicit RawDialog(const QString& path, QWidget* parent = nullptr);
    run::Source source() const;

  private:
    void judge();

    QString path_;
    std::array<QSpinBox*, 3> size_;
    std::array<QDoubleSpinBox*, 3> spacing_;
    QComboBox* type_;
    QSpinBox* skip_;
    QLabel* verdict_;
    QPushButton* accept_;
};

}  // namespace palpate::viewer

// What a file without a header holds, asked of the person who opens it.
#pragma once

#include <QDialog>

#include "palpate/run/source.hpp"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QSpinBox;

namespace palpate::viewer {

/// Tells while one types whether the file is long enough.
class RawDialog : public QDialog {
    Q_OBJECT

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

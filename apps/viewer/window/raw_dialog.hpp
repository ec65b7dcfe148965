// A dialog that asks for the layout of a raw file: size, type, byte order, spacing, header to skip.
#pragma once

#include <QDialog>
#include <array>

#include "palpate/run/source.hpp"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QSlider;
class QSpinBox;

namespace palpate::viewer {

/// Begins with what the file's name and length suggest. Shows at every change a slice, and whether
/// the file has just the bytes that are needed; else it cannot be accepted.
class RawDialog : public QDialog {
    Q_OBJECT

  public:
    explicit RawDialog(const QString& path, QWidget* parent = nullptr);
    /// The file with the layout that is chosen.
    run::FileSource layout_source() const;

  private:
    void make_fields();
    QWidget* make_preview();
    io::RawLayout layout_now() const;
    void judge();
    void show_slice();

    QString path_;
    std::array<QSpinBox*, 3> size_;
    std::array<QDoubleSpinBox*, 3> spacing_;
    QComboBox *type_, *order_;
    QSpinBox* skip_;
    QPushButton* skip_rest_;
    QSlider* slice_;
    QLabel *picture_, *verdict_;
    QPushButton* accept_;
};

}  // namespace palpate::viewer

// A dialog that asks how a volume's grid lies in the body, and its spacing, where the file does not
// say or is wrong.
#pragma once

#include <QDialog>
#include <array>

#include "palpate/io/orientation.hpp"
#include "palpate/run/source.hpp"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QPushButton;

namespace palpate::viewer {

/// What replaces the file's own orientation and spacing now.
io::GivenGrid given_grid(const run::Source& source);

class GridDialog : public QDialog {
    Q_OBJECT

  public:
    /// `grid`: as it is felt, with `given` in it. Accepted only if something was changed.
    GridDialog(const Geometry& grid, const io::GivenGrid& given, QWidget* parent = nullptr);
    /// What shall replace the file's own; what was not touched stays as it was given.
    io::GivenGrid grid() const;

  private:
    void mirror();
    void judge();
    bool changed() const;
    std::string letters() const;

    const Geometry before_;
    const io::GivenGrid given_;
    std::array<QComboBox*, 3> sides_;
    std::array<QDoubleSpinBox*, 3> spacing_;
    QCheckBox* measured_;
    QPushButton *mirror_, *accept_;
};

}  // namespace palpate::viewer

// A dialog that asks how a volume's grid lies in the body, and its spacing, where the file does not
// say or is wrong.
#pragma once

#include <QDialog>
#include <string>

#include "palpate/io/orientation.hpp"
#include "palpate/run/source.hpp"

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
    void accept() override;

  private:
    bool is_body() const;

    const Geometry before_;
    const io::GivenGrid given_;
    std::string sides_;  // a letter for each axis; a space: not known
    Vec3 spacing_;
    bool measured_;
};

}  // namespace palpate::viewer

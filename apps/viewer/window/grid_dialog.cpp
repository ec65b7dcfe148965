// Lays out a side of the body and a spacing for each axis.
#include "apps/viewer/window/grid_dialog.hpp"

#include <QFormLayout>
#include <stdexcept>

#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {

io::GivenGrid given_grid(const run::Source& source) {
    if (const auto* file = std::get_if<run::FileSource>(&source.from)) {
        return {file->spacing, file->orientation};
    }
    const auto* store = std::get_if<run::StoreSource>(&source.from);
    return store ? io::GivenGrid{store->options.spacing, store->options.orientation}
                 : io::GivenGrid{};
}

GridDialog::GridDialog(const Geometry& grid, const io::GivenGrid& given, QWidget* parent)
    : QDialog(parent),
      before_(grid),
      given_(given),
      sides_(grid.oriented ? io::orientation_of(grid) : "   "),
      spacing_(grid.spacing),
      measured_(grid.measured) {
    setObjectName("grid");
    setWindowTitle(tr("Orientation and spacing"));
    // What the file itself says can be replaced, not taken away.
    const bool may_be_unknown = !grid.oriented || !given.orientation.empty();
    const std::string letters = may_be_unknown ? " LRPASI" : "LRPASI";
    QStringList names{tr("to the left (L)"),  tr("to the right (R)"), tr("to the back (P)"),
                      tr("to the front (A)"), tr("to the head (S)"),  tr("to the feet (I)")};
    if (may_be_unknown) names.push_front(tr("not known"));
    auto* form = new Form;
    auto* rows = form_in(form);
    for (int a = 0; a < 3; ++a) {
        const QChar axis("XYZ"[a]);
        char& its_side = sides_[std::size_t(a)];
        add_row(*rows, tr("%1 runs").arg(axis),
                form->choice({"grid_side_" + QString(axis), ""}, names,
                             {[&its_side, letters] { return int(letters.find(its_side)); },
                              [&its_side, letters](int at) { its_side = letters[at]; }}),
                tr("The side of the body that this axis of the samples runs to"));
        add_row(*rows, tr("Spacing along %1 [mm]").arg(axis),
                form->number({"grid_spacing_" + QString(axis), ""},
                             within(1e-4, 1e4,
                                    {[this, a] { return spacing_[a]; },
                                     [this, a](double to) {
                                         spacing_[a] = to;
                                         measured_ = true;
                                     }})),
                tr("Between neighbouring samples"));
    }
    auto* measured =
        form->check({"grid_measured", tr("The spacing is known")},
                    {[this] { return measured_; }, [this](bool on) { measured_ = on; }});
    measured->setEnabled(!grid.measured || given.spacing);
    auto* mirror = form->button(
        {"grid_mirror", tr("Exchange left and right")},
        [this] {
            for (char& side : sides_) {
                side = side == 'L' ? 'R' : side == 'R' ? 'L' : side;
            }
        },
        [this] { return is_body() && sides_ != "   "; });
    mirror->setAutoDefault(false);  // Return is for OK
    rows->addRow(measured);
    rows->addRow(mirror);
    QPushButton* accept = fill(*this, form, QDialogButtonBox::Ok);
    form->each_time(accept, [this](QPushButton& ok) { ok.setEnabled(is_body()); });
    form->refresh();
}

/// Only three sides that make a body, or none, can be taken.
bool GridDialog::is_body() const {
    try {
        if (sides_ != "   ") (void)io::direction_from(sides_);
        return true;
    } catch (const std::invalid_argument&) {
        return false;
    }
}

/// With nothing changed the volume need not be read again.
void GridDialog::accept() {
    const io::GivenGrid now = grid();
    done(now.spacing != given_.spacing || now.orientation != given_.orientation ? Accepted
                                                                                : Rejected);
}

io::GivenGrid GridDialog::grid() const {
    io::GivenGrid grid = given_;
    const std::string sides = sides_ == "   " ? "" : sides_;
    if (sides != (before_.oriented ? io::orientation_of(before_) : "")) grid.orientation = sides;
    if (!measured_) grid.spacing.reset();
    if (measured_ && (spacing_ != before_.spacing || !before_.measured)) grid.spacing = spacing_;
    return grid;
}

}  // namespace palpate::viewer

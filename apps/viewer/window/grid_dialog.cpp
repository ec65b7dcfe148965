// The dialog that asks for a side of the body and a spacing for each axis of a grid.
#include <QCoreApplication>
#include <QDialog>
#include <QFormLayout>

#include <stdexcept>
#include <string>
#include <utility>

#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/window/open_dialogs.hpp"

namespace palpate::viewer {
namespace {

const std::string unknown_sides = "   ";  // a letter for each axis; a space: not known

class GridDialog : public Form {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::GridDialog)

  public:
    GridDialog(const Geometry& grid, const io::GivenGrid& given)
        : before_(grid),
          given_(given),
          sides_(grid.oriented ? io::orientation_of(grid) : unknown_sides),
          spacing_(grid.spacing),
          measured_(grid.measured) {
        auto* rows = form_in(this);
        for (int a = 0; a < 3; ++a) add_axis(*rows, a);
        auto* measured = check({"grid_measured", tr("The spacing is known")},
                               {[this] { return measured_; }, [this](bool on) { measured_ = on; }});
        measured->setEnabled(!grid.measured || given.spacing);
        auto* mirror = button(
            {"grid_mirror", tr("Exchange left and right")},
            [this] {
                for (char& side : sides_) {
                    side = side == 'L' ? 'R' : side == 'R' ? 'L' : side;
                }
            },
            [this] { return is_body() && sides_ != unknown_sides; });
        mirror->setAutoDefault(false);  // Return is for OK
        rows->addRow(measured);
        rows->addRow(mirror);
    }

    /// Only three sides that make a body, or none, can be taken.
    bool is_body() const {
        try {
            if (sides_ != unknown_sides) (void)io::direction_from(sides_);
            return true;
        } catch (const std::invalid_argument&) {
            return false;
        }
    }
    io::GivenGrid grid() const {
        io::GivenGrid grid = given_;
        const std::string sides = sides_ == unknown_sides ? "" : sides_;
        if (sides != (before_.oriented ? io::orientation_of(before_) : "")) {
            grid.orientation = sides;
        }
        if (!measured_) grid.spacing.reset();
        if (measured_ && (spacing_ != before_.spacing || !before_.measured)) {
            grid.spacing = spacing_;
        }
        return grid;
    }
    bool changed() const {
        const io::GivenGrid now = grid();
        return now.spacing != given_.spacing || now.orientation != given_.orientation;
    }

  private:
    void add_axis(QFormLayout& rows, int a) {
        // What the file itself says can be replaced, not taken away.
        const bool may_be_unknown = !before_.oriented || !given_.orientation.empty();
        const std::string letters = may_be_unknown ? " LRPASI" : "LRPASI";
        QStringList names{tr("to the left (L)"),  tr("to the right (R)"), tr("to the back (P)"),
                          tr("to the front (A)"), tr("to the head (S)"),  tr("to the feet (I)")};
        if (may_be_unknown) names.push_front(tr("not known"));
        const QChar axis("XYZ"[a]);
        char& side = sides_[std::size_t(a)];
        add_row(rows, tr("%1 runs").arg(axis),
                choice({"grid_side_" + QString(axis), ""}, names,
                       {[&side, letters] { return int(letters.find(side)); },
                        [&side, letters](int at) { side = letters[std::size_t(at)]; }}),
                tr("The side of the body that this axis of the samples runs to"));
        add_row(
            rows, tr("Spacing along %1 [mm]").arg(axis),
            number({"grid_spacing_" + QString(axis), ""}, within(1e-4, 1e4,
                                                                 {[this, a] { return spacing_[a]; },
                                                                  [this, a](double to) {
                                                                      spacing_[a] = to;
                                                                      measured_ = true;
                                                                  }})),
            tr("Between neighbouring samples"));
    }

    const Geometry before_;
    const io::GivenGrid given_;
    std::string sides_;
    Vec3 spacing_;
    bool measured_;
};

}  // namespace

QDialog* make_grid_dialog(const Geometry& grid, const io::GivenGrid& given, QWidget* window,
                          std::function<void(const io::GivenGrid&)> then) {
    auto* dialog = named(new QDialog(window), "grid");
    dialog->setWindowTitle(GridDialog::tr("Orientation and spacing"));
    auto* form = new GridDialog(grid, given);
    QPushButton* accept = fill(*dialog, form, QDialogButtonBox::Ok);
    form->each_time(accept, [form](QPushButton& ok) { ok.setEnabled(form->is_body()); });
    form->refresh();
    // With nothing changed the volume need not be read again.
    QObject::connect(dialog, &QDialog::accepted, form, [form, then = std::move(then)] {
        if (form->changed()) then(form->grid());
    });
    return dialog;
}

}  // namespace palpate::viewer

// Lays out a side of the body and a spacing for each axis.
#include "apps/viewer/window/grid_dialog.hpp"

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QPushButton>
#include <cmath>

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
      measured_(named(new QCheckBox(tr("The spacing is known")), "grid_measured")),
      mirror_(named(new QPushButton(tr("Exchange left and right")), "grid_mirror")) {
    setObjectName("grid");
    setWindowTitle(tr("Orientation and spacing"));
    const std::pair<const char*, QString> sides[] = {
        {"", tr("not known")},        {"L", tr("to the left (L)")},  {"R", tr("to the right (R)")},
        {"P", tr("to the back (P)")}, {"A", tr("to the front (A)")}, {"S", tr("to the head (S)")},
        {"I", tr("to the feet (I)")}};
    const std::string now = grid.oriented ? io::orientation_of(grid) : "";
    // What the file itself says can be replaced, not taken away.
    const bool may_be_unknown = !grid.oriented || !given.orientation.empty();
    auto* form = new QFormLayout;
    for (std::size_t a = 0; a < 3; ++a) {
        const QChar axis("XYZ"[a]);
        sides_[a] = named(new QComboBox, "grid_side_" + QString(axis));
        for (const auto& [letter, text] : sides) {
            if (*letter || may_be_unknown) sides_[a]->addItem(text, letter);
        }
        if (!now.empty()) sides_[a]->setCurrentIndex(sides_[a]->findData(QString(now[a])));
        spacing_[a] = named(new QDoubleSpinBox, "grid_spacing_" + QString(axis));
        spacing_[a]->setDecimals(4);
        spacing_[a]->setRange(1e-4, 1e4);
        spacing_[a]->setValue(grid.spacing[Eigen::Index(a)]);
        add_row(*form, tr("%1 runs").arg(axis), sides_[a],
                tr("The side of the body that this axis of the samples runs to"));
        add_row(*form, tr("Spacing along %1 [mm]").arg(axis), spacing_[a],
                tr("Between neighbouring samples"));
        connect(sides_[a], qOverload<int>(&QComboBox::currentIndexChanged), this,
                &GridDialog::judge);
        connect(spacing_[a], qOverload<double>(&QDoubleSpinBox::valueChanged), measured_,
                [this] { measured_->setChecked(true); });
    }
    mirror_->setAutoDefault(false);  // Return is for OK
    measured_->setChecked(grid.measured);
    measured_->setEnabled(!grid.measured || given.spacing);
    form->addRow(measured_);
    form->addRow(mirror_);
    connect(mirror_, &QPushButton::clicked, this, &GridDialog::mirror);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
    accept_ = buttons->button(QDialogButtonBox::Ok);
    // With nothing changed the volume need not be read again.
    connect(buttons, &QDialogButtonBox::accepted, this,
            [this] { done(changed() ? Accepted : Rejected); });
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    auto* fields = new QWidget;
    fields->setLayout(form);
    column_in(this, {fields, buttons})->setContentsMargins(9, 9, 9, 9);
    judge();
}

std::string GridDialog::letters() const {
    QString all;
    for (const QComboBox* side : sides_) all += side->currentData().toString();
    return all.toStdString();
}

void GridDialog::mirror() {
    for (QComboBox* side : sides_) {
        const QString now = side->currentData().toString();
        if (now == "L" || now == "R") side->setCurrentIndex(side->findData(now == "L" ? "R" : "L"));
    }
}

/// Only three sides that make a body, or none, can be taken.
void GridDialog::judge() {
    bool good = true;
    try {
        if (!letters().empty()) (void)io::direction_from(letters());
    } catch (const std::invalid_argument&) {
        good = false;
    }
    accept_->setEnabled(good);
    mirror_->setEnabled(good && !letters().empty());
}

bool GridDialog::changed() const {
    const io::GivenGrid now = grid();
    return now.spacing != given_.spacing || now.orientation != given_.orientation;
}

io::GivenGrid GridDialog::grid() const {
    io::GivenGrid grid = given_;
    const std::string before = before_.oriented ? io::orientation_of(before_) : "";
    if (letters() != before) grid.orientation = letters();
    Vec3 spacing = before_.spacing;
    for (Eigen::Index a = 0; a < 3; ++a) {
        const double typed = spacing_[std::size_t(a)]->value();
        if (std::abs(typed - spacing[a]) > 1e-4) spacing[a] = typed;  // else it was rounded
    }
    const bool told = spacing != before_.spacing || !before_.measured;
    if (measured_->isChecked() && told) grid.spacing = spacing;
    if (!measured_->isChecked()) grid.spacing.reset();
    return grid;
}

}  // namespace palpate::viewer

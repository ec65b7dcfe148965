// Rows that are made once, so that nothing moves under the pointer.
#include "apps/viewer/panel/surface_list.hpp"

#include <algorithm>

#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
namespace {

QString feel_tip() {
    return SurfaceList::tr("Feel this one; the one felt now takes its place here");
}

}  // namespace

SurfaceList::SurfaceList()
    : add_(named(new QPushButton(tr("Add a surface")), "add_surface",
                 tr("See another level beside the one that is felt: skin over bone"))) {
    auto* column = column_in(this);
    for (std::size_t i = 0; i < most_surfaces; ++i) {
        rows_.push_back(make_row(static_cast<int>(i) + 1));
        connect_row(rows_.back(), i);
        column->addWidget(rows_.back().whole);
    }
    column->addWidget(add_);
    connect(add_, &QPushButton::clicked, this, &SurfaceList::add_wanted);
    set_surfaces({});
}

SurfaceList::Row SurfaceList::make_row(int number) {
    const QString name = QString("surface_%1").arg(number);
    const QString which = tr("Surface %1").arg(number);
    Row row{};
    row.shown = named(new QCheckBox, name, tr("Surface %1 is seen").arg(number));
    row.shown->setAccessibleName(which);
    row.colour = new ColourButton(name + "_colour", tr("Colour of surface %1").arg(number));
    row.level = named(new NumberBox, name + "_level",
                      tr("Its level [data units]; also a line to drag on the histogram"));
    row.level->setAccessibleName(tr("Level of surface %1").arg(number));
    row.opacity = named(new NumberBox, name + "_opacity", tr("Its opacity, 0 to 1"));
    row.opacity->setAccessibleName(tr("Opacity of surface %1").arg(number));
    row.opacity->setSingleStep(0.05);
    row.feel = named(new QPushButton(tr("Feel")), name + "_feel", feel_tip());
    row.feel->setAccessibleName(tr("Feel surface %1").arg(number));
    row.remove = named(new QPushButton("×"), name + "_remove", tr("Remove it"));
    row.remove->setAccessibleName(tr("Remove surface %1").arg(number));
    const int em = fontMetrics().height();
    row.feel->setMaximumWidth(3 * em);
    row.remove->setMaximumWidth(2 * em);
    row.opacity->setMaximumWidth(5 * em);
    row.whole = row_of({row.shown, row.colour, row.level, row.opacity, row.feel, row.remove}, 2);
    return row;
}

void SurfaceList::connect_row(const Row& row, std::size_t at) {
    const auto change = [this, at](auto set) {
        set(surfaces_.at(at));
        Q_EMIT changed(surfaces_);
    };
    connect(row.shown, &QCheckBox::clicked, this,
            [change](bool on) { change([on](SeenSurface& s) { s.shown = on; }); });
    connect(row.colour, &ColourButton::wanted, this, [change](const Colour& colour) {
        change([&colour](SeenSurface& s) { s.colour = colour; });
    });
    connect(row.level, qOverload<double>(&NumberBox::valueChanged), this,
            [change](double level) { change([level](SeenSurface& s) { s.level = level; }); });
    connect(row.opacity, qOverload<double>(&NumberBox::valueChanged), this,
            [this, change, at](double opacity) {
                change([opacity](SeenSurface& s) { s.opacity = std::clamp(opacity, 0.0, 1.0); });
                show_row(at);
            });
    connect(row.feel, &QPushButton::clicked, this,
            [this, at] { Q_EMIT feel_wanted(static_cast<int>(at)); });
    connect(row.remove, &QPushButton::clicked, this, [this, at] {
        SeenSurfaces fewer = surfaces_;
        fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(at));
        set_surfaces(fewer);
        Q_EMIT changed(surfaces_);
    });
}

void SurfaceList::show_row(std::size_t at) {
    const SeenSurface& surface = surfaces_[at];
    const Row& row = rows_[at];
    row.shown->setChecked(surface.shown);
    row.colour->set_colour(surface.colour);
    row.level->show_value(surface.level);
    row.opacity->show_value(surface.opacity);
}

void SurfaceList::set_surfaces(const SeenSurfaces& surfaces) {
    surfaces_ = surfaces;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        rows_[i].whole->setVisible(i < surfaces_.size());
        if (i < surfaces_.size()) show_row(i);
    }
    add_->setEnabled(surfaces_.size() < most_surfaces);
}

void SurfaceList::set_feelable(bool feelable, const QString& why) {
    for (const Row& row : rows_) {
        row.feel->setEnabled(feelable);
        row.feel->setToolTip(feelable ? feel_tip() : why);
    }
}

void SurfaceList::set_step(double step) {
    for (const Row& row : rows_) row.level->setSingleStep(step);
}

}  // namespace palpate::viewer

// Connects the controls of the look with the look that is chosen.
#include "apps/viewer/panel/look_controls.hpp"

#include <QGridLayout>
#include <QLabel>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/names.hpp"

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

LookControls::LookControls(Effect& effect)
    : effect_(effect),
      surface_colour_(new ColourButton("surface_colour", tr("Colour of the isosurface"))),
      point_colour_(new ColourButton("point_colour", tr("Colour of the chosen point"))),
      surface_opacity_(new Quantity("surface_opacity", "", 0, 1, 0.05)),
      preset_(
          named(new QComboBox, "preset",
                tr("Transfer functions made for these data; choose one again to undo changes"))),
      surfaces_(new SurfaceList),
      cut_(named(
          new QComboBox, "cut",
          tr("Cut surfaces and volume open, to see inside. Drag the blue balls in the scene.\n"
             "Choose the plane again to have it face you."))),
      colours_(named(new QComboBox, "colours", tr("Colour map of the slices"))),
      editor_(named(
          new LevelChart, "transfer_editor",
          tr("Opacity (upwards, 0 to 1) and colour by level [data units].\n"
             "Drag a point; double click adds one, or on a point chooses its colour; right click "
             "or Del deletes.\nPage keys choose a point, arrows move it, Insert adds one, Return "
             "chooses its colour.\nChoose the preset again to undo. Ctrl-wheel zooms, shift-wheel "
             "moves, Ctrl+0 shows all again."))),
      point_level_(
          named(new NumberBox, "point_level", tr("Level of the chosen point [data units]"))),
      point_opacity_(named(new NumberBox, "point_opacity",
                           tr("Opacity of the chosen point, 0 to 1, of a layer as thick as the "
                              "smallest spacing"))),
      limiter_(this) {
    editor_->setAccessibleName(tr("Transfer function"));
    editor_->set_level_shown(false);
    column_in(this, {make_surface(), surfaces_, make_cut(), make_volume(), make_rest()});
    connect(surface_colour_, &ColourButton::wanted, this, [this](const Colour& colour) {
        look_.surface_colour = colour;
        changed();
    });
    connect(surface_opacity_, &Quantity::wanted, this, [this](double opacity) {
        look_.surface_opacity = std::clamp(opacity, 0.0, 1.0);
        surface_opacity_->set_value(look_.surface_opacity);
        changed();
    });
    connect_surfaces();
    connect_transfer();
    connect_effect();
    set_look(look_);
    show_point(-1);
}

QCheckBox* LookControls::add_switch(const QString& name, const QString& text, const QString& tip,
                                    bool Look::*shown) {
    auto* box = named(new QCheckBox(text), "show_" + name, tip);
    switches_.push_back({box, shown});
    connect(box, &QCheckBox::clicked, this, [this, shown](bool on) {
        look_.*shown = on;
        changed();
    });
    return box;
}

QWidget* LookControls::make_surface() {
    surface_opacity_->set_accessible_name(tr("Opacity of the isosurface"));
    surface_opacity_->setToolTip(tr("Opacity of the isosurface, 0 to 1"));
    auto* surface =
        add_switch("surface", tr("Surface"), tr("The isosurface that is felt"), &Look::surface);
    return row_of({surface, surface_colour_, surface_opacity_}, 2);
}

QWidget* LookControls::make_cut() {
    let_wheel_pass(*cut_);
    cut_->addItems({tr("nothing"), tr("by a plane"), tr("to a box")});
    cut_->setAccessibleName(tr("Cut away"));
    connect(cut_, qOverload<int>(&QComboBox::activated), this,
            [this](int at) { Q_EMIT cut_wanted(static_cast<Cut>(at)); });
    auto* label = new QLabel(tr("Cut away"));
    label->setBuddy(cut_);
    return row_of({label, cut_}, 1);
}

void LookControls::connect_surfaces() {
    connect(surfaces_, &SurfaceList::changed, this, [this](const SeenSurfaces& surfaces) {
        look_.surfaces = surfaces;
        changed();
    });
    connect(surfaces_, &SurfaceList::add_wanted, this, &LookControls::add_surface);
    connect(surfaces_, &SurfaceList::feel_wanted, this, &LookControls::feel);
}

/// At a suggested level that is not shown yet, else in the middle of the data. What lies outside
/// becomes glass, so that the inside is seen.
void LookControls::add_surface() {
    static constexpr Colour colours[] = {{0.84, 0.37, 0.25}, {0.34, 0.56, 0.75}, {0.93, 0.75, 0.62},
                                         {0.45, 0.65, 0.35}, {0.80, 0.62, 0.80}, {0.90, 0.80, 0.35},
                                         {0.40, 0.70, 0.70}, {0.60, 0.50, 0.45}};
    constexpr double glass = 0.35;
    if (!effect_.there()) return;
    const run::Histogram& histogram = effect_.histogram();
    const double felt = effect_.isovalue();
    std::vector<double> levels = run::suggested_isovalues(histogram);
    const double range = histogram.high - histogram.low;
    levels.push_back(histogram.low + 0.5 * range);
    const auto is_new = [&](double level) {
        const auto near = [&](double other) { return std::abs(other - level) < 0.02 * range; };
        return !near(felt) && std::ranges::none_of(look_.surfaces, [&](const SeenSurface& s) {
            return near(s.level);
        });
    };
    const auto found = std::ranges::find_if(levels, is_new);
    SeenSurface added;
    added.level = found == levels.end() ? levels.back() : *found;
    added.colour = colours[look_.surfaces.size() % std::size(colours)];
    const bool outside = effect_.field().sign() * (added.level - felt) < 0;
    if (outside) added.opacity = glass;
    if (!outside && look_.surface_opacity == 1) look_.surface_opacity = glass;
    look_.surfaces.push_back(added);
    surfaces_->set_surfaces(look_.surfaces);
    surface_opacity_->set_value(look_.surface_opacity);
    changed();
}

void LookControls::set_overlay_look(const OverlayLook& overlay) {
    look_.overlay = overlay;
    changed();
}

void LookControls::connect_effect() {
    const auto show_layered = [this] {
        surfaces_->set_feelable(
            !effect_.there() || !have_surfaces(effect_.settings().layers),
            tr("Layers are felt, not an isovalue: choose No layers to feel one"));
    };
    connect(&effect_, &Effect::begun, this, &LookControls::begin);
    connect(&effect_, &Effect::changed, this, show_layered);
    connect(&effect_, &Effect::ended, this, show_layered);
    connect(&effect_, &Effect::ended, this, [this] {
        limiter_.drop();
        editor_->set_data({}, {});
    });
}

/// The level of a surface becomes the isovalue, and the felt one takes its place.
void LookControls::feel(int row) {
    if (!effect_.there()) return;
    const double felt = effect_.isovalue();
    const double level = look_.surfaces.at(static_cast<std::size_t>(row)).level;
    if (!effect_.request(command::Isovalue{level})) return;
    SeenSurface& surface = look_.surfaces.at(static_cast<std::size_t>(row));
    surface.level = felt;
    std::swap(surface.colour, look_.surface_colour);
    std::swap(surface.opacity, look_.surface_opacity);
    const Look look = look_;
    set_look(look);
    changed();
}

void LookControls::move_surface(int row, double level) {
    look_.surfaces.at(static_cast<std::size_t>(row)).level = level;
    surfaces_->set_surfaces(look_.surfaces);
    changed();
}

QWidget* LookControls::make_volume() {
    let_wheel_pass(*preset_);
    point_opacity_->setSingleStep(0.05);
    auto* volume = add_switch("volume", tr("Volume"),
                              tr("Volume rendering by the transfer function"), &Look::volume);
    auto* shading = add_switch("shading", tr("Shading"),
                               tr("Light on the volume, by its gradients"), &Look::shading);
    auto* maximum = add_switch("maximum", tr("Maximum"),
                               tr("Maximum intensity projection: the brightest sample along each "
                                  "line of sight, black to white over the levels below"),
                               &Look::maximum);
    for (NumberBox* box : {point_level_, point_opacity_}) {
        box->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    }
    return column_of(
        {row_of({volume, shading, maximum}), preset_, editor_,
         row_of({new QLabel(tr("Point")), point_level_, point_opacity_, point_colour_})});
}

QWidget* LookControls::make_rest() {
    auto* all = new QWidget;
    auto* grid = new QGridLayout(all);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setVerticalSpacing(2);
    QCheckBox* boxes[] = {
        add_switch("slices", tr("Slices"), tr("Three planes through the crosshair"), &Look::slices),
        add_switch("contact", tr("Hand and proxy"),
                   tr("HIP, SCP, the spring between them and the force"), &Look::contact),
        add_switch("tetrahedra", tr("Tetrahedra"),
                   tr("Those round the proxy, with the surface in them"), &Look::tetrahedra),
        add_switch("planes", tr("Constraint planes"), tr("Those of the tetrahedra round the proxy"),
                   &Look::planes),
        add_switch("box", tr("Box"), tr("The bounds of the data"), &Look::box),
        add_switch("orientation", tr("Orientation cube"), tr("L, R, A, P, S, I: sides of the body"),
                   &Look::orientation),
        add_switch("scale_bar", tr("Scale bar"), tr("A length in the picture [mm]"),
                   &Look::scale_bar)};
    for (int i = 0; i < 7; ++i) grid->addWidget(boxes[i], i / 2, i % 2);
    for (const std::string& name : colour_map_names()) add_choice(*colours_, name);
    let_wheel_pass(*colours_);
    colours_->setAccessibleName(tr("Colour map of the slices"));
    connect(colours_, qOverload<int>(&QComboBox::activated), this, [this] {
        look_.colours = colours_->currentData().toString().toStdString();
        changed();
    });
    auto* label = new QLabel(tr("Slices' colours"));
    label->setBuddy(colours_);
    return column_of({all, row_of({label, colours_}, 1)});
}

void LookControls::connect_transfer() {
    connect(preset_, qOverload<int>(&QComboBox::activated), this, [this](int at) {
        if (!effect_.there()) return;
        const std::string name = preset_->itemData(at).toString().toStdString();
        look_.transfer = preset(name, effect_.histogram(), effect_.field().volume());
        show_transfer();
        changed();
    });
    connect(editor_, &LevelChart::curve_changed, this, &LookControls::take_transfer);
    connect(editor_, &LevelChart::curve_settled, &limiter_, &RateLimiter::flush);
    connect(editor_, &LevelChart::knot_held, this, &LookControls::show_point);
    connect(editor_, &LevelChart::knot_activated, point_colour_, &ColourButton::choose);
    connect(point_level_, qOverload<double>(&NumberBox::valueChanged), this,
            [this](double level) { change_point([level](ControlPoint& p) { p.level = level; }); });
    connect(point_opacity_, qOverload<double>(&NumberBox::valueChanged), this,
            [this](double opacity) {
                change_point([opacity](ControlPoint& p) { p.opacity = opacity; });
            });
    connect(point_colour_, &ColourButton::wanted, this, [this](const Colour& colour) {
        change_point([&colour](ControlPoint& p) { p.colour = colour; });
    });
}

/// The chosen one, as its numbers were typed; it stays between its neighbours.
void LookControls::change_point(const std::function<void(ControlPoint&)>& how) {
    const int chosen = editor_->held_knot();
    if (chosen < 0) return;
    const auto at = static_cast<std::size_t>(chosen);
    ControlPoint point = look_.transfer.points[at];
    how(point);
    CurveLine line = editor_->curve();
    line.put(at, {point.level, std::clamp(point.opacity, 0.0, 1.0)}, editor_->axis().step());
    line.colours[at] = point.colour;
    editor_->set_curve(line);
    take_transfer();
    show_point(chosen);
}

void LookControls::take_transfer() {
    const CurveLine& line = editor_->curve();
    look_.transfer = {};
    for (std::size_t i = 0; i < line.knots.size(); ++i) {
        look_.transfer.points.push_back({line.knots[i].at, line.colours[i], line.knots[i].value});
    }
    show_preset();
    changed();
}

void LookControls::show_transfer() {
    CurveLine line;
    line.fewest = 2;
    for (const ControlPoint& point : look_.transfer.points) {
        line.knots.push_back({point.level, point.opacity});
        line.colours.push_back(point.colour);
    }
    editor_->set_curve(line);
    show_point(editor_->held_knot());
    show_preset();
}

void LookControls::begin() {
    const run::Histogram& histogram = effect_.histogram();
    preset_->clear();
    for (const std::string& name : preset_names(histogram, effect_.field().volume())) {
        add_choice(*preset_, name);
    }
    show_preset();
    editor_->set_data(histogram, {});
    const LevelAxis axis = axis_of(histogram, QRectF(0, 0, 100, 1));
    point_level_->setSingleStep(axis.step());
    surfaces_->set_step(axis.step());
}

void LookControls::set_look(const Look& look) {
    limiter_.drop();
    look_ = look;
    for (const Switch& one : switches_) one.box->setChecked(look.*one.shown);
    surface_colour_->set_colour(look.surface_colour);
    surface_opacity_->drop();
    surface_opacity_->set_value(look.surface_opacity);
    surfaces_->set_surfaces(look.surfaces);
    cut_->setCurrentIndex(static_cast<int>(look.cut));
    colours_->setCurrentIndex(colours_->findData(QString::fromStdString(look.colours)));
    show_transfer();
    Q_EMIT look_set();
}

/// The preset, or none for a function that was edited.
void LookControls::show_preset() {
    const QString name = QString::fromStdString(look_.transfer.preset);
    preset_->setCurrentIndex(preset_->findData(name));
}

void LookControls::show_point(int point) {
    const bool any = point >= 0;
    for (QWidget* one :
         std::initializer_list<QWidget*>{point_level_, point_opacity_, point_colour_}) {
        one->setEnabled(any);
    }
    if (!any) return;
    const ControlPoint& at = look_.transfer.points[static_cast<std::size_t>(point)];
    point_level_->show_value(at.level);
    point_opacity_->show_value(at.opacity);
    point_colour_->set_colour(at.colour);
}

void LookControls::changed() {
    limiter_.put([this] { Q_EMIT look_changed(look_); });
}

}  // namespace palpate::viewer

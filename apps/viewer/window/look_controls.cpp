// Connects the controls of the look with the look that is chosen, and shows it in the views.
#include "apps/viewer/window/look_controls.hpp"

#include <QLabel>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {

/// The chosen one, as its numbers were typed; it stays between its neighbours.
void LookControls::change_point(const std::function<void(ControlPoint&)>& how) {
    if (!held_point()) return;
    ControlPoint point = *held_point();
    how(point);
    const auto at = static_cast<std::size_t>(editor_->held_knot());
    CurveLine line = editor_->curve();
    line.put(at, {point.level, point.opacity}, editor_->axis().step());
    line.colours[at] = point.colour;
    take_transfer(line.knots, line.colours);
}

LookControls::LookControls(const Desk& desk)
    : EffectForm(desk.effect()),
      Desk(desk),
      editor_(named(
          new LevelChart, "transfer_editor",
          tr("Opacity (upwards, 0 to 1) and colour by level [data units].\n"
             "Drag a point; double click adds one, or on a point chooses its colour; right click "
             "or Del deletes.\nPage keys choose a point, arrows move it, Insert adds one, Return "
             "chooses its colour.\nChoose the preset again to undo. Ctrl-wheel zooms, shift-wheel "
             "moves, Ctrl+0 shows all again."))) {
    editor_->setAccessibleName(tr("Transfer function"));
    auto* felt = row_of({check({"show_surface", tr("Surface"), tr("The isosurface that is felt")},
                               its_[&Look::surface]),
                         colour({"surface_colour", "", tr("Colour of the isosurface")},
                                its_[&Look::surface_colour]),
                         quantity({"surface_opacity", "", tr("Opacity of the isosurface, 0 to 1"),
                                   tr("Opacity of the isosurface")},
                                  parts_span, as_part(its_[&Look::surface_opacity]))},
                        2);
    auto* others = column_of({});
    for (std::size_t i = 0; i < most_surfaces; ++i) others->layout()->addWidget(make_surface(i));
    others->layout()->addWidget(button(
        {"add_surface", tr("Add a surface"),
         tr("See another level beside the one that is felt: skin over bone")},
        [this] { add_surface(); }, [this] { return look_.surfaces.size() < most_surfaces; }));
    auto* cut = choice(
        {"cut", "",
         tr("Cut surfaces and volume open, to see inside. Drag the blue balls in the scene.\n"
            "Choose the plane again to have it face you."),
         tr("Cut away")},
        {tr("nothing"), tr("by a plane"), tr("to a box")},
        {[this] { return static_cast<int>(look_.cut); },
         [this](int at) { set_cut(static_cast<Cut>(at)); }});
    column_in(this, {felt, others, row_of({label_for(tr("Cut away"), cut), cut}, 1), make_volume(),
                     make_rest()});
    connect(editor_, &LevelChart::curve_changed, this, &LookControls::take_transfer);
    connect(editor_, &LevelChart::knot_held, this, &LookControls::refresh);
    connect(editor_, &LevelChart::knot_activated, findChild<ColourButton*>("point_colour"),
            &ColourButton::choose);
    connect(&views_.scene(), &Scene::cut_moved, this, &LookControls::set_look);
    refresh();
}

/// Rows of surfaces that there are not are hidden.
QWidget* LookControls::make_surface(std::size_t at) {
    const int number = static_cast<int>(at) + 1;
    const QString name = QString("surface_%1").arg(number);
    const Parts<SeenSurface> surface = its_.at(&Look::surfaces, at);
    auto* level = this->number(
        {name + "_level", "", tr("Its level [data units]; also a line to drag on the histogram"),
         tr("Level of surface %1").arg(number)},
        surface[&SeenSurface::level]);
    auto* opacity = this->number(
        {name + "_opacity", "", tr("Its opacity, 0 to 1"), tr("Opacity of surface %1").arg(number)},
        as_part(surface[&SeenSurface::opacity]));
    auto* felt = button(
        {name + "_feel", tr("Feel"), tr("Feel this one; the one felt now takes its place here"),
         tr("Feel surface %1").arg(number)},
        [this, at] { feel(at); });
    auto* remove = button(
        {name + "_remove", "×", tr("Remove it"), tr("Remove surface %1").arg(number)}, [this, at] {
            change([at](Look& look) {
                look.surfaces.erase(look.surfaces.begin() + std::ptrdiff_t(at));
            });
        });
    const int em = fontMetrics().height();
    opacity->setSingleStep(0.05);
    opacity->setMaximumWidth(5 * em);
    felt->setMaximumWidth(3 * em);
    remove->setMaximumWidth(2 * em);
    each_time(level, [this](NumberBox& box) { box.setSingleStep(editor_->fine_step()); });
    each_time(felt, [this](QWidget& one) {
        allow(one, have_surfaces(effect_.settings().layers)
                       ? tr("Layers are felt, not an isovalue: choose No layers to feel one")
                       : QString());
    });
    QWidget* row = row_of(
        {check({name, "", tr("Surface %1 is seen").arg(number), tr("Surface %1").arg(number)},
               surface[&SeenSurface::shown]),
         colour({name + "_colour", "", tr("Colour of surface %1").arg(number)},
                surface[&SeenSurface::colour]),
         level, opacity, felt, remove},
        2);
    return each_time(row, [this, at](QWidget& one) { one.setVisible(at < look_.surfaces.size()); });
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
        return !near(felt) && std::ranges::none_of(look_.surfaces, near, &SeenSurface::level);
    };
    const auto found = std::ranges::find_if(levels, is_new);
    SeenSurface added;
    added.level = found == levels.end() ? levels.back() : *found;
    added.colour = colours[look_.surfaces.size() % std::size(colours)];
    const bool outside = effect_.field().sign() * (added.level - felt) < 0;
    if (outside) added.opacity = glass;
    change([&](Look& look) {
        if (!outside && look.surface_opacity == 1) look.surface_opacity = glass;
        look.surfaces.push_back(added);
    });
}

/// The level of a surface becomes the isovalue, and the previous isovalue takes its place.
void LookControls::feel(std::size_t at) {
    if (!effect_.there()) return;
    const double felt = effect_.isovalue();
    if (!effect_.request(command::Isovalue{look_.surfaces.at(at).level})) return;
    change([&](Look& look) {
        SeenSurface& surface = look.surfaces.at(at);
        surface.level = felt;
        std::swap(surface.colour, look.surface_colour);
        std::swap(surface.opacity, look.surface_opacity);
    });
}

QWidget* LookControls::make_volume() {
    preset_ = choice({"preset", "",
                      tr("Transfer functions made for these data; choose one again to undo "
                         "changes")},
                     std::vector<std::string>{},
                     {[this] { return look_.transfer.preset; },
                      [this](const std::string& name) {
                          if (!effect_.there()) return;
                          change([&](Look& look) {
                              look.transfer =
                                  preset(name, effect_.histogram(), effect_.field().volume());
                          });
                      }});
    each_time(editor_, [this](LevelChart& editor) {
        CurveLine line;
        line.fewest = 2;
        for (const ControlPoint& point : look_.transfer.points) {
            line.knots.push_back({point.level, point.opacity});
            line.colours.push_back(point.colour);
        }
        editor.set_curve(line);
    });
    const Parts<ControlPoint> point{
        [this]() -> const ControlPoint& {
            static const ControlPoint none;
            return held_point() ? *held_point() : none;
        },
        [this](const std::function<void(ControlPoint&)>& how) { change_point(how); }};
    auto* level = number({"point_level", "", tr("Level of the chosen point [data units]")},
                         point[&ControlPoint::level]);
    auto* opacity = number({"point_opacity", "",
                            tr("Opacity of the chosen point, 0 to 1, of a layer as thick as the "
                               "smallest spacing")},
                           as_part(point[&ControlPoint::opacity]));
    auto* its_colour = colour({"point_colour", "", tr("Colour of the chosen point")},
                              point[&ControlPoint::colour]);
    opacity->setSingleStep(0.05);
    each_time(level, [this](NumberBox& box) { box.setSingleStep(editor_->fine_step()); });
    for (NumberBox* box : {level, opacity}) {
        box->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
        box->setMinimumWidth(5 * fontMetrics().height());  // its range would need more
    }
    for (QWidget* one : std::initializer_list<QWidget*>{level, opacity, its_colour}) {
        each_time(one, [this](QWidget& shown) { shown.setEnabled(held_point()); });
    }
    return column_of(
        {row_of(
             {check({"show_volume", tr("Volume"), tr("Volume rendering by the transfer function")},
                    its_[&Look::volume]),
              check({"show_shading", tr("Shading"), tr("Light on the volume, by its gradients")},
                    its_[&Look::shading]),
              check({"show_maximum", tr("Maximum"),
                     tr("Maximum intensity projection: the brightest sample along each line of "
                        "sight, black to white over the levels below")},
                    its_[&Look::maximum])}),
         preset_, editor_, row_of({new QLabel(tr("Point")), level, opacity, its_colour})});
}

QWidget* LookControls::make_rest() {
    struct Switch {
        bool Look::*shown;
        const char* name;
        QString text, tip;
    };
    const Switch switches[] = {
        {&Look::slices, "slices", tr("Slices"), tr("Three planes through the crosshair")},
        {&Look::contact, "contact", tr("Hand and proxy"),
         tr("HIP, SCP, the spring between them and the force")},
        {&Look::tetrahedra, "tetrahedra", tr("Tetrahedra"),
         tr("Those round the proxy, with the surface in them")},
        {&Look::planes, "planes", tr("Constraint planes"),
         tr("Those of the tetrahedra round the proxy")},
        {&Look::box, "box", tr("Box"), tr("The bounds of the data")},
        {&Look::orientation, "orientation", tr("Orientation cube"),
         tr("L, R, A, P, S, I: sides of the body")},
        {&Look::scale_bar, "scale_bar", tr("Scale bar"), tr("A length in the picture")}};
    auto* all = column_of({});
    all->layout()->setSpacing(2);
    for (const auto& [shown, name, text, tip] : switches) {
        all->layout()->addWidget(check({QString("show_") + name, text, tip}, its_[shown]));
    }
    auto* colours = choice({"colours", "", tr("Colour map of the slices")}, colour_map_names(),
                           its_[&Look::colours]);
    return column_of({all, row_of({label_for(tr("Slices' colours"), colours), colours}, 1)});
}

const ControlPoint* LookControls::held_point() const {
    const auto at = static_cast<std::size_t>(editor_->held_knot());
    return at < look_.transfer.points.size() ? &look_.transfer.points[at] : nullptr;
}

void LookControls::take_transfer(const Knots& knots, const std::vector<Colour>& colours) {
    change([&](Look& look) {
        look.transfer = {};
        for (std::size_t i = 0; i < knots.size(); ++i) {
            look.transfer.points.push_back({knots[i].at, colours[i], knots[i].value});
        }
    });
}

void LookControls::begin() {
    preset_->clear();
    for (const auto& name : preset_names(effect_.histogram(), effect_.field().volume())) {
        add_choice(*preset_, name);
    }
    editor_->set_data(effect_.histogram(), {});
}

void LookControls::set_look(const Look& look) {
    look_ = look;
    refresh();
    set(views_, &Shown::look, look_);
    Q_EMIT look_changed(look_);
}

void LookControls::change(const std::function<void(Look&)>& how) {
    Look next = look_;
    how(next);
    set_look(next);
}

void LookControls::set_cut(Cut cut) {
    const Vec3 towards = views_.scene().camera().towards_viewer;
    set_look(with_cut(look_, cut, views_.shown().crosshair, towards));
}

void LookControls::use_usual_look() {
    const Opened& opened = *content_.volume();
    const Volume& volume = opened.loaded.volume;
    Look look = look_;
    look.transfer = preset(suggested_preset(opened.histogram, volume), opened.histogram, volume);
    // Of the volume before.
    look.surfaces.clear();
    look.cut = Cut::nothing;
    look.overlay = {};
    set_look(look);
}

}  // namespace palpate::viewer

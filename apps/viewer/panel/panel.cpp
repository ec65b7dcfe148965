// Turns changes by the user into commands, and shows the settings in effect.
#include "apps/viewer/panel/panel.hpp"

#include <QScrollArea>
#include <QScrollBar>
#include <QTabWidget>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/viewer/panel/brush_controls.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/device_controls.hpp"
#include "apps/viewer/panel/force_controls.hpp"
#include "apps/viewer/panel/isovalue_controls.hpp"
#include "apps/viewer/panel/layers_controls.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/look_controls.hpp"
#include "apps/viewer/panel/loop_view.hpp"
#include "apps/viewer/panel/overlay_controls.hpp"
#include "apps/viewer/panel/penetrability_controls.hpp"
#include "apps/viewer/panel/property_words.hpp"
#include "apps/viewer/panel/section.hpp"
#include "apps/viewer/panel/session_bar.hpp"
#include "apps/viewer/panel/tool_controls.hpp"

namespace palpate::viewer {
namespace {

/// Sections in a column that scrolls.
QScrollArea* page_of(std::initializer_list<QWidget*> sections) {
    auto* column = column_of(sections);
    static_cast<QVBoxLayout*>(column->layout())->addStretch(1);
    auto* page = new QScrollArea;
    page->setWidget(column);
    page->setWidgetResizable(true);
    page->setFrameShape(QFrame::NoFrame);
    page->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    page->setMinimumWidth(column->minimumSizeHint().width() +
                          page->verticalScrollBar()->sizeHint().width());
    return page;
}

}  // namespace

Panel::Panel(QWidget* parent)
    : QWidget(parent),
      isovalue_(new IsovalueControls),
      layers_(new LayersControls),
      penetrability_(new PenetrabilityControls(isovalue_->chart())),
      tool_(new ToolControls),
      edit_(new BrushControls),
      force_(new ForceControls),
      device_(new DeviceControls),
      loop_(new LoopView),
      look_(new LookControls),
      overlay_(new OverlayControls),
      bar_(new SessionBar),
      tabs_(named(new QTabWidget, "tabs")) {
    setObjectName("panel");
    build();
    connect_sections();
    let_return_press_buttons(*this);
    clear();
}

Panel::~Panel() = default;

void Panel::build() {
    session_part_ = new Section(tr("Session"), "session_part", bar_);
    isovalue_part_ = new Section(tr("Isovalue"), "isovalue_part", isovalue_);
    layers_part_ = new Section(tr("Layers"), "layers_part", layers_);
    penetrability_part_ =
        new Section(tr("Pressing through (penetrability)"), "penetrability_part", penetrability_);
    tool_part_ = new Section(tr("Tool"), "tool_part", tool_);
    edit_part_ = new Section(tr("Edit"), "edit_part", edit_);
    force_part_ = new Section(tr("Force"), "force_part", force_);
    device_part_ = new Section(tr("Device"), "device_part", device_);
    loop_part_ = new Section(tr("Advanced: servo loop"), "loop_part", loop_);
    look_part_ = new Section(tr("Look"), "look_part", look_);
    overlay_part_ = new Section(tr("Overlay"), "overlay_part", overlay_);
    loop_part_->set_open(false);
    sections_ = {session_part_, isovalue_part_, layers_part_, penetrability_part_,
                 tool_part_,    force_part_,    look_part_,   edit_part_,
                 overlay_part_, device_part_,   loop_part_};
    tabs_->setDocumentMode(true);
    const auto add = [this](const QString& title, std::initializer_list<QWidget*> sections) {
        QScrollArea* page = page_of(sections);
        tabs_->addTab(page, title);
        page->setAccessibleName(QString(title).remove('&'));
    };
    add(tr("Fee&l"), {layers_part_, penetrability_part_, tool_part_, force_part_});
    add(tr("L&ook"), {look_part_});
    add(tr("D&ata"), {edit_part_, overlay_part_});
    add(tr("Devi&ce"), {device_part_, loop_part_});
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(6, 6, 6, 0);
    column->addWidget(session_part_);
    column->addWidget(isovalue_part_);
    column->addWidget(tabs_, 1);
}

/// Shows the page that a section is on.
void Panel::raise_page(const Section& section) {
    for (int i = 0; i < tabs_->count(); ++i) {
        if (tabs_->widget(i)->isAncestorOf(&section)) tabs_->setCurrentIndex(i);
    }
}

void Panel::connect_sections() {
    connect(isovalue_, &IsovalueControls::wanted, this,
            [this](double level) { ask(isovalue_part_, command::Isovalue{level}); });
    connect(isovalue_, &IsovalueControls::field_wanted, this,
            [this](Solid solid, Interpolation interpolation) {
                if (solid == solid_ && interpolation == interpolation_) return;
                begin_request(isovalue_part_);
                Q_EMIT field_chosen(solid, interpolation);
                // A session with this field has been set by now, unless it failed.
                isovalue_->set_field(solid_, interpolation_);
            });
    connect(penetrability_, &PenetrabilityControls::wanted, this, &Panel::ask_penetrability);
    connect(penetrability_, &PenetrabilityControls::nonsense, penetrability_part_, &Section::say);
    connect(tool_, &ToolControls::wanted, this, [this](const std::shared_ptr<const Tool>& tool) {
        ask(tool_part_, command::UseTool{tool});
    });
    connect(tool_, &ToolControls::nonsense, tool_part_, &Section::say);
    connect(force_, &ForceControls::asked, this,
            [this](const Command& command) { ask(force_part_, command); });
    connect(device_, &DeviceControls::scale_wanted, this,
            [this](double scale) { ask(device_part_, command::Scale{scale}); });
    connect(device_, &DeviceControls::nonsense, device_part_, &Section::say);
    connect(device_, &DeviceControls::chosen, this, [this](const QString& option) {
        begin_request(device_part_);
        Q_EMIT device_chosen(option);
    });
    connect(bar_, &SessionBar::asked, this,
            [this](const Command& command) { ask(session_part_, command); });
    connect_layers();
    connect_edits();
    connect_look();
}

/// Levels of layers are the first marks on the chart.
void Panel::connect_layers() {
    connect(layers_, &LayersControls::wanted, this, &Panel::ask_layers);
    connect(&isovalue_->chart(), &LevelChart::curve_changed, layers_, &LayersControls::set_curve);
    connect(layers_, &LayersControls::curve_chosen, this, &Panel::show_marks);
    connect(overlay_, &OverlayControls::feel_wanted, this, [this] { raise_page(*layers_part_); });
    connect(&isovalue_->chart(), &LevelChart::mark_chosen, this, [this](int mark) {
        if (mark < static_cast<int>(levels_in(layers_->layers()))) layers_->choose_layer(mark);
    });
    connect(&isovalue_->chart(), &LevelChart::mark_moved, this, [this](int mark, double level) {
        const auto count = static_cast<int>(levels_in(now_.settings.layers));
        if (mark < count) return layers_->move_level(mark, level);
        look_->move_surface(mark - count, level);
    });
}

void Panel::ask_layers(const SharedLayers& layers) {
    const SharedLayers& before = now_.settings.layers;
    // Edited layers keep their names: what gave way stays open.
    const bool same_surfaces =
        before && layers &&
        std::ranges::equal(before->layers, layers->layers, {}, &Layer::name, &Layer::name);
    ask(layers_part_, command::UseLayers{layers, same_surfaces});
}

/// Surfaces of the look are levels on the chart.
void Panel::connect_look() {
    connect(look_, &LookControls::look_changed, this, &Panel::show_marks);
    connect(look_, &LookControls::look_set, this, &Panel::show_marks);
    connect(look_, &LookControls::look_set, this,
            [this] { overlay_->set_look(look_->look().overlay); });
    connect(overlay_, &OverlayControls::look_changed, look_, &LookControls::set_overlay_look);
    connect(look_, &LookControls::feel_wanted, this, [this](int row) {
        const double felt = now_.isovalue;
        const double level = look_->look().surfaces.at(static_cast<std::size_t>(row)).level;
        ask(isovalue_part_, command::Isovalue{level});
        if (now_.isovalue == level) look_->swap_felt(row, felt);
    });
}

void Panel::show_marks() {
    std::vector<LevelMark> marks;
    const SharedLayers& layers = layers_->layers();
    const auto levels = static_cast<int>(levels_in(layers));
    for (int i = 0; i < levels; ++i) {
        const Layer& layer = layers->layers[static_cast<std::size_t>(i)];
        const auto [low, high] = layers_->room(i);
        marks.push_back({layer.level, to_qt({layer.colour[0], layer.colour[1], layer.colour[2]}),
                         QString::fromStdString(layer.name), low, high});
    }
    for (const SeenSurface& surface : look_->look().surfaces) {
        LevelMark mark;
        mark.level = surface.level;
        mark.colour = to_qt(surface.colour);
        marks.push_back(mark);
    }
    isovalue_->chart().set_marks(marks);
    const PropertyWords& words = words_of(layers_->curve_property());
    isovalue_->chart().set_curve(layers ? (*layers)[words.property].density.knots : Knots(),
                                 words.high, words.unit);
}

void Panel::connect_edits() {
    connect(edit_, &BrushControls::changed, this, [this](const BrushChoice& brush) {
        if (!live_) return;
        begin_request(edit_part_);
        now_.brush = brush;
        Q_EMIT brush_changed(brush);
    });
    connect(edit_, &BrushControls::nonsense, edit_part_, &Section::say);
    // A refusal of these changes nothing in the panel.
    const auto pass = [this](void (Panel::*signal)()) {
        return [this, signal] {
            begin_request(edit_part_);
            Q_EMIT(this->*signal)();
        };
    };
    connect(edit_, &BrushControls::undo, this, pass(&Panel::undo_asked));
    connect(edit_, &BrushControls::redo, this, pass(&Panel::redo_asked));
    connect(edit_, &BrushControls::save, this, pass(&Panel::save_asked));
}

void Panel::set_session(const Field& field, const run::Histogram& histogram, double isovalue,
                        const RendererSettings& settings, const DeviceInfo& device) {
    isovalue_->drop();
    layers_->drop();
    tool_->drop();
    force_->drop();
    live_ = true;
    solid_ = field.solid();
    interpolation_ = field.interpolation();
    unedited_.emplace(field.volume(), field.solid(), field.background(), field.interpolation());
    edit_->set_grid(field.geometry());
    tool_->set_grid(field.geometry());
    clear_edits();
    now_ = before_ = {settings, isovalue, false, false, edit_->choice()};
    asked_by_ = nullptr;
    for (Section* part : sections_) {
        part->say({});
        part->setEnabled(true);
    }
    isovalue_->set_data(field, histogram);
    isovalue_->show_felt(isovalue, false);
    layers_->set_data(field.volume(), field.solid());
    penetrability_->set_session(settings.penetrability, solid_, isovalue, field.volume().minimum(),
                                field.volume().minimum() + field.volume().range());
    look_->set_data(field.volume(), histogram);
    bar_->set_session(settings);
    loop_->clear();
    device_->show_device(device, DeviceStatus::starting, {});
    overlay_->set_feelable(true);
    show_effect();
}

void Panel::clear_edits() {
    edit_->reset();
    edit_->set_history(0, 0, false);
    edit_->set_reason({});
}

void Panel::clear() {
    live_ = false;
    isovalue_->clear();
    layers_->clear();
    isovalue_->set_layered(false, false);
    look_->set_layered(false);
    penetrability_->set_layered(false);
    overlay_->set_feelable(false);
    penetrability_->drop();
    tool_->clear();
    force_->drop();
    clear_edits();
    now_.settings.layers = nullptr;
    now_.settings.tool = nullptr;
    now_.brush = before_.brush = edit_->choice();
    unedited_.reset();
    bar_->clear();
    loop_->clear();
    device_->clear();
    look_->clear();
    for (Section* part : sections_) {
        part->say({});
        part->setEnabled(false);
    }
}

void Panel::set_observing(bool observing) {
    for (Section* part : sections_) {
        const bool looks = part == look_part_ || part == overlay_part_;
        if (part != loop_part_ && !looks) part->setEnabled(!observing);
    }
}

void Panel::set_brush(const BrushChoice& brush) {
    edit_->set_choice(brush);
    now_.brush = brush;
}

const BrushChoice& Panel::brush() const {
    return edit_->choice();
}

/// Shows the settings in effect in every section that commands change.
void Panel::show_effect() {
    isovalue_->set_isovalue(now_.isovalue);
    isovalue_->set_field(solid_, interpolation_);
    isovalue_->set_overruled(now_.settings.penetrability.on);
    const bool layered = have_surfaces(now_.settings.layers);
    isovalue_->set_layered(layered, levels_in(now_.settings.layers) > 0);
    penetrability_->set_layered(layered);
    look_->set_layered(layered);
    layers_->set_layers(now_.settings, now_.isovalue);
    tool_->set_tool(now_.settings.tool);
    look_->set_felt(now_.isovalue, solid_);
    show_marks();
    penetrability_->set_in_use(now_.settings.penetrability);
    force_->set_settings(now_.settings.force, now_.settings.proxy.friction, now_.settings.device);
    device_->set_scale(now_.settings.transform.scale);
    edit_->set_choice(now_.brush);
    edit_->set_tool(now_.settings.tool != nullptr);
    show_fitting();
}

/// The automatic values of the brush at the level in effect.
void Panel::show_fitting() {
    if (!unedited_) return;
    const auto fitting = [&](BrushKind kind) {
        return brush_for(kind, *unedited_, now_.isovalue, now_.brush.radius).value;
    };
    edit_->set_fitting(fitting(BrushKind::carve), fitting(BrushKind::add));
}

/// Remembers the settings in effect: show_refused() goes back to them.
void Panel::begin_request(Section* by) {
    by->say({});
    asked_by_ = by;
    before_ = now_;
}

/// Expects that a command is carried out.
void Panel::take(const Command& command) {
    RendererSettings& settings = now_.settings;
    std::visit(Overloaded{[&](const command::Isovalue& c) { now_.isovalue = c.isovalue; },
                          [&](const ForceSettings& force) { settings.force = force; },
                          [&](const Friction& friction) { settings.proxy.friction = friction; },
                          [&](const Penetrability& given) { settings.penetrability = given; },
                          [&](const command::UseLayers& c) { settings.layers = c.layers; },
                          [&](const command::UseTool& c) { settings.tool = c.tool; },
                          [&](const command::Forces& forces) { settings.forces_on = forces.on; },
                          [&](const command::Freeze& freeze) { now_.frozen = freeze.on; },
                          [&](const command::Clutch& clutch) { now_.clutched = clutch.on; },
                          [&](const command::Scale& c) { settings.transform.scale = c.scale; },
                          [&](const DeviceTransform& transform) { settings.transform = transform; },
                          [&](const DeviceLimits& limits) { settings.device = limits; },
                          // Not shown in the panel.
                          [](const command::Samples&) {}, [](const command::Moment&) {},
                          [](const command::Speed&) {}, [](const command::Lift&) {},
                          [](const command::Resume&) {}},
               command);
}

/// Asks for a command if it is one that the session can carry out; else says why not. It may be
/// refused while `asked` is emitted.
void Panel::ask(Section* by, const Command& command) {
    if (!live_) return;
    if (std::holds_alternative<command::Isovalue>(command) && have_surfaces(now_.settings.layers)) {
        return refuse(by, tr("layers are felt, not an isovalue: choose No layers to feel one"));
    }
    try {
        palpate::check(command, now_.settings, {unedited_->geometry(), solid_, interpolation_});
    } catch (const std::invalid_argument& error) {
        refuse(by, QString::fromStdString(error.what()));
        return;
    }
    begin_request(by);
    refused_ = false;
    take(command);
    Q_EMIT asked(command);
    if (!refused_ && live_) show_effect();
}

void Panel::request(const Command& command) {
    ask(std::holds_alternative<command::Isovalue>(command) ? isovalue_part_ : device_part_,
        command);
}

void Panel::ask_penetrability(const PressThrough& next) {
    Penetrability penetrability;
    try {
        penetrability = penetrability_of(next, solid_);
    } catch (const std::invalid_argument& error) {
        refuse(penetrability_part_, QString::fromStdString(error.what()));
        return;
    }
    const bool ends = now_.settings.penetrability.on && !penetrability.on;
    ask(penetrability_part_, penetrability);
    // Else the session keeps the level that the hand has reached.
    if (ends && !refused_) ask(isovalue_part_, command::Isovalue{now_.isovalue});
}

void Panel::refuse(Section* by, const QString& why) {
    by->say(why);
    raise_page(*by);
    show_effect();
}

void Panel::show_refused(const QString& why) {
    refused_ = true;
    now_ = before_;
    Section* by = asked_by_ ? asked_by_ : session_part_;
    by->say(why);
    raise_page(*by);
    if (!live_) return;
    show_effect();
    bar_->set_forces(now_.settings.forces_on);
    bar_->set_frozen(now_.frozen);
    bar_->set_clutched(now_.clutched);
    if (by == device_part_) device_->show_current();
}

void Panel::show_snapshot(const Snapshot& snapshot) {
    if (!live_) return;
    now_.frozen = snapshot.session.frozen;
    now_.clutched = snapshot.session.clutched;
    now_.settings.forces_on = snapshot.forces_on;
    now_.settings.transform = snapshot.session.transform;
    const double limit = std::min(now_.settings.force.limit, now_.settings.device.maximum_force);
    bar_->show_snapshot(snapshot, limit);
    isovalue_->show_felt(snapshot.session.tick.proxy.isovalue, snapshot.penetrability_on);
    device_->show_status(snapshot.session.device.status);
    device_->show_scale(snapshot.session.transform.scale);
}

void Panel::show_stroke(const Snapshot& snapshot) {
    if (live_) layers_->show_snapshot(snapshot);
}

void Panel::show_report(const ServoReport& report, double rate) {
    if (live_) loop_->show_report(report, rate);
}

void Panel::show_device(const DeviceInfo& info, DeviceStatus status, const QString& problem) {
    if (live_) device_->show_device(info, status, problem);
}

}  // namespace palpate::viewer

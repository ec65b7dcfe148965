// Turns changes by the user into commands, and shows the settings in effect.
#include "apps/viewer/panel/panel.hpp"

#include <QEvent>
#include <QScrollArea>
#include <QScrollBar>
#include <QTabWidget>
#include <QVBoxLayout>

#include "apps/viewer/panel/brush_controls.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/device_controls.hpp"
#include "apps/viewer/panel/force_controls.hpp"
#include "apps/viewer/panel/isovalue_controls.hpp"
#include "apps/viewer/panel/layer_editor.hpp"
#include "apps/viewer/panel/layers_controls.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/look_controls.hpp"
#include "apps/viewer/panel/overlay_controls.hpp"
#include "apps/viewer/panel/penetrability_controls.hpp"
#include "apps/viewer/panel/session_bar.hpp"
#include "apps/viewer/panel/tool_controls.hpp"

namespace palpate::viewer {
namespace {

/// Sections in a column that scrolls up and down: as wide as what is unfolded needs.
class Page : public QScrollArea {
  public:
    explicit Page(std::initializer_list<QWidget*> sections) {
        auto* column = column_of(sections);
        static_cast<QVBoxLayout*>(column->layout())->addStretch(1);
        setWidget(column);
        setWidgetResizable(true);
        setFrameShape(QFrame::NoFrame);
        setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
        fit();
    }

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override {
        if (watched == widget() && event->type() == QEvent::LayoutRequest) fit();
        return QScrollArea::eventFilter(watched, event);
    }

  private:
    void fit() {
        setMinimumWidth(widget()->minimumSizeHint().width() +
                        verticalScrollBar()->sizeHint().width());
    }
};

}  // namespace

Panel::Panel(Effect& effect, QWidget* parent)
    : QWidget(parent),
      effect_(effect),
      hands_(new HandSwitch),
      isovalue_(new IsovalueControls(effect)),
      layers_(new LayersControls(effect)),
      penetrability_(new PenetrabilityControls(effect, isovalue_->chart())),
      tool_(new ToolControls(effect)),
      edit_(new BrushControls),
      force_(new ForceControls(effect)),
      device_(new DeviceControls(effect)),
      loop_(new LoopView),
      look_(new LookControls(effect)),
      overlay_(new OverlayControls),
      bar_(new SessionBar(effect)),
      tabs_(named(new QTabWidget, "tabs")) {
    setObjectName("panel");
    build();
    connect_effect();
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
        auto* page = new Page(sections);
        tabs_->addTab(page, title);
        page->setAccessibleName(QString(title).remove('&'));
    };
    add(tr("Fee&l"), {layers_part_, penetrability_part_, tool_part_, force_part_});
    add(tr("L&ook"), {look_part_});
    add(tr("D&ata"), {edit_part_, overlay_part_});
    add(tr("Devi&ce"), {device_part_, loop_part_});
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(6, 6, 6, 0);
    column->addWidget(hands_);
    column->addWidget(session_part_);
    column->addWidget(isovalue_part_);
    column->addWidget(tabs_, 1);
}

void Panel::raise_page(const Section& section) {
    for (int i = 0; i < tabs_->count(); ++i) {
        if (tabs_->widget(i)->isAncestorOf(&section)) tabs_->setCurrentIndex(i);
    }
}

/// Sections show the effect by themselves; here are their notes, and what several of them share.
void Panel::connect_effect() {
    connect(&effect_, &Effect::begun, this, &Panel::begin);
    connect(&effect_, &Effect::ended, this, &Panel::clear);
    connect(&effect_, &Effect::changed, this, [this] {
        show_marks();
        edit_->set_tool(effect_.settings().tool != nullptr);
        show_fitting();
    });
    connect(&effect_, &Effect::answered, this, [this](const Command& command, const QString& why) {
        Section& section = section_of(command);
        section.say(why);
        if (!why.isEmpty()) raise_page(section);
    });
}

/// Where a command is asked for.
Section& Panel::section_of(const Command& command) const {
    return *std::visit(Overloaded{[&](const command::Isovalue&) { return isovalue_part_; },
                                  [&](const command::UseLayers&) { return layers_part_; },
                                  [&](const command::UseTool&) { return tool_part_; },
                                  [&](const command::Scale&) { return device_part_; },
                                  [&](const Penetrability&) { return penetrability_part_; },
                                  [&](const ForceSettings&) { return force_part_; },
                                  [&](const Friction&) { return force_part_; },
                                  [&](const auto&) { return session_part_; }},
                       command);
}

void Panel::connect_sections() {
    connect(penetrability_, &PenetrabilityControls::nonsense, penetrability_part_, &Section::say);
    connect(tool_, &ToolControls::nonsense, tool_part_, &Section::say);
    connect(device_, &DeviceControls::nonsense, device_part_, &Section::say);
    for (const auto asked : {&DeviceControls::chosen, &DeviceControls::added}) {
        connect(device_, asked, device_part_, [this] { device_part_->say({}); });
    }
    connect_layers();
    connect_edits();
    connect_look();
}

/// Levels of layers are the first marks on the chart.
void Panel::connect_layers() {
    connect(&isovalue_->chart(), &LevelChart::curve_changed, layers_, &LayersControls::set_curve);
    connect(layers_, &LayersControls::curve_chosen, this, &Panel::show_marks);
    connect(overlay_, &OverlayControls::feel_wanted, this, [this] { raise_page(*layers_part_); });
    connect(&isovalue_->chart(), &LevelChart::mark_chosen, this, [this](int mark) {
        if (mark < static_cast<int>(levels_in(layers_->layers()))) layers_->choose_layer(mark);
    });
    connect(&isovalue_->chart(), &LevelChart::mark_moved, this, [this](int mark, double level) {
        const auto count = static_cast<int>(levels_in(layers_->layers()));
        if (mark < count) return layers_->move_level(mark, level);
        look_->move_surface(mark - count, level);
    });
}

/// Surfaces of the look are levels on the chart.
void Panel::connect_look() {
    connect(look_, &LookControls::look_changed, this, &Panel::show_marks);
    connect(look_, &LookControls::look_set, this, &Panel::show_marks);
    connect(look_, &LookControls::look_set, this,
            [this] { overlay_->set_look(look_->look().overlay); });
    connect(overlay_, &OverlayControls::look_changed, look_, &LookControls::set_overlay_look);
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
    isovalue_->chart().set_curve(line_of(layers ? (*layers)[words.property].density.knots : Knots(),
                                         words.high, words.unit));
}

void Panel::connect_edits() {
    const auto quiet = [this] { edit_part_->say({}); };
    connect(edit_, &BrushControls::changed, edit_part_, quiet);
    connect(edit_, &BrushControls::undo, edit_part_, quiet);
    connect(edit_, &BrushControls::redo, edit_part_, quiet);
    connect(edit_, &BrushControls::save, edit_part_, quiet);
    connect(edit_, &BrushControls::nonsense, edit_part_, &Section::say);
}

void Panel::begin() {
    edit_->set_grid(effect_.field().geometry());
    clear_edits();
    for (Section* part : sections_) {
        part->say({});
        const bool looks = part == look_part_ || part == overlay_part_ || part == loop_part_;
        part->setEnabled(looks || !effect_.is_played());
    }
    loop_->clear();
    overlay_->set_feelable(true);
}

void Panel::clear_edits() {
    edit_->reset();
    edit_->set_history(0, 0, false);
    edit_->set_reason({});
}

void Panel::clear() {
    overlay_->set_feelable(false);
    clear_edits();
    loop_->clear();
    for (Section* part : sections_) {
        part->say({});
        part->setEnabled(false);
    }
}

/// The automatic values of the brush at the level in effect, from samples without edits.
void Panel::show_fitting() {
    const Field& felt = effect_.field();
    const Field field(felt.volume(), felt.solid(), felt.background(), felt.interpolation());
    const auto fitting = [&](BrushKind kind) {
        return brush_for(kind, field, effect_.isovalue(), edit_->choice().radius).value;
    };
    edit_->set_fitting(fitting(BrushKind::carve), fitting(BrushKind::add));
}

}  // namespace palpate::viewer

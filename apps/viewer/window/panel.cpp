// Turns changes by the user into commands, and shows the settings in effect.
#include "apps/viewer/window/panel.hpp"

#include <QEvent>
#include <QProxyStyle>
#include <QRegularExpression>
#include <QScrollArea>
#include <QScrollBar>
#include <QTabBar>
#include <QTabWidget>
#include <QVBoxLayout>

#include <algorithm>
#include <utility>
#include <vector>

#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "apps/viewer/window/isovalue_controls.hpp"
#include "apps/viewer/window/layers_controls.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/overlay_controls.hpp"
#include "apps/viewer/window/tool_controls.hpp"

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
        setMinimumHeight(8 * fontMetrics().lineSpacing());  // the chart above gives its room
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

/// Four pages stand side by side in a quarter of a small window.
class NarrowTabs : public QProxyStyle {
  public:
    int pixelMetric(PixelMetric metric, const QStyleOption* option,
                    const QWidget* widget) const override {
        const int usual = QProxyStyle::pixelMetric(metric, option, widget);
        return metric == PM_TabBarTabHSpace ? usual / 2 : usual;
    }
};

}  // namespace

Panel::Panel(const Desk& desk, QWidget* parent)
    : QWidget(parent),
      effect_(desk.effect()),
      isovalue_(new IsovalueControls(desk)),
      tool_(new ToolControls(desk)),
      brush_(new BrushControls(desk)),
      hands_(new HandSwitch(desk, *brush_)),
      device_(new DeviceControls(desk)),
      loop_(new LoopView(desk)),
      look_(new LookControls(desk)),
      overlay_(new OverlayControls(desk, *look_)),
      layers_(new LayersControls(desk, *look_, *overlay_)),
      tabs_(named(new QTabWidget, "tabs")) {
    setObjectName("panel");
    build();
    connect(&effect_, &Effect::answered, this, &Panel::answer);
    connect(&effect_, &Effect::changed, this, &Panel::show_marks);
    for (const auto over : {&Effect::begun, &Effect::ended}) {
        connect(&effect_, over, this, &Panel::enable);
    }
    connect_levels();
    let_return_press_buttons(*this);
    enable();
}

Panel::~Panel() = default;

/// At most a quarter of the window, as far as its parts allow: the picture needs the room.
QSize Panel::sizeHint() const {
    const int enough = 24 * fontMetrics().height();
    const int width = std::min(window()->width() / 4, enough);
    return {std::max(width, minimumSizeHint().width()), QWidget::sizeHint().height()};
}

void Panel::build() {
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(4, 6, 4, 0);
    const auto part = [](const QString& title, const char* name, QWidget* content) {
        auto* section = new Section(title, name, content);
        if (auto* form = qobject_cast<Form*>(content)) {
            connect(form, &Form::nonsense, section, &Section::say);
        }
        return section;
    };
    // What everybody needs is unfolded: forces, isovalue, layers, tool and device.
    const auto folded = [&part](const QString& title, const char* name, QWidget* content) {
        Section* section = part(title, name, content);
        section->set_open(false);
        return section;
    };
    column->addWidget(hands_);
    column->addWidget(part(tr("Session"), "session_part", session_section(effect_)));
    column->addWidget(part(tr("Isovalue"), "isovalue_part", isovalue_));
    column->addWidget(tabs_, 1);
    tabs_->setDocumentMode(true);
    auto* narrow = new NarrowTabs;
    narrow->setParent(tabs_);
    tabs_->tabBar()->setStyle(narrow);
    const auto add = [this](const QString& title, std::initializer_list<QWidget*> sections) {
        auto* page = new Page(sections);
        tabs_->addTab(page, title);
        page->setAccessibleName(QString(title).remove('&'));
    };
    add(tr("Fee&l"), {part(tr("Layers"), "layers_part", layers_),
                      folded(tr("Pressing through"), "penetrability_part",
                             penetrability_section(effect_, isovalue_->chart())),
                      part(tr("Tool"), "tool_part", tool_),
                      folded(tr("Force"), "force_part", force_section(effect_))});
    add(tr("L&ook"), {part(tr("Look"), "look_part", look_)});
    add(tr("D&ata"),
        {part(tr("Edit"), "edit_part", brush_), part(tr("Overlay"), "overlay_part", overlay_)});
    add(tr("Devi&ce"), {part(tr("Device"), "device_part", device_),
                        folded(tr("Advanced: servo loop"), "loop_part", loop_)});
}

void Panel::show_section(const QWidget& content) {
    for (int i = 0; i < tabs_->count(); ++i) {
        if (tabs_->widget(i)->isAncestorOf(&content)) tabs_->setCurrentIndex(i);
    }
    for (auto* section : findChildren<Section*>()) {
        if (section->isAncestorOf(&content)) section->set_open(true);
    }
}

QList<const Note*> Panel::notes() const {
    QList<const Note*> said;
    for (const Note* note : findChildren<Note*>()) {
        if (note->isVisibleTo(this)) said << note;
    }
    return said;
}

QStringList Panel::folded() const {
    QStringList names;
    for (const auto* section : findChildren<Section*>()) {
        if (!section->is_open()) names << section->objectName();
    }
    return names;
}

void Panel::fold(const QStringList& names) {
    for (auto* section : findChildren<Section*>()) {
        section->set_open(!names.contains(section->objectName()));
    }
}

/// Shows the answer in the section that the command belongs to.
void Panel::answer(const Command& command, const QString& why) {
    const char* const part =
        std::visit(Overloaded{[](const command::Isovalue&) { return "isovalue_part"; },
                              [](const command::UseLayers&) { return "layers_part"; },
                              [](const command::UseTool&) { return "tool_part"; },
                              [](const command::Scale&) { return "device_part"; },
                              [](const Penetrability&) { return "penetrability_part"; },
                              [](const ForceSettings&) { return "force_part"; },
                              [](const Friction&) { return "force_part"; },
                              [](const auto&) { return "session_part"; }},
                   command);
    auto* section = findChild<Section*>(part);
    section->say(why);
    if (!why.isEmpty()) show_section(*section);
}

void Panel::connect_levels() {
    connect(&isovalue_->chart(), &LevelChart::curve_changed, layers_, &LayersControls::set_curve);
    connect(layers_, &LayersControls::curve_chosen, this, &Panel::show_marks);
    connect(look_, &LookControls::look_changed, this, &Panel::show_marks);
    connect(overlay_, &OverlayControls::feel_wanted, this, [this] { show_section(*layers_); });
}

void Panel::show_marks() {
    std::vector<LevelMark> marks;
    const SharedLayers& layers = layers_->layers();
    const auto levels = static_cast<int>(levels_in(layers));
    for (int i = 0; i < levels; ++i) {
        const Layer& layer = layers->layers[static_cast<std::size_t>(i)];
        const auto [low, high] = layers_->room(i);
        marks.push_back({layer.level, to_qt(colour_of(layer)),
                         [this, i](double to) { layers_->move_level(i, to); },
                         [this, i] { layers_->choose_layer(i); },
                         QString::fromStdString(layer.name), low, high});
    }
    const auto& surfaces = look_->look().surfaces;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        marks.push_back({surfaces[i].level, to_qt(surfaces[i].colour), [this, i](double to) {
                             look_->change([=](Look& look) { look.surfaces.at(i).level = to; });
                         }});
    }
    isovalue_->chart().set_marks(std::move(marks));
    const PropertyWords& words = words_of(layers_->curve_property());
    isovalue_->chart().set_curve(
        {layers ? (*layers)[words.property].density.knots : Knots(), words.high, words.unit});
}

void Panel::enable() {
    for (Section* part : findChildren<Section*>(QRegularExpression("_part$"))) {
        part->say({});
        const bool looks =
            part->isAncestorOf(look_) || part->isAncestorOf(overlay_) || part->isAncestorOf(loop_);
        part->setEnabled(effect_.there() && (looks || !effect_.is_played()));
    }
}

}  // namespace palpate::viewer

// The panel: all settings and readings of a live run, in sections that fold; those that are needed
// all the time above, the others on pages. It shows what is in effect, and asks there for changes.
#pragma once

#include <QWidget>

#include "apps/viewer/panel/effect.hpp"

class QTabWidget;

namespace palpate::viewer {

class BrushControls;
class Desk;
class DeviceControls;
class HandSwitch;
class IsovalueControls;
class LayersControls;
class LookControls;
class LoopView;
class OverlayControls;
class ToolControls;

/// GUI thread only.
class Panel : public QWidget {
    Q_OBJECT

  public:
    /// Of a recording only the look can be set, without a session nothing.
    explicit Panel(const Desk& desk, QWidget* parent = nullptr);
    ~Panel() override;
    QSize sizeHint() const override;
    /// Those that are said, of the sections that are seen.
    QList<const Note*> notes() const;

    IsovalueControls& isovalue_controls() { return *isovalue_; }
    LookControls& look_controls() { return *look_; }
    OverlayControls& overlay_controls() { return *overlay_; }
    LayersControls& layers_controls() { return *layers_; }
    BrushControls& brush_controls() { return *brush_; }
    DeviceControls& device_controls() { return *device_; }
    HandSwitch& hand_switch() { return *hands_; }
    ToolControls& tool_controls() { return *tool_; }
    LoopView& loop_view() { return *loop_; }
    /// The section with this content is unfolded, and its page in front.
    void show_section(const QWidget& content);
    /// Names of the sections that are folded.
    QStringList folded() const;
    void fold(const QStringList& names);

  private:
    void build();
    void answer(const Command& command, const QString& why);
    void connect_levels();
    void enable();
    void show_marks();

    Effect& effect_;
    IsovalueControls* isovalue_;
    ToolControls* tool_;
    BrushControls* brush_;
    HandSwitch* hands_;
    DeviceControls* device_;
    LoopView* loop_;
    LookControls* look_;
    OverlayControls* overlay_;
    LayersControls* layers_;
    QTabWidget* tabs_;
};

}  // namespace palpate::viewer

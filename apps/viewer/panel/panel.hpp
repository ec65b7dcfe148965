// The panel: all settings and readings of a live run, in sections that fold; those that are needed
// all the time above, the others on pages. It shows what is in effect, and asks there for changes.
#pragma once

#include <QWidget>

#include <vector>

#include "apps/viewer/panel/effect.hpp"

class QTabWidget;

namespace palpate::viewer {

class BrushControls;
class DeviceControls;
class ForceControls;
class HandSwitch;
class IsovalueControls;
class LayersControls;
class LookControls;
class LoopView;
class OverlayControls;
class PenetrabilityControls;
class Section;
class SessionBar;
class ToolControls;

/// GUI thread only.
class Panel : public QWidget {
    Q_OBJECT

  public:
    /// With each session the brush is off, its values are automatic, there are no edits and no edit
    /// reason; set anything else after that. Of a recording only the look can be set, without a
    /// session nothing.
    explicit Panel(Effect& effect, QWidget* parent = nullptr);
    ~Panel() override;

    IsovalueControls& isovalue_controls() { return *isovalue_; }
    LookControls& look_controls() { return *look_; }
    OverlayControls& overlay_controls() { return *overlay_; }
    LayersControls& layers_controls() { return *layers_; }
    BrushControls& brush_controls() { return *edit_; }
    DeviceControls& device_controls() { return *device_; }
    HandSwitch& hand_switch() { return *hands_; }
    ToolControls& tool_controls() { return *tool_; }
    LoopView& loop_view() { return *loop_; }

  private:
    void build();
    void raise_page(const Section& section);
    Section& section_of(const Command& command) const;
    void connect_effect();
    void connect_sections();
    void connect_edits();
    void connect_look();
    void connect_layers();
    void begin();
    void clear();
    void clear_edits();
    void show_fitting();
    void show_marks();

    Effect& effect_;
    HandSwitch* hands_;
    IsovalueControls* isovalue_;
    LayersControls* layers_;
    PenetrabilityControls* penetrability_;
    ToolControls* tool_;
    BrushControls* edit_;
    ForceControls* force_;
    DeviceControls* device_;
    LoopView* loop_;
    LookControls* look_;
    OverlayControls* overlay_;
    SessionBar* bar_;
    QTabWidget* tabs_;
    Section *session_part_, *isovalue_part_, *layers_part_, *penetrability_part_, *tool_part_,
        *edit_part_, *force_part_, *device_part_, *loop_part_, *look_part_, *overlay_part_;
    std::vector<Section*> sections_;  // all of them, from top to bottom
};

}  // namespace palpate::viewer

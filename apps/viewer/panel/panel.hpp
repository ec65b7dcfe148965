// The panel: all settings and readings of a live run, in sections that fold; those that are needed
// all the time above, the others on pages. It does not hold the
// run: signals say what the user asks for, setters show what is in effect and emit nothing.
#pragma once

#include <QWidget>

#include <optional>
#include <vector>

#include "apps/viewer/panel/brush_choice.hpp"
#include "palpate/devices/backend.hpp"
#include "palpate/run/statistics.hpp"
#include "palpate/servo.hpp"

class QTabWidget;

namespace palpate::viewer {

class BrushControls;
class DeviceControls;
class ForceControls;
class IsovalueControls;
class LayersControls;
class LookControls;
class LoopView;
class OverlayControls;
class PenetrabilityControls;
class Section;
class SessionBar;
class ToolControls;
struct PressThrough;

/// GUI thread only.
class Panel : public QWidget {
    Q_OBJECT

  public:
    explicit Panel(QWidget* parent = nullptr);
    ~Panel() override;

    /// Shows the values of a session. The brush is off, its values are automatic, there are no
    /// edits and no edit reason; set anything else after this.
    void set_session(const Field& field, const run::Histogram& histogram, double isovalue,
                     const RendererSettings& settings, const DeviceInfo& device);
    /// No volume: nothing can be set.
    void clear();
    /// True: a recording is played; only the look can be set. Until
    /// the next set_session().
    void set_observing(bool observing);
    void set_brush(const BrushChoice& brush);
    /// The radius is one that fits the grid.
    const BrushChoice& brush() const;

    /// About thirty times a second.
    void show_snapshot(const Snapshot& snapshot);
    /// The same for what moves fast: the force along a stroke. About sixty times a second.
    void show_stroke(const Snapshot& snapshot);
    /// About twice a second; `rate` [Hz] as measured.
    void show_report(const ServoReport& report, double rate);
    /// `problem`: what is wrong with the device and what to do, or empty.
    void show_device(const DeviceInfo& info, DeviceStatus status, const QString& problem);
    /// Asks for another isovalue or scale as the controls of that section do, for keys and menus.
    void request(const Command& command);
    /// The last request was refused: shows why in its section, and the state before it. May be
    /// called while `asked` or another signal is emitted, or later.
    void show_refused(const QString& why);

    /// The settings that were set, with all requests since that were not refused.
    const RendererSettings& settings() const { return now_.settings; }
    double isovalue() const { return now_.isovalue; }

    /// Sections that controllers connect to directly.
    IsovalueControls& isovalue_controls() { return *isovalue_; }
    LookControls& look_controls() { return *look_; }
    OverlayControls& overlay_controls() { return *overlay_; }
    LayersControls& layers_controls() { return *layers_; }
    BrushControls& brush_controls() { return *edit_; }
    DeviceControls& device_controls() { return *device_; }
    ToolControls& tool_controls() { return *tool_; }

  Q_SIGNALS:
    /// A command that has passed palpate::check for the session that is shown.
    void asked(const palpate::Command& command);
    void device_chosen(const QString& option);
    void field_chosen(palpate::Solid solid, palpate::Interpolation interpolation);
    /// After show_refused() the previous choice holds again.
    void brush_changed(const palpate::viewer::BrushChoice& brush);
    void undo_asked();
    void redo_asked();
    void save_asked();

  private:
    struct Effect {
        RendererSettings settings;
        double isovalue = 0;
        bool frozen = false, clutched = false;
        BrushChoice brush;
    };

    void build();
    void raise_page(const Section& section);
    void connect_sections();
    void connect_edits();
    void connect_look();
    void connect_layers();
    void ask_layers(const std::shared_ptr<const Layers>& layers);
    void show_marks();
    void clear_edits();
    void begin_request(Section* by);
    void take(const Command& command);
    void ask(Section* by, const Command& command);
    void ask_penetrability(const PressThrough& next);
    void refuse(Section* by, const QString& why);
    void show_effect();
    void show_fitting();

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

    bool live_ = false;  // there is a session
    Solid solid_ = Solid::above;
    Interpolation interpolation_ = Interpolation::linear;
    Effect now_, before_;  // in effect; before the last request
    Section* asked_by_ = nullptr;
    bool refused_ = false;
    std::optional<Field> unedited_;  // from which automatic values are computed
};

}  // namespace palpate::viewer

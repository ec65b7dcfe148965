// Shows the live run or the playback in the scene, the slices and the look section of the panel.
#pragma once

#include <optional>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/window/desk.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

class MeasureController;
class OverlayController;

class DisplayController : public Controller {
  public:
    DisplayController(const Desk& desk, MeasureController& measuring, OverlayController& overlays);

    /// Shows the newest snapshots, and the data of the chosen hand's where they have changed.
    /// Returns them.
    HandSnapshots observe();
    /// Freezes the snapshots shown, for a picture; the live run goes on.
    void hold();
    /// The level of the surface in the scene; nothing if no volume is open.
    std::optional<double> isovalue() const;
    void set_look(const Look& look);
    /// Through the crosshair, facing the viewer.
    void set_cut(Cut cut);
    /// The transfer function that the volume suggests.
    void use_usual_look();
    /// The whole volume as seen by the person who holds the device.
    void look_from_hand(const DeviceTransform& transform);

    /// Writes to `session` how the volume is shown; shows it as `session` says.
    void save_view(SessionFile& session) const;
    void restore_view(const SessionFile& session);

  private:
    void show_field(const Field& field, double isovalue);
    void show_volume(const Field& field, double isovalue, const DeviceTransform& transform);
    void observe_data(const Snapshot& now);
    void observe_state(const std::optional<Snapshot>& now);
    void show_look();
    void clear();

    MeasureController& measuring_;
    OverlayController& overlays_;
    std::optional<HandSnapshots> held_;
};

}  // namespace palpate::viewer

// Shows the live run or the playback in the scene and the slices.
#pragma once

#include <optional>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/session_file.hpp"
#include "apps/viewer/window/desk.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

class LookControls;
class MeasureController;
class OverlayControls;
class Panel;

class DisplayController : public Controller {
  public:
    DisplayController(const Desk& desk, Panel& panel, MeasureController& measuring);

    /// Shows the newest snapshots, and the data of the chosen hand's where they have changed.
    /// Returns them.
    HandSnapshots observe();
    /// Freezes the snapshots shown, for a picture; the live run goes on.
    void hold();
    /// The whole volume as seen by the person who holds the device.
    void look_from_hand();

    /// Writes to `session` how the volume is shown; shows it as `session` says.
    void save_view(SessionFile& session) const;
    void restore_view(const SessionFile& session);

  private:
    void show_field(const Field& field, double isovalue);
    void show_volume(const Field& field, double isovalue, const DeviceTransform& transform);
    void look_from(const DeviceTransform& transform);
    void observe_state(const std::optional<Snapshot>& now);
    void clear();

    LookControls& look_;
    OverlayControls& overlays_;
    MeasureController& measuring_;
    std::optional<HandSnapshots> held_;
};

}  // namespace palpate::viewer

// The views of a volume: the scene, three slices beside it, and the crosshair that they share.
#pragma once

#include <QWidget>
#include <array>
#include <optional>

#include "apps/viewer/model/look.hpp"
#include "palpate/servo.hpp"

class QSplitter;

namespace palpate::viewer {

class Scene;
class SlicePane;

class Views : public QWidget {
    Q_OBJECT

  public:
    explicit Views(QWidget* parent = nullptr);

    void set_field(const Field& field, double isovalue);
    /// Another version of the data that are shown: edited, or at another moment.
    void update_field(const Field& field);
    void clear();
    void set_isovalue(double isovalue);
    void set_look(const Look& look);
    /// Up to 60 times a second. Nothing: no hand is shown.
    void show_snapshot(const std::optional<Snapshot>& snapshot);
    /// True: the left button moves the probe, where the device is the mouse.
    void set_hand(bool probe);
    void set_crosshair(const Vec3& physical);
    const Vec3& crosshair() const { return crosshair_; }
    /// The crosshair follows the probe.
    void set_follow(bool follow);
    bool follows() const { return follow_; }
    /// The grey levels of the slices [data units].
    void set_window(double low, double high);
    double window_low() const { return window_low_; }
    double window_high() const { return window_high_; }
    void show_slices(bool shown);
    bool slices_shown() const;

    Scene& scene() { return *scene_; }
    SlicePane& slice(int axis) { return *slices_.at(static_cast<std::size_t>(axis)); }

  Q_SIGNALS:
    /// The user asks the probe to move by, or to go to [mm, physical].
    void probe_dragged(const palpate::Vec3& by);
    void probe_aimed(const palpate::Vec3& to);
    void follow_changed(bool follow);

  private:
    void choose_crosshair(const Vec3& physical);

    Scene* scene_;
    std::array<SlicePane*, 3> slices_;
    QSplitter *across_, *down_;
    Vec3 crosshair_ = Vec3::Zero();
    bool follow_ = true;
    double window_low_ = 0, window_high_ = 1;
};

}  // namespace palpate::viewer

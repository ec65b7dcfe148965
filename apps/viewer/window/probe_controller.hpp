// Mouse and keys as the hand: they move the probe where the device of the live run is the mouse.
#pragma once

#include <QObject>

#include "palpate/volume.hpp"

namespace palpate::viewer {

class Content;
class Messages;
class RunController;
class Views;

class ProbeController : public QObject {
  public:
    ProbeController(Content& content, RunController& run, Views& views, Messages& messages);

    /// Whether the mouse is the device.
    bool possible() const;
    /// Whether the left button moves the probe, not the view.
    bool pointing() const { return pointing_; }
    void set_pointing(bool probe);
    /// Moves what the mouse aims at [mm, physical].
    void move_by(const Vec3& by);
    void move_to(const Vec3& to);
    /// `screen`: to the right, up, towards the viewer [voxels].
    void nudge(const Vec3& screen);

  private:
    void add_keys();

    Content& content_;
    Views& views_;
    Messages& messages_;
    bool pointing_ = false;
};

}  // namespace palpate::viewer

// Controls of how contact feels: spring, damping, friction, texture, magnet, limit.
#pragma once

#include <QWidget>

#include <vector>

#include "apps/viewer/panel/quantity.hpp"
#include "palpate/session.hpp"

namespace palpate::viewer {

class ForceControls : public QWidget {
    Q_OBJECT

  public:
    ForceControls();

    /// Shows settings; the ends of the sliders are what these limits can render. Emits nothing.
    void set_settings(const ForceSettings& force, const Friction& friction,
                      const DeviceLimits& limits);
    void drop();

    struct Settings {
        ForceSettings force;
        Friction friction;
    };

  Q_SIGNALS:
    /// The ForceSettings or Friction that are shown with a number changed, valid or not.
    void asked(const palpate::Command& command);

  private:
    void change(std::size_t number, double value);
    void set_ends(const DeviceLimits& limits);

    Settings shown_;
    std::vector<Quantity*> rows_;
};

}  // namespace palpate::viewer

// Controls of how contact feels: spring, damping, friction, texture, magnet, limits.
#pragma once

#include <QWidget>

#include <map>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/quantity.hpp"

namespace palpate::viewer {

/// A row for each number in the tables of force and friction. The sliders end at what the device
/// can render.
class ForceControls : public QWidget {
    Q_OBJECT

  public:
    explicit ForceControls(Effect& effect);

  private:
    void change(const QString& name, double value);
    void show();
    void set_ends(const RendererSettings& settings);

    Effect& effect_;
    std::map<QString, Quantity*> rows_;  // by their names
};

}  // namespace palpate::viewer

// Controls of how contact feels: spring, damping, friction, texture, magnet, limit.
#pragma once

#include <QWidget>

#include <vector>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/quantity.hpp"

namespace palpate::viewer {

/// The sliders end at what the device can render.
class ForceControls : public QWidget {
    Q_OBJECT

  public:
    explicit ForceControls(Effect& effect);

  private:
    void change(std::size_t number, double value);
    void show();
    void set_ends(const RendererSettings& settings);

    Effect& effect_;
    std::vector<Quantity*> rows_;
};

}  // namespace palpate::viewer

// The look: what the scene shows, its colours and surfaces, the transfer function.
#pragma once

#include <functional>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/window/desk.hpp"

namespace palpate::viewer {

/// Object names: show_..., and of the surfaces beside the felt one, from N = 1, surface_N (shown or
/// not), surface_N_colour, _level, _opacity, _feel, _remove; add_surface.
class LookControls : public EffectForm, protected Desk {
    Q_OBJECT

  public:
    explicit LookControls(const Desk& desk);

    void change(const std::function<void(Look&)>& how);
    void set_look(const Look& look);
    const Look& look() const { return look_; }
    /// Through the crosshair, facing the viewer.
    void set_cut(Cut cut);
    /// The transfer function that the volume suggests.
    void use_usual_look();

  Q_SIGNALS:
    void look_changed(const palpate::viewer::Look& look);

  private:
    QWidget* make_surface(std::size_t at);
    QWidget* make_volume();
    QWidget* make_rest();
    void begin() override;
    void clear() override { editor_->set_data({}, {}); }
    void add_surface();
    void feel(std::size_t at);
    void take_transfer(const Knots& knots, const std::vector<Colour>& colours);
    const ControlPoint* held_point() const;
    void change_point(const std::function<void(ControlPoint&)>& how);

    Look look_;
    const Parts<Look> its_{[this]() -> const Look& { return look_; },
                           [this](const std::function<void(Look&)>& how) { change(how); }};
    QComboBox* preset_ = nullptr;
    LevelChart* editor_;
};

}  // namespace palpate::viewer

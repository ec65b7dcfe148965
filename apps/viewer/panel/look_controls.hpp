// Controls of the look: what the scene shows, its colours and surfaces, the transfer function.
#pragma once

#include <functional>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/level_chart.hpp"

namespace palpate::viewer {

/// Object names: show_..., and of the surfaces beside the felt one, from N = 1, surface_N (shown or
/// not), surface_N_colour, _level, _opacity, _feel, _remove; add_surface.
class LookControls : public EffectForm {
    Q_OBJECT

  public:
    explicit LookControls(Effect& effect);

    /// As by hand.
    void change(const std::function<void(Look&)>& how);
    /// Shows a look; emits look_set() alone.
    void set_look(const Look& look);
    const Look& look() const { return look_; }

  Q_SIGNALS:
    void look_changed(const palpate::viewer::Look& look);
    void look_set();
    /// A cut of this kind, for the present view.
    void cut_wanted(palpate::viewer::Cut cut);

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

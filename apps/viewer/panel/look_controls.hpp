// Controls of the look: what the scene shows, its colours, the transfer function.
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QWidget>

#include <optional>
#include <vector>

#include "apps/viewer/panel/colour_button.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/quantity.hpp"
#include "apps/viewer/panel/surface_list.hpp"
#include "apps/viewer/panel/transfer_editor.hpp"

namespace palpate::viewer {

class LookControls : public QWidget {
    Q_OBJECT

  public:
    explicit LookControls(Effect& effect);

    /// As by hand.
    void set_overlay_look(const OverlayLook& overlay);
    void move_surface(int row, double level);
    /// Shows a look; emits look_set() alone.
    void set_look(const Look& look);
    const Look& look() const { return look_; }

  Q_SIGNALS:
    void look_changed(const palpate::viewer::Look& look);
    void look_set();
    /// A cut of this kind, for the present view.
    void cut_wanted(palpate::viewer::Cut cut);

  private:
    struct Switch {
        QCheckBox* box;
        bool Look::*shown;
    };

    void connect_effect();
    void begin();
    void feel(int row);
    QCheckBox* add_switch(const QString& name, const QString& text, const QString& tip,
                          bool Look::*shown);
    QWidget* make_surface();
    QWidget* make_volume();
    QWidget* make_cut();
    void connect_surfaces();
    void add_surface();
    QWidget* make_rest();
    void connect_transfer();
    void show_point(int point);
    void show_preset();
    void changed();

    Effect& effect_;
    Look look_;
    std::vector<Switch> switches_;
    ColourButton *surface_colour_, *point_colour_;
    Quantity* surface_opacity_;
    QComboBox* preset_;
    SurfaceList* surfaces_;
    QComboBox *cut_, *colours_;
    TransferEditor* editor_;
    NumberBox *point_level_, *point_opacity_;
    RateLimiter limiter_;
};

}  // namespace palpate::viewer

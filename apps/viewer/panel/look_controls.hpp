// Controls of the look: what the scene shows, its colours and surfaces, the transfer function.
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QPushButton>
#include <QWidget>

#include <optional>
#include <vector>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/level_chart.hpp"

namespace palpate::viewer {

// The surfaces that are seen beside the felt one: a row each.
using SeenSurfaces = std::vector<SeenSurface>;

/// Object names: surface_N (shown or not), surface_N_colour, _level, _opacity, _feel, _remove, from
/// N = 1; add_surface.
class SurfaceList : public QWidget {
    Q_OBJECT

  public:
    SurfaceList();

    /// Shows them; emits nothing.
    void set_surfaces(const SeenSurfaces& surfaces);
    /// [data units] Of the levels' boxes.
    void set_step(double step);
    /// Whether one of them can be felt in place of the isovalue; else `why` not.
    void set_feelable(bool feelable, const QString& why);

  Q_SIGNALS:
    void changed(const palpate::viewer::SeenSurfaces& surfaces);
    void add_wanted();
    /// This one is to be felt.
    void feel_wanted(int row);

  private:
    struct Row {
        QWidget* whole;
        QCheckBox* shown;
        ColourButton* colour;
        NumberBox *level, *opacity;
        QPushButton *feel, *remove;
    };
    Row make_row(int number);
    void connect_row(const Row& row, std::size_t at);
    void show_row(std::size_t at);

    SeenSurfaces surfaces_;
    std::vector<Row> rows_;  // all there can be; those that are not used are hidden
    QPushButton* add_;
};

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
    void change_point(const std::function<void(ControlPoint&)>& how);
    void take_transfer();
    void show_transfer();
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
    LevelChart* editor_;
    NumberBox *point_level_, *point_opacity_;
    RateLimiter limiter_;
};

}  // namespace palpate::viewer

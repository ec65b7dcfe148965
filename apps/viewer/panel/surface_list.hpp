// The surfaces that are seen beside the felt one: a row each.
#pragma once

#include <QCheckBox>
#include <QPushButton>
#include <QWidget>

#include <vector>

#include "apps/viewer/panel/colour_button.hpp"
#include "apps/viewer/panel/number_box.hpp"

namespace palpate::viewer {

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

}  // namespace palpate::viewer

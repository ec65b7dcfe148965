// Controls of the look: what the scene shows, its colours, the transfer function.
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QWidget>

#include <optional>
#include <vector>

#include "apps/viewer/panel/colour_button.hpp"
#include "apps/viewer/panel/quantity.hpp"
#include "apps/viewer/panel/transfer_editor.hpp"

namespace palpate::viewer {

class LookControls : public QWidget {
    Q_OBJECT

  public:
    LookControls();

    /// The data for which presets are made.
    void set_data(const Volume& volume, const run::Histogram& histogram);
    void clear();
    /// Shows a look; emits nothing.
    void set_look(const Look& look);
    const Look& look() const { return look_; }

  Q_SIGNALS:
    void look_changed(const palpate::viewer::Look& look);

  private:
    struct Switch {
        QCheckBox* box;
        bool Look::*shown;
    };

    QCheckBox* add_switch(const QString& name, const QString& text, const QString& tip,
                          bool Look::*shown);
    QWidget* make_surface();
    QWidget* make_volume();
    QWidget* make_rest();
    void connect_transfer();
    void show_point(int point);
    void show_preset();
    void changed();

    Look look_;
    std::optional<Volume> volume_;
    run::Histogram histogram_;
    std::vector<Switch> switches_;
    ColourButton *surface_colour_, *point_colour_;
    Quantity* surface_opacity_;
    QComboBox* preset_;
    TransferEditor* editor_;
    NumberBox *point_level_, *point_opacity_;
    RateLimiter limiter_;
};

}  // namespace palpate::viewer

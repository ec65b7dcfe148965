// Controls of the overlay: opening and closing it, how it is shown, its labels.
#pragma once

#include <QLabel>
#include <QListWidget>

#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/panel/look_controls.hpp"

namespace palpate::viewer {

/// They show and change the overlay's part of the look.
class OverlayControls : public EffectForm {
    Q_OBJECT

  public:
    OverlayControls(Effect& effect, LookControls& look);

    /// Null: there is none.
    void set_overlay(const Overlay* overlay);

  Q_SIGNALS:
    void open_wanted();
    void close_wanted();
    /// The labels that are shown are to be felt.
    void feel_wanted();
    /// To where this label lies.
    void label_wanted(int value);

  private:
    const OverlayLook& its_look() const { return look_.look().overlay; }
    void make_labels();

    LookControls& look_;
    double suggested_ = 0;  // level
    QLabel* name_;
    QPushButton *close_, *feel_;
    QWidget *body_, *image_;
    QListWidget* labels_;
};

}  // namespace palpate::viewer

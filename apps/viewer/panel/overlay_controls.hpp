// Controls of the overlay: opening and closing it, how it is shown, its labels.
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QWidget>

#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/panel/inputs.hpp"

namespace palpate::viewer {

class OverlayControls : public QWidget {
    Q_OBJECT

  public:
    OverlayControls();

    /// Null: there is none.
    void set_overlay(const Overlay* overlay);
    /// Shows a look; emits nothing.
    void set_look(const OverlayLook& look);
    /// Whether labels can be felt now: in a live run.
    void set_feelable(bool feelable) { feel_->setEnabled(feelable); }

  Q_SIGNALS:
    void open_wanted();
    void close_wanted();
    void look_changed(const palpate::viewer::OverlayLook& look);
    /// The labels that are shown are to be felt.
    void feel_wanted();
    /// To where this label lies.
    void label_wanted(int value);

  private:
    void connect_inputs();
    void fill_labels(const Overlay* overlay);
    void change(const std::function<void(OverlayLook&)>& how);

    OverlayLook look_;
    double suggested_ = 0;  // level
    QPushButton *open_, *close_;
    QLabel* name_;
    QWidget *body_, *image_;
    QCheckBox *shown_, *surface_;
    Quantity *opacity_, *surface_opacity_;
    QComboBox* colours_;
    NumberBox* level_;
    QListWidget* labels_;
    QPushButton* feel_;
};

}  // namespace palpate::viewer

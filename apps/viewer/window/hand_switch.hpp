// The switch that says which hand's settings the panel shows.
#pragma once

#include <QPushButton>
#include <QWidget>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/window/desk.hpp"

namespace palpate::viewer {

class BrushControls;

/// Hidden while there is one hand.
class HandSwitch : public QWidget, protected Desk {
    Q_OBJECT

  public:
    HandSwitch(const Desk& desk, BrushControls& brush);

    void choose(int hand);
    void choose_next();
    /// What is wrong with any hand's device; a few times a second.
    void show_hands();

  private:
    BrushControls& brush_;
    PerHand<QPushButton*> buttons_;
};

}  // namespace palpate::viewer

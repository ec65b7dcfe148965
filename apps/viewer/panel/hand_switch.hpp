// The switch that says which hand's settings the panel shows.
#pragma once

#include <QPushButton>
#include <QString>
#include <QWidget>

#include <vector>

#include "apps/viewer/model/hands.hpp"

namespace palpate::viewer {

/// Hidden while there is one hand.
class HandSwitch : public QWidget {
    Q_OBJECT

  public:
    HandSwitch();

    struct Hand {
        QString device;
        QString problem;  ///< what is wrong with it and what to do; empty: nothing
    };
    /// Those that there are, and the one whose settings are shown, from 1.
    void show_hands(const std::vector<Hand>& hands, int chosen);

  Q_SIGNALS:
    void wanted(int hand);

  private:
    PerHand<QPushButton*> buttons_;
};

}  // namespace palpate::viewer

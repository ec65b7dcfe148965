// The top of the panel: switches for the hand, forces, freeze and clutch, the force gauge, and the
// contact.
#pragma once

#include <QLabel>
#include <QProgressBar>
#include <QString>

#include <functional>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"

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

/// A gauge of the force against its limit: a bar, a number, and a text while the force is reduced.
class ForceGauge : public QWidget {
    Q_OBJECT

  public:
    ForceGauge();

    /// [N]; `words`, as app::force_words() has them, stand beside the number.
    void set_force(double force, double limit, const QString& words);
    double force() const { return force_; }
    double limit() const { return limit_; }
    const QString& words() const { return words_; }
    /// How much of the bar is filled, 0 to 1.
    double filled() const;

  private:
    double force_ = 0, limit_ = 0;
    QString words_;
    QLabel *number_, *why_, *most_;
    QProgressBar* bar_;
};

/// Switches show the session's state, whatever was clicked.
class SessionBar : public Form {
    Q_OBJECT

  public:
    explicit SessionBar(Effect& effect);

  protected:
    void changeEvent(QEvent* event) override;

  private:
    QPushButton* make_switch(const char* name, const QString& tip, std::function<bool()> state,
                             std::function<Command(bool)> command,
                             std::function<QString(bool)> text);
    void clear();
    void show_snapshot(const Snapshot& now);
    double limit() const;
    void colour_forces();

    Effect& effect_;
    QString waits_;  // why forces that are on are not there; empty: nothing holds them back
    QPushButton* forces_ = nullptr;
    ForceGauge* gauge_;
    QLabel* contact_;
};

}  // namespace palpate::viewer

// The top of the panel: switches for the hand, forces, freeze and clutch, the force gauge, and the
// contact.
#pragma once

#include <QLabel>
#include <QPushButton>
#include <QString>
#include <QWidget>

#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/panel/effect.hpp"

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
    void clear();
    double force() const { return force_; }
    double limit() const { return limit_; }
    const QString& words() const { return words_; }
    /// How much of the bar is filled, 0 to 1.
    double filled() const;

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    double force_ = 0, limit_ = 0;
    QString words_;
};

/// A switch of the session, with words for both states.
class SessionSwitch : public QPushButton {
    Q_OBJECT

  public:
    SessionSwitch(const QString& on, const QString& off);
    /// The state now, whatever was clicked.
    void set_state(bool on);
    bool set_on_text(const QString& text);

  private:
    QString on_, off_;
};

class SessionBar : public QWidget {
    Q_OBJECT

  public:
    explicit SessionBar(Effect& effect);

  protected:
    void changeEvent(QEvent* event) override;

  private:
    void connect_effect();
    void begin();
    void clear();
    void show_switches();
    void show_snapshot(const Snapshot& now);
    double limit() const;
    void colour_forces();
    void show_waiting(const QString& why);

    Effect& effect_;
    SessionSwitch *forces_, *freeze_, *clutch_;
    ForceGauge* gauge_;
    QLabel* contact_;
};

}  // namespace palpate::viewer

// The top of the panel: switches for forces, freeze and clutch, the force gauge, and the contact.
#pragma once

#include <QLabel>
#include <QPushButton>
#include <QWidget>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/force_gauge.hpp"

namespace palpate::viewer {

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

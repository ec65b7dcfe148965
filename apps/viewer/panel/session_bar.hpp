// The top of the panel: switches for forces, freeze and clutch, the force gauge, and the contact.
#pragma once

#include <QLabel>
#include <QPushButton>
#include <QWidget>

#include "apps/viewer/panel/awaited_change.hpp"
#include "apps/viewer/panel/force_gauge.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

/// A switch of the session: shows the state of the session; a click asks for the opposite.
class SessionSwitch : public QPushButton {
    Q_OBJECT

  public:
    SessionSwitch(const QString& on, const QString& off);
    /// The state in a snapshot.
    void show_state(bool on);
    /// The state now, whatever was clicked.
    void set_state(bool on);
    bool set_on_text(const QString& text);

  Q_SIGNALS:
    void wanted(bool on);

  private:
    QString on_, off_;
    AwaitedChange awaited_;
};

class SessionBar : public QWidget {
    Q_OBJECT

  public:
    SessionBar();

    void set_session(const RendererSettings& settings);
    void show_snapshot(const Snapshot& now, double limit);
    void clear();
    void set_forces(bool on) { forces_->set_state(on); }
    void set_frozen(bool on) { freeze_->set_state(on); }
    void set_clutched(bool on) { clutch_->set_state(on); }

  Q_SIGNALS:
    void asked(const palpate::Command& command);

  protected:
    void changeEvent(QEvent* event) override;

  private:
    void colour_forces();
    void show_waiting(const QString& why);

    SessionSwitch *forces_, *freeze_, *clutch_;
    ForceGauge* gauge_;
    QLabel* contact_;
};

}  // namespace palpate::viewer

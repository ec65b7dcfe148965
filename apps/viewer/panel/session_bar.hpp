// The top of the panel: switches for forces, freeze and clutch, the force gauge, and the contact.
#pragma once

#include <QLabel>
#include <QPushButton>
#include <QWidget>

#include "apps/viewer/panel/force_gauge.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

/// A switch of the session: shows what the session tells; a click asks for the opposite.
class SessionSwitch : public QPushButton {
    Q_OBJECT

  public:
    SessionSwitch(const QString& name, const QString& on, const QString& off);
    /// What a snapshot says; one that was taken before the last click was obeyed is passed over.
    void show_state(bool on);
    /// What is so, whatever was clicked.
    void set_state(bool on);

  Q_SIGNALS:
    void wanted(bool on);

  private:
    QString on_, off_;
    int grace_ = 0;  // snapshots that may still disagree with the click
};

class SessionBar : public QWidget {
    Q_OBJECT

  public:
    explicit SessionBar(QWidget* parent = nullptr);

    void set_session(const RendererSettings& settings);
    void show_snapshot(const Snapshot& now, double limit);
    void clear();
    void toggle_forces() { forces_->click(); }
    void set_forces(bool on) { forces_->set_state(on); }
    void set_frozen(bool on) { freeze_->set_state(on); }
    void set_clutched(bool on) { clutch_->set_state(on); }

  Q_SIGNALS:
    void forces_wanted(bool on);
    void freeze_wanted(bool on);
    void clutch_wanted(bool on);

  protected:
    void changeEvent(QEvent* event) override;

  private:
    void colour_forces();

    SessionSwitch *forces_, *freeze_, *clutch_;
    ForceGauge* gauge_;
    QLabel* contact_;
};

}  // namespace palpate::viewer

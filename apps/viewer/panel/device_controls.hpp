// The page of the device: which one, its state and problems, the scale of the hand, and how the
// servo loop performs.
#pragma once

#include <QLabel>
#include <QLineEdit>

#include <vector>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "palpate/devices/backend.hpp"
#include "palpate/run/setup.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

/// Shows how the servo loop performs: rate, lateness, compute time, missed deadlines, worst tick.
class LoopView : public QWidget {
    Q_OBJECT

  public:
    LoopView();
    /// `rate` [Hz] as measured.
    void show_report(const ServoReport& report, double rate);
    void clear();

  private:
    void put(const QString& name, const QString& text);
};

class DeviceControls : public EffectForm {
    Q_OBJECT

  public:
    explicit DeviceControls(Effect& effect);

    /// The devices that were searched. `current` is the option of the device in use
    /// ("haply:port=10001").
    void set_devices(const std::vector<devices::DeviceFinding>& findings, const QString& current);
    void show_device(const DeviceInfo& info, DeviceStatus status, const QString& problem);
    /// The purposes of the device's buttons.
    void set_buttons(const run::Buttons& buttons);
    /// How many hands there are: one can be added, or one of them removed.
    void set_hands(int hands);

  Q_SIGNALS:
    void chosen(const QString& option);
    /// For one hand more.
    void added(const QString& option);
    /// The hand whose device this is.
    void removed();
    void refresh_wanted();
    void buttons_wanted(const palpate::run::Buttons& buttons);

  private:
    void make_controls();
    QComboBox* make_button(const Words& words, run::ButtonSetup run::Buttons::*purpose);
    void show_status(DeviceStatus status);
    void begin() override;
    void clear() override;
    void choose(int row);
    void ask_for_device(void (DeviceControls::*signal)(const QString&));

    QComboBox* picker_;
    QLineEdit* options_;
    QPushButton *add_ = nullptr, *remove_ = nullptr;
    QComboBox *clutch_ = nullptr, *deadman_ = nullptr;
    Note* missing_;
    QLabel *dot_, *state_, *model_, *workspace_;
    Note* problem_;
    DeviceStatus status_ = DeviceStatus::starting;
    run::Buttons purposes_;
    std::vector<devices::DeviceFinding> findings_;  // by row
};

}  // namespace palpate::viewer

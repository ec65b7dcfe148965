// The page of the device: finds devices and changes to another one, adds and removes hands, shows
// the state and problems, sets buttons and scale, and shows how the servo loop performs. Also the
// switch that says which hand's settings the panel shows.
#pragma once

#include <QElapsedTimer>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QWidget>

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/window/connector.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/devices/backend.hpp"
#include "palpate/run/setup.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

/// Shows how the servo loop performs: rate, lateness, compute time, missed deadlines, worst tick.
class LoopView : public QWidget, protected Desk {
    Q_OBJECT

  public:
    explicit LoopView(const Desk& desk);
    /// How the loop has done since the last time; twice a second.
    void observe();
    /// `rate` [Hz] as measured.
    void show_report(const ServoReport& report, double rate);

  private:
    void put(const QString& name, const QString& text);
    void clear();

    QElapsedTimer since_;
    std::int64_t ticks_ = 0;  // until then
};

class DeviceControls : public EffectForm, protected Desk {
    Q_OBJECT

  public:
    explicit DeviceControls(const Desk& desk);

    void find_devices();
    Connector& connector() { return connector_; }

    /// Shows the device where it has changed; a few times a second.
    void observe(const Snapshot& now);
    void show_device(const DeviceInfo& info, DeviceStatus status, const QString& problem);
    /// Lists the devices that were found, and the one in use.
    void list(const std::vector<devices::DeviceFinding>& findings);

  Q_SIGNALS:
    /// `words`: which, in a sentence.
    void devices_found(const QString& words);

  private:
    void make_controls();
    QComboBox* make_button(const Words& words, run::ButtonSetup run::Buttons::*purpose);
    void show_buttons();
    void show_status(DeviceStatus status);
    void begin() override;
    void clear() override;
    void choose(int row);
    void ask_for_device(void (Connector::*use)(const devices::DeviceChoice&));
    QString device_words() const;

    BackgroundTask search_;
    Connector connector_;
    QComboBox* picker_;
    QLineEdit* options_;
    QComboBox *clutch_ = nullptr, *deadman_ = nullptr;
    Note* missing_;
    QLabel *dot_, *state_, *model_, *workspace_;
    Note* problem_;
    DeviceStatus status_ = DeviceStatus::starting;
    std::optional<DeviceStatus> told_;              // with the problem, by observe()
    std::vector<devices::DeviceFinding> findings_;  // by row
};

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

// Controls of how contact feels: spring, damping, friction, texture, magnet, limit.
#pragma once

#include <QWidget>

#include "apps/viewer/panel/quantity.hpp"
#include "palpate/force.hpp"
#include "palpate/proxy.hpp"

class QFormLayout;

namespace palpate::viewer {

class ForceControls : public QWidget {
    Q_OBJECT

  public:
    explicit ForceControls(QWidget* parent = nullptr);

    /// Shows settings; the ends of the sliders are what these limits can render. Emits nothing.
    void set_settings(const ForceSettings& force, const Friction& friction,
                      const DeviceLimits& limits);
    void drop();

  Q_SIGNALS:
    /// The settings shown with one of them changed, valid or not.
    void force_wanted(const palpate::ForceSettings& force);
    void friction_wanted(const palpate::Friction& friction);

  private:
    Quantity* row(QFormLayout& form, const QString& label, const QString& name, const QString& unit,
                  double high, double step, const QString& tip);
    void connect_force();
    void set_ends();

    ForceSettings force_;
    Friction friction_;
    DeviceLimits limits_;
    Quantity *stiffness_, *damping_, *viscosity_, *static_friction_, *dynamic_friction_,
        *amplitude_, *wavelength_, *distance_, *peak_, *limit_;
};

}  // namespace palpate::viewer

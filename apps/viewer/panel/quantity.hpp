// A number with a slider and a number box.
#pragma once

#include <QSlider>
#include <QWidget>

#include "apps/viewer/panel/number_box.hpp"
#include "apps/viewer/panel/rate_limiter.hpp"

namespace palpate::viewer {

/// The slider runs from `low` to `high`; the box takes any number; one that cannot be
/// used is refused with the reason. Object names: NAME, NAME_slider, NAME_box.
class Quantity : public QWidget {
    Q_OBJECT

  public:
    /// A step of the slider is a constant amount (linear), or a constant factor for positive values
    /// that range from small to large.
    enum class Scale { amounts, factors };

    /// `unit` stands behind the number; the box steps by `step`, or by a few percent where the
    /// slider goes by factors.
    Quantity(const QString& name, const QString& unit, double low, double high, double step,
             Scale scale = Scale::amounts);

    /// Shows a value; emits nothing.
    void set_value(double value);
    double value() const { return value_; }
    /// The ends of the slider; the value stays.
    void set_ends(double low, double high);
    double low() const { return low_; }
    double high() const { return high_; }
    /// Forgets a request that waits.
    void drop() { limiter_.drop(); }
    NumberBox& box() { return *box_; }
    void set_accessible_name(const QString& name);

  Q_SIGNALS:
    /// At most 60 a second while the slider moves. From the box any number may come.
    void wanted(double value);

  private:
    void ask(double value);
    double value_at(int place) const;
    void place_slider();

    double value_ = 0, low_, high_;
    Scale scale_;
    QSlider* slider_;
    NumberBox* box_;
    RateLimiter limiter_;
};

}  // namespace palpate::viewer

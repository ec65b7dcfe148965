// A number with a slider and a box: two ways to say the same.
#pragma once

#include <QSlider>
#include <QWidget>

#include "apps/viewer/panel/number_box.hpp"
#include "apps/viewer/panel/pacer.hpp"

namespace palpate::viewer {

/// The slider runs from `low` to `high`; the box takes any number, and who asks for one that cannot
/// be had is told why. Object names: NAME, NAME_slider, NAME_box.
class Quantity : public QWidget {
    Q_OBJECT

  public:
    /// `unit` stands behind the number.
    Quantity(const QString& name, const QString& unit, double low, double high, double step,
             QWidget* parent = nullptr);

    /// Shows a value; emits nothing.
    void set_value(double value);
    double value() const { return value_; }
    /// The ends of the slider; the value stays.
    void set_ends(double low, double high);
    /// Forgets a wish that waits.
    void drop() { pacer_.drop(); }
    NumberBox& box() { return *box_; }
    void set_accessible_name(const QString& name);

  Q_SIGNALS:
    void wanted(double value);  ///< at most 60 a second while the slider moves

  private:
    void ask(double value);
    double value_at(int place) const;
    void place_slider();

    double value_ = 0, low_, high_;
    QSlider* slider_;
    NumberBox* box_;
    Pacer pacer_;
};

}  // namespace palpate::viewer

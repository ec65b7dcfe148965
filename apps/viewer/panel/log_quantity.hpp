// A number above 0 with a slider that goes by factors, and a box: what runs from small to large.
#pragma once

#include <QSlider>
#include <QWidget>

#include "apps/viewer/panel/number_box.hpp"
#include "apps/viewer/panel/pacer.hpp"

namespace palpate::viewer {

/// Like Quantity, but the same way on the slider is the same factor everywhere, and the box steps
/// by a few percent. Object names: NAME, NAME_slider, NAME_box.
class LogQuantity : public QWidget {
    Q_OBJECT

  public:
    /// The slider runs from `low` to `high`, both above 0; `unit` stands behind the number.
    LogQuantity(const QString& name, const QString& unit, double low, double high,
                QWidget* parent = nullptr);

    /// Shows a value, between the ends or not; emits nothing.
    void set_value(double value);
    double value() const { return value_; }
    /// The ends of the slider; the value stays.
    void set_ends(double low, double high);
    double low() const { return low_; }
    double high() const { return high_; }
    /// Forgets a wish that waits.
    void drop() { pacer_.drop(); }
    NumberBox& box() { return *box_; }
    void set_accessible_name(const QString& name);

  Q_SIGNALS:
    /// At most 60 a second while the slider moves. From the box any number may come.
    void wanted(double value);

  private:
    void ask(double value);
    double value_at(int place) const;
    void place_slider();

    double value_, low_, high_;
    QSlider* slider_;
    NumberBox* box_;
    Pacer pacer_;
};

}  // namespace palpate::viewer

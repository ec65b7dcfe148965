// Number boxes and sliders, and texts of numbers.
#pragma once

#include <QDoubleSpinBox>
#include <QObject>
#include <QSlider>
#include <QWidget>

#include <functional>
#include <optional>

namespace palpate::viewer {

/// A number with as few digits as it needs, at most `digits` and those before the point, without an
/// exponent from 1e-4 to 1e9; "inf" and "-inf" are numbers.
QString number_text(double value, int digits = 6);
/// A whole number in groups of three, with narrow spaces: every language reads it alike.
QString count_text(double whole);
/// The number that a person typed, with a decimal point or a decimal comma and without groups of
/// digits. Nothing for a text that is no number.
std::optional<double> number_from(QString text);

/// Shows up to seven significant digits, or as many as set_digits() says, but keeps the whole
/// value. A typed value counts at Enter or when the focus leaves. The wheel scrolls the panel
/// unless the box has the focus, so that scrolling never changes a force. "inf" and "-inf" are
/// numbers where `set_infinite(true)`. A comma is a decimal point, in every language. A text with
/// several of them, or with one that may stand before thousands (1,000), is no number, and Enter
/// restores the old one.
class NumberBox : public QDoubleSpinBox {
    Q_OBJECT

  public:
    NumberBox();

    /// Shows a value; emits nothing.
    void show_value(double value);
    void set_infinite(bool allowed) { infinite_ = allowed; }
    void set_digits(int most) { digits_ = most; }

    QString textFromValue(double value) const override;
    double valueFromText(const QString& text) const override;
    QValidator::State validate(QString& text, int& position) const override;
    void fixup(QString& text) const override;

  private:
    QString bare(const QString& text) const;

    bool infinite_ = false;
    int digits_ = 7;
};

/// Puts a filter on a widget that leaves the wheel to the scroll area unless it has the focus.
void let_wheel_pass(QWidget& widget);

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
    /// The box shows so many of this unit for 1.
    void set_unit(const QString& unit, double per_1);
    double per_1() const { return per_1_; }
    /// The ends of the slider; the value stays.
    void set_ends(double low, double high);
    double low() const { return low_; }
    double high() const { return high_; }
    /// As by the slider: shows a value, and asks for it.
    void ask(double value);
    NumberBox& box() { return *box_; }
    void set_accessible_name(const QString& name);

  Q_SIGNALS:
    /// From the box any number may come.
    void wanted(double value);

  private:
    double value_at(int place) const;
    void place_slider();

    double value_ = 0, low_, high_, per_1_ = 1;
    Scale scale_;
    QSlider* slider_;
    NumberBox* box_;
};

}  // namespace palpate::viewer

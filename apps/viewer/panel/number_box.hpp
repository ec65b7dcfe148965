// A number box that shows as many digits as the number has and ignores the wheel without focus.
#pragma once

#include <QDoubleSpinBox>

#include <optional>

namespace palpate::viewer {

/// A number with as few digits as it needs, at most `digits`; "inf" and "-inf" are numbers.
QString number_text(double value, int digits = 6);
/// A whole number in groups of three, with narrow spaces: every language reads it alike.
QString count_text(double whole);
/// Nothing for a text that is no number.
std::optional<double> number_from(const QString& text);

/// Shows up to seven significant digits but keeps the whole value. A typed value counts at Enter or
/// when the focus leaves. The wheel scrolls the panel unless the box has the focus, so that
/// scrolling never changes a force. "inf" and "-inf" are numbers where `set_infinite(true)`.
class NumberBox : public QDoubleSpinBox {
    Q_OBJECT

  public:
    NumberBox();

    /// Shows a value; emits nothing.
    void show_value(double value);
    void set_infinite(bool allowed) { infinite_ = allowed; }

    QString textFromValue(double value) const override;
    double valueFromText(const QString& text) const override;
    QValidator::State validate(QString& text, int& position) const override;
    void fixup(QString& text) const override;

  private:
    QString bare(const QString& text) const;

    bool infinite_ = false;
};

/// Puts a filter on a widget that leaves the wheel to the scroll area unless it has the focus.
void let_wheel_pass(QWidget& widget);

}  // namespace palpate::viewer

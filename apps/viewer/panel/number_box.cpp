// Converts between text and value of a number box.
#include "apps/viewer/panel/number_box.hpp"

#include <QEvent>
#include <QSignalBlocker>

#include <cmath>
#include <limits>

namespace palpate::viewer {
namespace {

class WheelFilter : public QObject {
  public:
    using QObject::QObject;
    bool eventFilter(QObject* watched, QEvent* event) override {
        if (event->type() != QEvent::Wheel) return false;
        const auto* widget = qobject_cast<QWidget*>(watched);
        if (!widget || widget->hasFocus()) return false;
        event->ignore();  // goes on to the parent
        return true;
    }
};

}  // namespace

void let_wheel_pass(QWidget& widget) {
    widget.setFocusPolicy(Qt::StrongFocus);
    widget.installEventFilter(new WheelFilter(&widget));
}

QString number_text(double value, int digits) {
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    return QString::number(value == 0 ? 0.0 : value, 'g', digits);
}

QString count_text(double whole) {
    QString text = QString::number(whole, 'f', 0);
    for (int at = text.size() - 3; at > 0; at -= 3) text.insert(at, QChar(0x202F));
    return text;
}

std::optional<double> number_from(const QString& text) {
    if (text == "inf" || text == "+inf") return std::numeric_limits<double>::infinity();
    if (text == "-inf") return -std::numeric_limits<double>::infinity();
    bool valid = false;
    const double number = QLocale::c().toDouble(text, &valid);
    return valid && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

NumberBox::NumberBox() {
    const double most = std::numeric_limits<double>::infinity();
    setRange(-most, most);
    setDecimals(323);  // the most there are: none is rounded away
    setKeyboardTracking(false);
    let_wheel_pass(*this);
    setCorrectionMode(QAbstractSpinBox::CorrectToPreviousValue);
    setLocale(QLocale::c());
}

void NumberBox::show_value(double value) {
    if (value == this->value() && cleanText() == textFromValue(value)) return;
    const QSignalBlocker quiet(this);
    setValue(value);
}

QString NumberBox::textFromValue(double value) const {
    return number_text(value, 7);
}

QString NumberBox::bare(const QString& text) const {
    QString number = text;
    if (!suffix().isEmpty() && number.endsWith(suffix())) number.chop(suffix().size());
    return number.trimmed();
}

double NumberBox::valueFromText(const QString& text) const {
    const QString number = bare(text);
    // The text may have fewer digits than the value, which focus alone must not change.
    if (number == textFromValue(value())) return value();
    return number_from(number).value_or(0);
}

QValidator::State NumberBox::validate(QString& text, int&) const {
    const QString number = bare(text);
    const std::optional<double> value = number_from(number);
    if (value && (infinite_ || std::isfinite(*value))) return QValidator::Acceptable;
    for (const QChar c : number) {
        const bool letter = c == 'e' || c == 'E' || (infinite_ && QString("inf").contains(c));
        if (!c.isDigit() && !letter && !QString("+-.").contains(c)) return QValidator::Invalid;
    }
    return QValidator::Intermediate;
}

void NumberBox::fixup(QString& text) const {
    text = textFromValue(value()) + suffix();  // an incomplete number restores the old one
}

}  // namespace palpate::viewer

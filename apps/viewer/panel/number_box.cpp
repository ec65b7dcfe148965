// Converts between text and value of a number box.
#include "apps/viewer/panel/number_box.hpp"

#include <QEvent>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QWheelEvent>

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

NumberBox::NumberBox(QWidget* parent) : QDoubleSpinBox(parent) {
    const double most = std::numeric_limits<double>::infinity();
    setRange(-most, most);
    setDecimals(323);  // the most there are: none is rounded away
    setKeyboardTracking(false);
    setFocusPolicy(Qt::StrongFocus);
    setCorrectionMode(QAbstractSpinBox::CorrectToPreviousValue);
    setLocale(QLocale::c());
}

void NumberBox::show_value(double value) {
    if (value == this->value() && cleanText() == textFromValue(value)) return;
    const QSignalBlocker quiet(this);
    setValue(value);
}

QString NumberBox::textFromValue(double value) const {
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    return QString::number(value == 0 ? 0.0 : value, 'g', 7);
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
    if (number == "inf" || number == "+inf") return std::numeric_limits<double>::infinity();
    if (number == "-inf") return -std::numeric_limits<double>::infinity();
    return QLocale::c().toDouble(number);
}

QValidator::State NumberBox::validate(QString& text, int&) const {
    const QString number = bare(text);
    bool valid = false;
    const double value = QLocale::c().toDouble(number, &valid);
    if (valid && std::isfinite(value)) return QValidator::Acceptable;
    if (infinite_ && (number == "inf" || number == "+inf" || number == "-inf")) {
        return QValidator::Acceptable;
    }
    for (const QChar c : number) {
        const bool letter = c == 'e' || c == 'E' || (infinite_ && QString("inf").contains(c));
        if (!c.isDigit() && !letter && !QString("+-.").contains(c)) return QValidator::Invalid;
    }
    return QValidator::Intermediate;
}

void NumberBox::fixup(QString& text) const {
    text = textFromValue(value()) + suffix();  // an incomplete number restores the old one
}

void NumberBox::wheelEvent(QWheelEvent* event) {
    if (hasFocus()) {
        QDoubleSpinBox::wheelEvent(event);
    } else {
        event->ignore();
    }
}

}  // namespace palpate::viewer

// Number boxes and sliders, and texts of numbers.
#include "apps/viewer/panel/inputs.hpp"

#include <QBoxLayout>
#include <QEvent>
#include <QRegularExpression>
#include <QSignalBlocker>
#include <QToolTip>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/viewer/panel/layout.hpp"

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
    const double size = std::abs(value);
    if (!(size >= 1e-4 && size < 1e9)) return QString::number(size == 0 ? 0 : value, 'g', digits);
    // 'g' would write 35030 with three digits as 3.5e+04.
    const int whole = static_cast<int>(std::floor(std::log10(size))) + 1;
    if (digits <= whole) return QString::number(value, 'f', 0);
    return QString::number(value, 'g', digits);
}

QString count_text(double whole) {
    QString text = QString::number(whole, 'f', 0);
    for (int at = text.size() - 3; at > 0; at -= 3) text.insert(at, QChar(0x202F));
    return text;
}

namespace {

/// Thousands in English, decimals in German.
bool is_ambiguous(const QString& text) {
    static const QRegularExpression one_comma("^[+-]?[1-9]\\d{0,2},\\d{3}$");
    return one_comma.match(text).hasMatch();
}

}  // namespace

std::optional<double> number_from(QString text) {
    if (is_ambiguous(text)) return std::nullopt;
    text.replace(',', '.');
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
    return number_text(value, digits_);
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
    const bool fits =
        value &&
        (std::isfinite(*value) ? decimals() > 0 || *value == std::floor(*value) : infinite_);
    if (fits) return QValidator::Acceptable;
    for (const QChar c : number) {
        const bool letter = c == 'e' || c == 'E' || (infinite_ && QString("inf").contains(c));
        if (!c.isDigit() && !letter && !QString("+-.,").contains(c)) return QValidator::Invalid;
    }
    return QValidator::Intermediate;
}

void NumberBox::fixup(QString& text) const {
    const QString typed = bare(text);
    if (is_ambiguous(typed)) {
        QString thousands = typed, decimals = typed;
        thousands.remove(',');
        decimals.replace(',', '.');
        QToolTip::showText(
            mapToGlobal(rect().bottomLeft()),
            tr("%1 can be read in two ways: type %2 or %3").arg(typed, thousands, decimals));
    }
    text = textFromValue(value()) + suffix();  // an incomplete number restores the old one
}

namespace {

constexpr int slider_places = 1000;  // of the slider

}  // namespace

Quantity::Quantity(const QString& name, const QString& unit, double low, double high, double step,
                   Scale scale)
    : low_(low),
      high_(high),
      scale_(scale),
      slider_(named(new QSlider(Qt::Horizontal), name + "_slider")),
      box_(named(new NumberBox, name + "_box")) {
    setObjectName(name);
    slider_->setRange(0, slider_places);
    slider_->setSingleStep(slider_places / 100);
    slider_->setPageStep(slider_places / 10);
    slider_->setMinimumWidth(2 * fontMetrics().height());
    let_wheel_pass(*slider_);
    box_->setSuffix(unit.isEmpty() ? QString() : " " + unit);
    if (scale == Scale::factors) {
        box_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    } else {
        box_->setSingleStep(step);
    }
    // All with units alike, so that they stand in a column; the longest unit is N s/mm.
    const QString longest = unit.isEmpty() ? "-000000.0" : "0.00000 N s/mm";
    box_->setMinimumWidth(fontMetrics().horizontalAdvance(longest) + 2 * fontMetrics().height());
    box_->setMaximumWidth(box_->minimumWidth());
    row_in(this, {slider_, box_})->setStretch(0, 1);
    setFocusProxy(box_);
    connect(slider_, &QSlider::valueChanged, this, [this](int place) { ask(value_at(place)); });
    connect(box_, qOverload<double>(&NumberBox::valueChanged), this,
            [this](double shown) { ask(shown / per_1_); });
    set_value(low);
}

void Quantity::set_accessible_name(const QString& name) {
    slider_->setAccessibleName(name);
    box_->setAccessibleName(name);
}

void Quantity::set_unit(const QString& unit, double per_1) {
    per_1_ = per_1;
    box_->setSuffix(" " + unit);
    set_value(value_);
}

void Quantity::set_value(double value) {
    value_ = value;
    box_->show_value(per_1_ * value);
    if (!slider_->isSliderDown()) place_slider();
}

void Quantity::set_ends(double low, double high) {
    low_ = low;
    high_ = std::max(low, high);
    if (!slider_->isSliderDown()) place_slider();
}

/// Short numbers between the ends (of factors three digits), the ends themselves exactly.
double Quantity::value_at(int place) const {
    if (place <= 0) return low_;
    if (place >= slider_places) return high_;
    const double part = static_cast<double>(place) / slider_places;
    const bool factors = scale_ == Scale::factors;
    const double value =
        factors ? low_ * std::pow(high_ / low_, part) : low_ + (high_ - low_) * part;
    const double digits = factors ? 2 - std::floor(std::log10(value))
                                  : std::ceil(std::log10(slider_places / (high_ - low_)));
    const double scale = std::pow(10.0, digits);
    const double rounded = std::round(value * scale) / scale;
    return std::isfinite(rounded) ? std::clamp(rounded, low_, high_) : value;
}

void Quantity::place_slider() {
    const QSignalBlocker quiet(slider_);
    const double bounded = std::clamp(value_, low_, high_);
    double part = 0;
    if (high_ > low_) {
        part = scale_ == Scale::factors ? std::log(bounded / low_) / std::log(high_ / low_)
                                        : (bounded - low_) / (high_ - low_);
    }
    slider_->setValue(static_cast<int>(std::lround(slider_places * part)));
}

void Quantity::ask(double value) {
    set_value(value);
    Q_EMIT wanted(value);
}

}  // namespace palpate::viewer

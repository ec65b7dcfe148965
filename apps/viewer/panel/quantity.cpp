// Keeps slider and number box in step.
#include "apps/viewer/panel/quantity.hpp"

#include <QBoxLayout>
#include <QSignalBlocker>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
namespace {

constexpr int slider_places = 1000;  // of the slider

}  // namespace

Quantity::Quantity(const QString& name, const QString& unit, double low, double high, double step,
                   Scale scale)
    : low_(low),
      high_(high),
      scale_(scale),
      slider_(named(new QSlider(Qt::Horizontal), name + "_slider")),
      box_(named(new NumberBox, name + "_box")),
      limiter_(this) {
    setObjectName(name);
    slider_->setRange(0, slider_places);
    slider_->setSingleStep(slider_places / 100);
    slider_->setPageStep(slider_places / 10);
    slider_->setMinimumWidth(3 * fontMetrics().height());
    let_wheel_pass(*slider_);
    box_->setSuffix(unit.isEmpty() ? QString() : " " + unit);
    if (scale == Scale::factors) {
        box_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    } else {
        box_->setSingleStep(step);
    }
    // All alike, so that they stand in a column; the longest unit is N s/mm.
    box_->setMinimumWidth(fontMetrics().horizontalAdvance("0.00000 N s/mm") +
                          2 * fontMetrics().height());
    box_->setMaximumWidth(box_->minimumWidth());
    row_in(this, {slider_, box_})->setStretch(0, 1);
    setFocusProxy(box_);
    connect(slider_, &QSlider::valueChanged, this, [this](int place) { ask(value_at(place)); });
    connect(slider_, &QSlider::sliderReleased, &limiter_, &RateLimiter::flush);
    connect(box_, qOverload<double>(&NumberBox::valueChanged), this, [this](double value) {
        value_ = value;
        place_slider();
        limiter_.drop();
        Q_EMIT wanted(value);
    });
    set_value(low);
}

void Quantity::set_accessible_name(const QString& name) {
    slider_->setAccessibleName(name);
    box_->setAccessibleName(name);
}

void Quantity::set_value(double value) {
    value_ = value;
    box_->show_value(value);
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
    value_ = value;
    box_->show_value(value);
    limiter_.put([this, value] { Q_EMIT wanted(value); });
}

}  // namespace palpate::viewer

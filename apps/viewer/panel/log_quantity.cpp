// Slider and box kept in step, by the logarithm.
#include "apps/viewer/panel/log_quantity.hpp"

#include <QHBoxLayout>
#include <QSignalBlocker>

#include <algorithm>
#include <cmath>

namespace palpate::viewer {
namespace {

constexpr int places = 1000;  // of the slider

}  // namespace

LogQuantity::LogQuantity(const QString& name, const QString& unit, double low, double high,
                         QWidget* parent)
    : QWidget(parent),
      value_(low),
      low_(low),
      high_(high),
      slider_(new QSlider(Qt::Horizontal)),
      box_(new NumberBox),
      pacer_(this) {
    setObjectName(name);
    slider_->setObjectName(name + "_slider");
    slider_->setRange(0, places);
    slider_->setSingleStep(places / 100);
    slider_->setPageStep(places / 10);
    slider_->setMinimumWidth(3 * fontMetrics().height());
    let_wheel_pass(*slider_);
    box_->setObjectName(name + "_box");
    box_->setSuffix(" " + unit);
    box_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    box_->setMinimumWidth(fontMetrics().horizontalAdvance("0.0000 mm") +
                          2 * fontMetrics().height());
    box_->setMaximumWidth(box_->minimumWidth());
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    row->addWidget(slider_, 1);
    row->addWidget(box_);
    setFocusProxy(box_);
    connect(slider_, &QSlider::valueChanged, this, [this](int place) { ask(value_at(place)); });
    connect(slider_, &QSlider::sliderReleased, &pacer_, &Pacer::flush);
    connect(box_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, [this](double value) {
        value_ = value;
        place_slider();
        pacer_.drop();
        Q_EMIT wanted(value);
    });
    set_value(low);
}

void LogQuantity::set_accessible_name(const QString& name) {
    slider_->setAccessibleName(name);
    box_->setAccessibleName(name);
}

void LogQuantity::set_value(double value) {
    value_ = value;
    box_->show_value(value);
    if (!slider_->isSliderDown()) place_slider();
}

void LogQuantity::set_ends(double low, double high) {
    low_ = low;
    high_ = std::max(low, high);
    if (!slider_->isSliderDown()) place_slider();
}

/// Three digits between the ends, the ends themselves exactly.
double LogQuantity::value_at(int place) const {
    if (place <= 0) return low_;
    if (place >= places) return high_;
    const double value = low_ * std::pow(high_ / low_, static_cast<double>(place) / places);
    const double scale = std::pow(10.0, 2 - std::floor(std::log10(value)));
    return std::clamp(std::round(value * scale) / scale, low_, high_);
}

void LogQuantity::place_slider() {
    const QSignalBlocker quiet(slider_);
    const double bounded = std::clamp(value_, low_, high_);
    const double part = high_ > low_ ? std::log(bounded / low_) / std::log(high_ / low_) : 0;
    slider_->setValue(static_cast<int>(std::lround(places * part)));
}

void LogQuantity::ask(double value) {
    value_ = value;
    box_->show_value(value);
    pacer_.put([this, value] { Q_EMIT wanted(value); });
}

}  // namespace palpate::viewer

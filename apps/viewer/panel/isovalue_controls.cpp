// Keeps chart, slider and number box of the isovalue in step.
#include "apps/viewer/panel/isovalue_controls.hpp"

#include <QBoxLayout>
#include <QSignalBlocker>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/layout.hpp"
#include "palpate/renderer.hpp"

namespace palpate::viewer {
namespace {

constexpr int places = 10000;  // of the slider
constexpr int snapshots_of_grace = 3;

}  // namespace

IsovalueControls::IsovalueControls(Effect& effect)
    : effect_(effect),
      chart_(new LevelChart),
      slider_(named(new QSlider(Qt::Horizontal), "isovalue_slider", tr("Isovalue [data units]"))),
      box_(named(new NumberBox, "isovalue_box",
                 tr("Isovalue [data units]: the level whose surface is felt"))),
      solid_(
          named(new QComboBox, "solid",
                tr("Which side of the level is solid: bright bodies on dark, or airways and "
                   "vessels dark on bright.\nThe session starts anew, with penetrability off."))),
      smoothness_(named(new QComboBox, "field",
                        tr("How densities continue between samples: cubic, smooth, or linear, with "
                           "facets.\nThe session starts anew, with penetrability off."))),
      dequantize_(named(new QCheckBox(tr("dequantize")), "dequantize",
                        tr("Give back what rounding to levels took, against terraces and the stair "
                           "steps of masks.\nThe volume is read again; edits are lost."))),
      felt_(named(new QLabel, "felt",
                  tr("The level felt now [data units]; another than the isovalue while "
                     "penetrability lets the hand through"))),
      warning_(new Note("isovalue_warning", Note::Kind::warning)),
      overruled_(new Note("isovalue_overruled", Note::Kind::plain)),
      terraces_(new Note("terraces", Note::Kind::plain)),
      limiter_(this) {
    slider_->setRange(0, places);
    slider_->setSingleStep(places / 500);
    slider_->setPageStep(places / 50);
    slider_->setAccessibleName(tr("Isovalue"));
    let_wheel_pass(*slider_);
    box_->setMinimumWidth(fontMetrics().horizontalAdvance("-0000.0000") +
                          2 * fontMetrics().height());
    solid_->addItems({tr("above is solid"), tr("below is solid")});
    smoothness_->addItems({tr("linear"), tr("cubic")});
    let_wheel_pass(*solid_);
    let_wheel_pass(*smoothness_);
    QSizePolicy keeps_room = overruled_->sizePolicy();  // so that what is below does not jump
    keeps_room.setRetainSizeWhenHidden(true);
    overruled_->setSizePolicy(keeps_room);
    felt_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    column_in(this,
              {chart_, slider_, row_of({box_, felt_}, 1),
               row_of({solid_, smoothness_, dequantize_}, 2), terraces_, warning_, overruled_})
        ->setSpacing(3);
    connect_inputs();
    connect_effect();
    clear();
}

/// The data's axis along the slider.
LevelAxis IsovalueControls::slider_axis() const {
    LevelAxis axis = chart_->whole_axis();
    axis.left = 0;
    axis.right = places;
    return axis;
}

void IsovalueControls::connect_inputs() {
    connect(chart_, &LevelChart::level_moved, this, &IsovalueControls::ask);
    connect(chart_, &LevelChart::level_settled, &limiter_, &RateLimiter::flush);
    connect(slider_, &QSlider::sliderReleased, &limiter_, &RateLimiter::flush);
    connect(slider_, &QSlider::valueChanged, this, [this](int at) {
        const double fine = std::min(chart_->fine_step(), chart_->whole_axis().step());
        const LevelAxis axis = slider_axis();
        const double level = rounded_to(axis.level_of(at), fine);
        ask(std::clamp(level, axis.low, axis.high));
    });
    connect(box_, qOverload<double>(&NumberBox::valueChanged), this, [this](double level) {
        show_isovalue(level);
        limiter_.drop();
        request(level);
    });
    connect(dequantize_, &QCheckBox::clicked, this, [this](bool on) {
        dequantize_->setChecked(!on);  // until the volume has been read again
        Q_EMIT dequantize_wanted(on);
    });
    for (const QComboBox* box : {solid_, smoothness_}) {
        connect(box, qOverload<int>(&QComboBox::activated), this, [this] {
            Q_EMIT field_wanted(
                solid_->currentIndex() == 0 ? Solid::above : Solid::below,
                smoothness_->currentIndex() == 0 ? Interpolation::linear : Interpolation::cubic);
            show_field();  // that of a new session by now, unless it failed
        });
    }
}

void IsovalueControls::connect_effect() {
    connect(&effect_, &Effect::begun, this, &IsovalueControls::begin);
    connect(&effect_, &Effect::ended, this, &IsovalueControls::clear);
    connect(&effect_, &Effect::changed, this, &IsovalueControls::show);
    connect(&effect_, &Effect::observed, this, [this](const Snapshot& now) {
        show_felt(now.session.tick.proxy.isovalue, now.penetrability_on);
    });
}

void IsovalueControls::begin() {
    limiter_.drop();
    chart_->set_data(effect_.histogram(), run::suggested_isovalues(effect_.histogram()));
    box_->setSingleStep(chart_->fine_step());
    isovalue_ = effect_.isovalue();
    show_felt(isovalue_, false);
    show_field();
}

void IsovalueControls::show() {
    show_isovalue(effect_.isovalue());
    overruled_->say(effect_.settings().penetrability.on
                        ? tr("The level felt follows the hand: pressing through is on.")
                        : "");
    show_layered(effect_.settings().layers);
}

void IsovalueControls::clear() {
    limiter_.drop();
    chart_->clear();
    felt_->clear();
    overruled_->say({});
    show_layered(nullptr);
    warning_->say({});
    set_dequantized(false, false, {});
}

void IsovalueControls::show_field() {
    if (!effect_.there()) return;
    const Field& field = effect_.field();
    solid_->setCurrentIndex(field.solid() == Solid::above ? 0 : 1);
    smoothness_->setCurrentIndex(field.interpolation() == Interpolation::linear ? 0 : 1);
}

void IsovalueControls::set_dequantized(bool on, bool possible, const QString& reason) {
    dequantize_->setChecked(on);
    dequantize_->setEnabled(possible);
    terraces_->say(reason.isEmpty() ? "" : tr("Dequantizing is worth it: %1.").arg(reason));
}

/// The isovalue does nothing while layers are felt.
void IsovalueControls::show_layered(const SharedLayers& layers) {
    const bool layered = have_surfaces(layers);
    for (QWidget* one : std::initializer_list<QWidget*>{slider_, box_}) one->setEnabled(!layered);
    const QString tip = layered
                            ? tr("Layers are felt, not an isovalue: choose No layers to feel one")
                            : tr("Isovalue [data units]");
    slider_->setToolTip(tip);
    box_->setToolTip(layered ? tip : tr("Isovalue [data units]: the level whose surface is felt"));
    chart_->set_level_shown(!layered);
    if (layered) {
        overruled_->say(levels_in(layers) > 0
                            ? tr("Layers have levels of their own: drag their squares.")
                            : tr("Layers by label are felt, not a level of the densities."));
    }
    if (layered) warning_->say({});
}

/// Separately where it differs from the level asked for.
void IsovalueControls::show_felt(double isovalue, bool penetrability_on) {
    if (have_surfaces(effect_.settings().layers)) {
        chart_->set_felt(std::nan(""));
        return felt_->clear();
    }
    // Just after a command the snapshots still have the old level.
    differing_ = isovalue == isovalue_ ? 0 : differing_ + 1;
    const bool apart = penetrability_on || differing_ > snapshots_of_grace;
    chart_->set_felt(apart ? isovalue : std::nan(""));
    felt_->setText(apart ? tr("felt %1").arg(number_text(isovalue)) : QString());
}

void IsovalueControls::ask(double isovalue) {
    show_isovalue(isovalue);
    limiter_.put([this, isovalue] { request(isovalue); });
}

void IsovalueControls::request(double isovalue) {
    effect_.request(command::Isovalue{isovalue});
}

void IsovalueControls::show_isovalue(double isovalue) {
    isovalue_ = isovalue;
    chart_->set_level(isovalue);
    box_->show_value(isovalue);
    if (!slider_->isSliderDown()) {
        const QSignalBlocker quiet(slider_);
        slider_->setValue(static_cast<int>(std::lround(slider_axis().x_of(isovalue))));
    }
    warning_->say(effect_.there()
                      ? QString::fromStdString(isovalue_warning(effect_.field(), isovalue))
                      : QString());
}

}  // namespace palpate::viewer

// Keeps chart, slider and number box of the isovalue in step.
#include "apps/viewer/window/isovalue_controls.hpp"

#include <QBoxLayout>

#include <cmath>

#include "apps/viewer/panel/sentences.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/renderer.hpp"

namespace palpate::viewer {
namespace {

constexpr int snapshots_of_grace = 3;

}  // namespace

IsovalueControls::IsovalueControls(const Desk& desk)
    : EffectForm(desk.effect()),
      Desk(desk),
      chart_(new LevelChart),
      level_(quantity({"isovalue", "", tr("Isovalue [data units]: the level whose surface is felt"),
                       tr("Isovalue")},
                      {"", 0, 1, 1},
                      {[this] { return effect_.there() ? effect_.isovalue() : level_->value(); },
                       [this](double level) { effect_.request(command::Isovalue{level}); }})),
      felt_(named(new QLabel, "felt",
                  tr("The level felt now [data units]; another than the isovalue while "
                     "penetrability lets the hand through"))),
      terraces_(new Note(this, "terraces", Note::Kind::plain)) {
    dequantize_ = named(new QCheckBox(tr("dequantize")), "dequantize",
                        tr("Give back what rounding to levels took, against terraces and the stair "
                           "steps of masks.\nThe volume is read again; edits are lost."));
    connect(dequantize_, &QCheckBox::clicked, this, [this](bool on) {
        dequantize_->setChecked(!on);  // until the volume has been read again
        Q_EMIT dequantize_wanted(on);
    });
    felt_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    auto* slider = level_->findChild<QSlider*>();  // below the chart, as wide
    slider->setToolTip(level_->toolTip());
    for (QWidget* one : std::initializer_list<QWidget*>{level_, slider}) {
        each_time(one, [this](QWidget& shown) {
            allow(shown, layered()
                             ? tr("Layers are felt, not an isovalue: choose No layers to feel one")
                             : QString());
        });
    }
    each_time(chart_, [this](LevelChart& chart) {
        chart.set_level(layered() ? std::nan("") : level_->value());
    });
    each_time(new Note(this, "isovalue_warning", Note::Kind::warning), [this](Note& note) {
        const bool felt = effect_.there() && !layered();
        note.say(felt ? in_words(isovalue_warning(effect_.field(), effect_.isovalue()))
                      : QString());
    });
    each_time(new Note(this, "one_slice", Note::Kind::plain), [this](Note& note) {
        const bool smooth = effect_.there() && !layered() &&
                            effect_.field().interpolation() == Interpolation::cubic;
        const bool is_slice = smooth && effect_.field().geometry().size.minCoeff() == 1;
        note.say(is_slice ? tr("It is a single slice: the cubic field has holes between samples "
                               "that are little above the isovalue, the linear one has none.")
                          : QString());
    });
    note_overruled();
    column_in(this, {chart_, slider, row_of({level_, dequantize_}, 1), make_field(), felt_})
        ->setSpacing(3);
    connect(chart_, &LevelChart::level_moved, level_, &Quantity::ask);
    connect(&effect_, &Effect::observed, this, [this](const Snapshot& now) {
        show_felt(now.session.tick.proxy.isovalue, now.penetrability_on);
    });
    connect(&content_, &Content::run_changed, this, &IsovalueControls::show_terraces);
    clear();
    refresh();
}

bool IsovalueControls::layered() const {
    return have_surfaces(effect_.settings().layers);
}

/// The isovalue does nothing while layers are used, and follows the hand that presses through.
void IsovalueControls::note_overruled() {
    each_time(new Note(this, "isovalue_overruled", Note::Kind::plain), [this](Note& shown) {
        const RendererSettings& now = effect_.settings();
        shown.say(
            levels_in(now.layers) > 0 ? tr("Layers have levels of their own: drag their squares.")
            : layered()            ? tr("Layers by label are felt, not a level of the densities.")
            : now.penetrability.on ? tr("The level felt follows the hand: pressing through is on.")
                                   : QString());
    });
}

/// A choice here begins another session, unless that fails.
QWidget* IsovalueControls::make_field() {
    const auto field = [this] {
        return effect_.there() ? std::pair(effect_.field().solid(), effect_.field().interpolation())
                               : std::pair(Solid::above, Interpolation::linear);
    };
    auto* solid =
        choice({"solid", "",
                tr("Which side of the level is solid: bright bodies on dark, or airways and "
                   "vessels dark on bright.\nThe session starts anew, with penetrability off.")},
               {tr("above is solid"), tr("below is solid")},
               {[field] { return static_cast<int>(field().first); },
                [this, field](int side) { use_field(static_cast<Solid>(side), field().second); }});
    auto* smoothness = choice(
        {"field", "",
         tr("How densities continue between samples: cubic, smooth, or linear, with "
            "facets.\nThe session starts anew, with penetrability off.")},
        {tr("linear"), tr("cubic")},
        {[field] { return static_cast<int>(field().second); },
         [this, field](int as) { use_field(field().first, static_cast<Interpolation>(as)); }});
    return row_of({solid, smoothness}, 0);
}

void IsovalueControls::use_field(Solid solid, Interpolation interpolation) {
    const Field& now = effect_.field();
    if (now.solid() == solid && now.interpolation() == interpolation) return;
    messages_.guarded([&] { content_.use_field(solid, interpolation); });
}

/// As filters::reason_to_dequantize(), in the person's language.
QString IsovalueControls::reason_to_dequantize(const Opened& opened) {
    if (!opened.terraces || !opened.terraces->wide()) return {};
    const filters::Terraces& terraces = *opened.terraces;
    if (terraces.mask) return tr("the samples have two values, so surfaces are stair steps");
    return tr("rounding to levels of %1 makes terraces of %2 % of the surfaces and tilts them by "
              "%3 degrees")
        .arg(number_text(terraces.level, 4))
        .arg(std::lround(100 * terraces.share))
        .arg(std::lround(terraces.tilt));
}

void IsovalueControls::show_terraces() {
    const Opened& opened = *content_.volume();
    const bool on = opened.loaded.source.dequantize > 0;
    set_dequantized(on, on || opened.terraces, reason_to_dequantize(opened));
}

void IsovalueControls::begin() {
    chart_->set_data(effect_.histogram(), run::suggested_isovalues(effect_.histogram()));
    level_->box().setSingleStep(chart_->fine_step());
    level_->set_ends(chart_->whole_axis().low, chart_->whole_axis().high);
    differing_ = 0;
    show_felt(effect_.isovalue(), false);
}

void IsovalueControls::clear() {
    chart_->set_data({}, {});
    chart_->set_felt(std::nan(""));
    felt_->clear();
    set_dequantized(false, false, {});
}

void IsovalueControls::set_dequantized(bool on, bool possible, const QString& reason) {
    dequantize_->setChecked(on);
    dequantize_->setEnabled(possible);
    terraces_->say(reason.isEmpty() ? "" : tr("Dequantizing is worth it: %1.").arg(reason));
}

/// Separately where it differs from the level asked for.
void IsovalueControls::show_felt(double isovalue, bool penetrability_on) {
    // Just after a command the snapshots still have the old level.
    differing_ = isovalue == level_->value() ? 0 : differing_ + 1;
    const bool apart = !layered() && (penetrability_on || differing_ > snapshots_of_grace);
    chart_->set_felt(apart ? isovalue : std::nan(""));
    felt_->setText(apart ? tr("felt %1").arg(number_text(isovalue)) : QString());
}

}  // namespace palpate::viewer

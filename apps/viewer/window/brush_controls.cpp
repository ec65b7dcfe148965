// Connects the brush controls with the brush that is chosen, and that with the editor.
#include "apps/viewer/window/brush_controls.hpp"

#include <QBoxLayout>
#include <QButtonGroup>
#include <QCoreApplication>
#include <QLabel>
#include <QLineEdit>
#include <QToolButton>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/panel/sentences.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/views.hpp"
#include "palpate/names.hpp"

namespace palpate::viewer {
namespace {

constexpr double least_rate = 1, most_rate = 100;  // [1/s]

struct Kind {
    BrushKind kind;
    const char *text, *tip;
};
constexpr Kind all_kinds[] = {
    {BrushKind::carve, QT_TRANSLATE_NOOP("palpate::viewer::BrushControls", "Carve"),
     QT_TRANSLATE_NOOP("palpate::viewer::BrushControls", "Takes solid away where the brush is")},
    {BrushKind::add, QT_TRANSLATE_NOOP("palpate::viewer::BrushControls", "Add"),
     QT_TRANSLATE_NOOP("palpate::viewer::BrushControls", "Puts solid on where the brush is")},
    {BrushKind::smooth, QT_TRANSLATE_NOOP("palpate::viewer::BrushControls", "Smooth"),
     QT_TRANSLATE_NOOP("palpate::viewer::BrushControls", "Blurs: edges and noise wear off")},
    {BrushKind::paint, QT_TRANSLATE_NOOP("palpate::viewer::BrushControls", "Paint"),
     QT_TRANSLATE_NOOP("palpate::viewer::BrushControls",
                       "Brings the samples to the value, up or down")},
};

QString steps_text(const QString& what, std::size_t steps) {
    return steps > 0 ? QString("%1 (%2)").arg(what).arg(steps) : what;
}

QString in_words(std::size_t steps) {
    return steps == 0   ? BrushControls::tr("none")
           : steps == 1 ? BrushControls::tr("one step")
                        : BrushControls::tr("%n steps", nullptr, static_cast<int>(steps));
}

}  // namespace

BrushControls::BrushControls(const Desk& desk)
    : EffectForm(desk.effect()),
      Desk(desk),
      body_(new QWidget),
      reason_(new Note(this, "brush_reason", Note::Kind::plain)),
      on_(button({"brush", "", tr("While it is on, the probe edits the samples where it is")},
                 [this] { change([](BrushChoice& c) { c.on = !c.on; }); })),
      state_(named(new QLabel, "edit_state")) {
    setObjectName("brush_controls");
    on_->setCheckable(true);
    make_bold(*on_);
    each_time(on_, [this](QPushButton& one) {
        const bool on = choice_.on && reason_->text().isEmpty();
        one.setChecked(on);
        one.setText(on ? tr("Brush at the probe is ON") : tr("Brush at the probe is off"));
    });
    auto* column = column_in(body_, {on_, make_kinds()});
    column->addLayout(make_form());
    column->addWidget(make_history());
    column->addWidget(state_);
    column_in(this, {body_});
    connect(&effect_, &Effect::changed, this,
            [this] { set_tool(effect_.settings().tool != nullptr); });
    connect(&content_, &Content::run_changed, this, [this] {
        set_reason(content_.player()
                       ? tr("A sequence cannot be edited: open one frame of it (--time-step).")
                       : QString());
        use();
    });
    connect(&content_, &Content::closed, this, &BrushControls::use);
    clear();
    refresh();
}

QWidget* BrushControls::make_kinds() {
    auto* all = row_of({});
    auto* kinds = new QButtonGroup(this);
    all->setAccessibleName(tr("Kind of brush"));
    all->layout()->setSpacing(2);
    for (const Kind& kind : all_kinds) {
        auto* button =
            named(new QToolButton, QString("brush_") + enum_name(kind.kind), tr(kind.tip));
        button->setText(tr(kind.text));
        button->setCheckable(true);
        button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
        kinds->addButton(button, static_cast<int>(kind.kind));
        all->layout()->addWidget(button);
        each_time(button, [this, which = kind.kind](QToolButton& one) {
            one.setChecked(choice_.kind == which);
            make_bold(one, one.isChecked());  // dark palettes hardly show which one is pressed
        });
    }
    connect(kinds, &QButtonGroup::idClicked, this, [this](int id) {
        change([this, id](BrushChoice& c) {
            c.kind = static_cast<BrushKind>(id);
            c.value = values_[static_cast<std::size_t>(id)];
        });
    });
    return all;
}

/// Beyond the ends of its slider it says why not.
Quantity* BrushControls::limited(const Words& words, const Span& span, double BrushChoice::*member,
                                 const QString& limits) {
    const QString name = words.name;
    return quantity(
        words, span,
        {[this, member] { return std::isinf(choice_.*member) ? rate_ : choice_.*member; },
         [this, name, member, limits](double value) {
             auto& its = *findChild<Quantity*>(name);
             if (value >= its.low() && value <= its.high()) {
                 return change([=](BrushChoice& c) { c.*member = value; });
             }
             const auto text = [&](double number) { return number_text(its.per_1() * number, 4); };
             Q_EMIT nonsense(limits.arg(text(its.low()), text(its.high()), text(value))
                                 .replace("%4", its.box().suffix().trimmed()));
         }});
}

QLayout* BrushControls::make_form() {
    auto* as_tool = check({"brush_as_tool", tr("Shape of the tool")},
                          {[this] { return choice_.as_tool; },
                           [this](bool as_tool) {
                               change([&](BrushChoice& c) {
                                   c.as_tool = as_tool;
                                   c.radius = as_tool ? beyond_ : ball_;
                               });
                           }});
    each_time(as_tool, [this](QWidget& box) {
        box.setEnabled(tool_);
        box.setToolTip(tool_ ? tr("The brush works with what the tool is, also while it turns")
                             : tr("Take a tool on the page Feel first"));
    });
    radius_ =
        limited({"brush_radius", "",
                 tr("Where half of the effect is left, in the volume: from a voxel to a quarter of "
                    "the grid. With the shape of the tool: how far from its skin; with less than a "
                    "voxel, sharp corners stay where they are"),
                 tr("Radius of the brush")},
                {"mm", 1, 25, 0, Quantity::Scale::factors}, &BrushChoice::radius,
                tr("the brush's radius must be from %1 %4 (a voxel) to %2 %4 (a quarter of the "
                   "grid), not %3 %4"));
    auto* hardness = limited(
        {"brush_hardness", "", tr("1: an edge of two voxels; 0: an edge as wide as the brush"),
         tr("Hardness of the brush")},
        parts_span, &BrushChoice::hardness,
        tr("the brush's hardness must be from %1 to %2, not %3"));
    auto* rate = limited(
        {"brush_rate", "",
         tr("How fast the samples approach their final value [1/s]: 63 % of it after 1/rate s"),
         tr("Rate of the brush")},
        {"/s", least_rate, most_rate, 0, Quantity::Scale::factors}, &BrushChoice::rate,
        tr("the brush's rate must be from %1 to %2 /s or at once, not %3 /s"));
    each_time(rate, [this](Quantity& one) { one.setEnabled(std::isfinite(choice_.rate)); });
    auto* at_once = check({"brush_at_once", tr("At once")},
                          {[this] { return std::isinf(choice_.rate); },
                           [this](bool on) {
                               const double infinity = std::numeric_limits<double>::infinity();
                               change([&](BrushChoice& c) { c.rate = on ? infinity : rate_; });
                           }});
    at_once->setToolTip(rate->toolTip());
    auto* form = form_in();
    form->addRow(as_tool);
    add_row(*form, tr("Radius"), radius_, radius_->toolTip());
    add_row(*form, tr("Hardness"), hardness, hardness->toolTip());
    add_row(*form, tr("Rate"), rate, rate->toolTip());
    form->addRow("", at_once);
    add_row(
        *form, tr("Value"), make_value(),
        tr("What a whole touch leaves [data units]. Automatic: what fits the level that is felt"));
    return form;
}

/// A typed number is not automatic any more, even if it is the same.
QWidget* BrushControls::make_value() {
    const auto own = [this](double value) { change([=](BrushChoice& c) { c.value = value; }); };
    auto* box = number({"brush_value", "", {}, tr("Value of the brush")},
                       {[this] { return choice_.value.value_or(fitting()); }, own});
    box->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    box->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    box->setMinimumWidth(radius_->box().minimumWidth());
    auto* automatic = check(
        {"brush_automatic", tr("Automatic")},
        {[this] { return !choice_.value; },
         [this, box](bool on) {
             typed_ = false;
             change([&](BrushChoice& c) { c.value = on ? std::optional<double>() : box->value(); });
         }});
    connect(box->findChild<QLineEdit*>(), &QLineEdit::textEdited, this, [this, box, automatic] {
        typed_ = box->hasAcceptableInput();
        automatic->setChecked(!typed_ && !choice_.value);
    });
    connect(box, &QDoubleSpinBox::editingFinished, this, [this, box, own] {
        if (std::exchange(typed_, false)) own(box->value());
    });
    auto* both = row_of({box, automatic});
    both->setFocusProxy(box);
    for (QWidget* one : std::initializer_list<QWidget*>{box, automatic}) {
        each_time(one, [this](QWidget& w) { w.setEnabled(choice_.kind != BrushKind::smooth); });
    }
    return both;
}

QWidget* BrushControls::make_history() {
    undo_ = button({"undo", ""}, [this] { undo(); });
    redo_ = button({"redo", ""}, [this] { redo(); });
    auto* save =
        button({"save_edits", tr("Save as..."), tr("Writes the volume as it is now to a file")},
               [this] { Q_EMIT save_wanted(); });
    for (QPushButton* one : {undo_, redo_, save}) {
        one->setMinimumWidth(fontMetrics().horizontalAdvance(tr("Undo") + " (000)  "));
        connect(one, &QPushButton::pressed, this, [this] { Q_EMIT nonsense({}); });
    }
    return row_of({undo_, redo_, save});
}

void BrushControls::change(const std::function<void(BrushChoice&)>& how) {
    BrushChoice next = choice_;
    how(next);
    if (next == choice_) return refresh();
    Q_EMIT nonsense({});
    set_choice(next);
}

void BrushControls::set_choice(const BrushChoice& choice) {
    show_choice(choice);
    use();
}

/// One that the editor cannot use is undone.
void BrushControls::use() {
    run::VolumeEditor* editor = content_.editor();
    if (editor) {
        try {
            const bool works = choice_.on && !resting_;
            editor->set_brush(works ? std::optional<run::HandBrush>(choice_) : std::nullopt);
            used_ = choice_;
        } catch (const std::invalid_argument& e) {
            show_choice(used_);
            Q_EMIT nonsense(in_words(e.what()));
        }
    }
    const bool ball = editor && choice_.on && !choice_.as_tool;  // a tool is drawn
    set(views_, &Shown::brush, ball ? choice_.radius : 0);
}

void BrushControls::rest(bool on) {
    resting_ = on;
    use();
}

void BrushControls::undo() {
    step(&run::VolumeEditor::undo, tr("There is nothing to undo"));
}

void BrushControls::redo() {
    step(&run::VolumeEditor::redo, tr("There is nothing to redo"));
}

void BrushControls::step(bool (run::VolumeEditor::*take)(const OnProgress&),
                         const QString& if_none) {
    messages_.guarded([&] {
        run::VolumeEditor* editor = content_.editor();
        if (editor && !(editor->*take)({})) messages_.show_done(if_none);
    });
    observe();
}

run::EditState BrushControls::history() const {
    const run::VolumeEditor* editor = content_.editor();
    return editor ? editor->state() : run::EditState{};
}

void BrushControls::observe() {
    if (!content_.editor()) return;
    const run::EditState state = history();
    show_history(state);
    const QString problem = QString::fromStdString(state.problem);
    if (problem != std::exchange(problem_, problem) && !problem.isEmpty()) {
        messages_.show_done(problem);
    }
}

void BrushControls::toggle() {
    const QString why = reason_->text();
    why.isEmpty() ? on_->click() : messages_.show_done(why);
}

void BrushControls::show_choice(const BrushChoice& choice) {
    choice_ = choice;
    values_[static_cast<std::size_t>(choice.kind)] = choice.value;
    if (std::isfinite(choice.rate)) rate_ = choice.rate;
    (choice.as_tool ? beyond_ : ball_) = choice.radius;
    refresh();
}

/// The automatic value at the level in effect, from samples without edits.
double BrushControls::fitting() const {
    if (!effect_.there()) return 0;
    const Field& felt = effect_.field();
    const Field field(felt.volume(), felt.solid(), felt.background(), felt.interpolation());
    const auto kind = choice_.kind == BrushKind::carve ? BrushKind::carve : BrushKind::add;
    return brush_for(kind, field, effect_.isovalue(), choice_.radius).value;
}

/// Some room also in a thin slab.
void BrushControls::begin() {
    const Geometry& geometry = effect_.field().geometry();
    const double voxel = geometry.spacing.maxCoeff();
    const double side = geometry.size.cast<double>().cwiseProduct(geometry.spacing).minCoeff();
    radius_->set_ends(voxel, std::max(side / 4, 4 * voxel));
    const Ruler ruler = ruler_of(geometry);
    radius_->set_unit(QCoreApplication::translate("Units", ruler.unit), ruler.per_mm);
    ball_ = std::clamp(ball_, radius_->low(), radius_->high());
    beyond_ = voxel;
    choice_.radius = choice_.as_tool ? beyond_ : ball_;
    clear();
}

void BrushControls::set_tool(bool there) {
    tool_ = there;
    if (!there && choice_.as_tool) {
        change([&](BrushChoice& c) {
            c.as_tool = false;
            c.radius = ball_;
        });
    }
    refresh();
}

void BrushControls::clear() {
    values_ = {};
    choice_.value.reset();
    choice_.on = false;
    show_history({});
    set_reason({});
}

void BrushControls::show_history(const run::EditState& state) {
    const auto show = [](QPushButton* button, const QString& what, std::size_t steps,
                         const QString& tip) {
        button->setText(steps_text(what, steps));
        button->setEnabled(steps > 0);
        button->setToolTip(QString("%1: %2").arg(tip, in_words(steps)));
        button->setAccessibleName(QString("%1, %2").arg(what, in_words(steps)));
    };
    const auto possible = [this] { return std::pair(undo_->isEnabled(), redo_->isEnabled()); };
    const auto before = possible();
    show(undo_, tr("Undo"), state.undo_steps, tr("Takes the last edit back"));
    show(redo_, tr("Redo"), state.redo_steps, tr("Makes the edit again that was taken back"));
    const bool none = state.undo_steps + state.redo_steps == 0;
    state_->setText(state.changed ? tr("There are edits that are not saved")
                    : none        ? tr("Nothing was edited")
                                  : tr("Nothing is left to save"));
    if (possible() != before) Q_EMIT history_changed();
}

void BrushControls::set_reason(const QString& why) {
    if (why == reason_->text()) return;
    reason_->say(why);
    body_->setEnabled(why.isEmpty());
    refresh();
}

}  // namespace palpate::viewer

// Connects the brush controls with the brush that is chosen.
#include "apps/viewer/panel/brush_controls.hpp"

#include <QBoxLayout>
#include <QButtonGroup>
#include <QLabel>
#include <QLineEdit>
#include <QToolButton>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/viewer/panel/layout.hpp"

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

BrushControls::BrushControls()
    : body_(new QWidget),
      reason_(new Note("brush_reason", Note::Kind::plain)),
      on_(named(new QPushButton, "brush",
                tr("While it is on, the probe edits the samples where it is"))),
      kinds_(new QButtonGroup(this)),
      as_tool_(named(new QCheckBox(tr("Shape of the tool")), "brush_as_tool")),
      radius_(new Quantity("brush_radius", "mm", 1, 25, 0, Quantity::Scale::factors)),
      hardness_(new Quantity("brush_hardness", "", 0, 1, 0.05)),
      rate_box_(
          new Quantity("brush_rate", "/s", least_rate, most_rate, 0, Quantity::Scale::factors)),
      at_once_(named(new QCheckBox(tr("At once")), "brush_at_once")),
      value_(named(new NumberBox, "brush_value")),
      automatic_(named(new QCheckBox(tr("Automatic")), "brush_automatic")),
      undo_(named(new QPushButton, "undo")),
      redo_(named(new QPushButton, "redo")),
      save_(named(new QPushButton(tr("Save as...")), "save_edits",
                  tr("Writes the volume as it is now to a file"))),
      state_(named(new QLabel, "edit_state")) {
    setObjectName("brush_controls");
    build();
    connect_inputs();
    set_history(0, 0, false);
    show_choice();
}

void BrushControls::build() {
    on_->setCheckable(true);
    make_bold(*on_);
    radius_->set_accessible_name(tr("Radius of the brush"));
    hardness_->set_accessible_name(tr("Hardness of the brush"));
    rate_box_->set_accessible_name(tr("Rate of the brush"));
    value_->setAccessibleName(tr("Value of the brush"));
    value_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    value_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    value_->setMinimumWidth(radius_->box().minimumWidth());
    for (QPushButton* button : {undo_, redo_, save_}) {
        button->setMinimumWidth(fontMetrics().horizontalAdvance(tr("Undo") + " (000)  "));
    }
    auto* rate = row_of({rate_box_, at_once_});
    rate->setFocusProxy(rate_box_);
    auto* value = row_of({value_, automatic_});
    value->setFocusProxy(value_);
    auto* form = new QFormLayout;
    form->setVerticalSpacing(3);
    form->addRow(as_tool_);
    add_row(*form, tr("Radius"), radius_,
            tr("Where half of the effect is left [mm in the volume]: from a voxel to a quarter of "
               "the grid. With the shape of the tool: how far from its skin; with less than a "
               "voxel, sharp corners stay where they are"));
    add_row(*form, tr("Hardness"), hardness_,
            tr("1: an edge of two voxels; 0: an edge as wide as the brush"));
    add_row(*form, tr("Rate"), rate,
            tr("How fast the samples approach their final value [1/s]: 63 % of it after 1/rate s"));
    add_row(
        *form, tr("Value"), value,
        tr("What a whole touch leaves [data units]. Automatic: what fits the level that is felt"));
    auto* column = column_in(body_, {on_, make_kinds()});
    column->addLayout(form);
    column->addWidget(row_of({undo_, redo_, save_}));
    column->addWidget(state_);
    column_in(this, {reason_, body_});
}

QWidget* BrushControls::make_kinds() {
    auto* all = row_of({});
    all->setAccessibleName(tr("Kind of brush"));
    all->layout()->setSpacing(2);
    for (const Kind& kind : all_kinds) {
        const auto name = QString::fromStdString(std::string(name_of(kind.kind)));
        auto* button = named(new QToolButton, "brush_" + name, tr(kind.tip));
        button->setText(tr(kind.text));
        button->setCheckable(true);
        button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
        kinds_->addButton(button, static_cast<int>(kind.kind));
        all->layout()->addWidget(button);
    }
    return all;
}

void BrushControls::connect_inputs() {
    connect(on_, &QPushButton::clicked, this,
            [this](bool on) { change([on](BrushChoice& c) { c.on = on; }); });
    connect(kinds_, &QButtonGroup::idClicked, this, [this](int id) {
        change([this, id](BrushChoice& c) {
            c.kind = static_cast<BrushKind>(id);
            c.value = values_[static_cast<std::size_t>(id)];
        });
    });
    connect(as_tool_, &QCheckBox::clicked, this, [this](bool as_tool) {
        radius_->drop();
        change([&](BrushChoice& c) {
            c.as_tool = as_tool;
            c.radius = as_tool ? beyond_ : ball_;
        });
    });
    connect(at_once_, &QCheckBox::clicked, this, [this](bool at_once) {
        rate_box_->drop();
        const double rate = at_once ? std::numeric_limits<double>::infinity() : rate_;
        change([rate](BrushChoice& c) { c.rate = rate; });
    });
    connect(automatic_, &QCheckBox::clicked, this, [this](bool automatic) {
        typed_ = false;
        change([&](BrushChoice& c) {
            c.value = automatic ? std::optional<double>() : value_->value();
        });
    });
    connect(undo_, &QPushButton::clicked, this, &BrushControls::undo);
    connect(redo_, &QPushButton::clicked, this, &BrushControls::redo);
    connect(save_, &QPushButton::clicked, this, &BrushControls::save);
    connect_numbers();
}

void BrushControls::connect_numbers() {
    const auto connect_quantity = [this](Quantity* quantity, double BrushChoice::*member,
                                         const QString& limits) {
        connect(quantity, &Quantity::wanted, this, [this, quantity, member, limits](double value) {
            if (value >= quantity->low() && value <= quantity->high()) {
                return change([=](BrushChoice& c) { c.*member = value; });
            }
            show_choice();
            const auto text = [](double number) { return QString::number(number, 'g', 4); };
            Q_EMIT nonsense(limits.arg(text(quantity->low()), text(quantity->high()), text(value)));
        });
    };
    connect_quantity(
        radius_, &BrushChoice::radius,
        tr("the brush's radius must be from %1 mm (a voxel) to %2 mm (a quarter of the "
           "grid), not %3 mm"));
    connect_quantity(hardness_, &BrushChoice::hardness,
                     tr("the brush's hardness must be from %1 to %2, not %3"));
    connect_quantity(rate_box_, &BrushChoice::rate,
                     tr("the brush's rate must be from %1 to %2 /s or at once, not %3 /s"));
    // A typed number is not automatic any more, even if it is the same.
    const auto own = [this](double value) { change([value](BrushChoice& c) { c.value = value; }); };
    connect(value_, qOverload<double>(&NumberBox::valueChanged), this, own);
    connect(value_->findChild<QLineEdit*>(), &QLineEdit::textEdited, this, [this] {
        typed_ = value_->hasAcceptableInput();
        automatic_->setChecked(!typed_ && !choice_.value);
    });
    connect(value_, &QDoubleSpinBox::editingFinished, this, [this, own] {
        if (std::exchange(typed_, false)) own(value_->value());
    });
}

void BrushControls::change(const std::function<void(BrushChoice&)>& how) {
    BrushChoice next = choice_;
    how(next);
    const bool same = next == choice_;
    set_choice(next);
    if (!same) Q_EMIT changed(choice_);
}

void BrushControls::set_choice(const BrushChoice& choice) {
    choice_ = choice;
    values_[static_cast<std::size_t>(choice.kind)] = choice.value;
    if (std::isfinite(choice.rate)) rate_ = choice.rate;
    (choice.as_tool ? beyond_ : ball_) = choice.radius;
    show_choice();
}

void BrushControls::refuse(const BrushChoice& before, const QString& why) {
    set_choice(before);
    Q_EMIT nonsense(why);
}

double BrushControls::fitting() const {
    return choice_.kind == BrushKind::carve ? carve_fits_ : add_fits_;
}

void BrushControls::show_choice() {
    const bool on = choice_.on && reason_->text().isEmpty();
    on_->setChecked(on);
    on_->setText(on ? tr("Brush at the probe is ON") : tr("Brush at the probe is off"));
    kinds_->button(static_cast<int>(choice_.kind))->setChecked(true);
    // Bold: dark palettes hardly show which button is pressed.
    for (auto* button : kinds_->buttons()) make_bold(*button, button->isChecked());
    as_tool_->setChecked(choice_.as_tool);
    radius_->set_value(choice_.radius);
    hardness_->set_value(choice_.hardness);
    const bool at_once = std::isinf(choice_.rate);
    at_once_->setChecked(at_once);
    rate_box_->setEnabled(!at_once);
    rate_box_->set_value(rate_);
    const bool valued = choice_.kind != BrushKind::smooth;
    value_->setEnabled(valued);
    automatic_->setEnabled(valued);
    automatic_->setChecked(!choice_.value);
    value_->show_value(choice_.value.value_or(fitting()));
}

void BrushControls::set_grid(const Geometry& geometry) {
    const double voxel = geometry.spacing.maxCoeff();
    const double side = geometry.size.cast<double>().cwiseProduct(geometry.spacing).minCoeff();
    radius_->drop();
    radius_->set_ends(voxel, std::max(side / 4, 4 * voxel));  // some room also in a thin slab
    ball_ = std::clamp(ball_, radius_->low(), radius_->high());
    beyond_ = voxel;
    choice_.radius = choice_.as_tool ? beyond_ : ball_;
    show_choice();
}

void BrushControls::set_tool(bool there) {
    as_tool_->setEnabled(there);
    as_tool_->setToolTip(there ? tr("The brush works with what the tool is, also while it turns")
                               : tr("Take a tool on the page Feel first"));
    if (!there && choice_.as_tool) {
        change([&](BrushChoice& c) {
            c.as_tool = false;
            c.radius = ball_;
        });
    }
}

void BrushControls::set_fitting(double carve, double add) {
    if (carve == carve_fits_ && add == add_fits_) return;
    carve_fits_ = carve;
    add_fits_ = add;
    show_choice();
}

void BrushControls::reset() {
    drop();
    values_ = {};
    choice_.value.reset();
    choice_.on = false;
    show_choice();
}

void BrushControls::set_history(std::size_t undo_steps, std::size_t redo_steps, bool changed) {
    const auto show = [](QPushButton* button, const QString& what, std::size_t steps,
                         const QString& tip) {
        button->setText(steps_text(what, steps));
        button->setEnabled(steps > 0);
        button->setToolTip(QString("%1: %2").arg(tip, in_words(steps)));
        button->setAccessibleName(QString("%1, %2").arg(what, in_words(steps)));
    };
    show(undo_, tr("Undo"), undo_steps, tr("Takes the last edit back"));
    show(redo_, tr("Redo"), redo_steps, tr("Makes the edit again that was taken back"));
    state_->setText(changed                        ? tr("There are edits that are not saved")
                    : undo_steps + redo_steps == 0 ? tr("Nothing was edited")
                                                   : tr("Nothing is left to save"));
}

void BrushControls::set_reason(const QString& why) {
    if (why == reason_->text()) return;
    drop();
    reason_->say(why);
    body_->setEnabled(why.isEmpty());
    show_choice();
}

void BrushControls::drop() {
    radius_->drop();
    hardness_->drop();
    rate_box_->drop();
}

}  // namespace palpate::viewer

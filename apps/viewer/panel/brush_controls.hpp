// Controls of the brush at the probe, with undo, redo and save.
#pragma once

#include <array>
#include <functional>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "palpate/run/brush.hpp"

namespace palpate::viewer {

/// Smoothing has no value of its own.
struct BrushChoice : run::HandBrush {
    bool on = false;  ///< the probe edits where it is

    bool operator==(const BrushChoice&) const = default;
};

/// Remembers a typed value for each kind of brush, as a value that carves cannot add. Setters emit
/// nothing. With each session the brush is off, its values are automatic, there are no edits and no
/// reason. Its radius goes from the largest spacing of the grid to a quarter of the shortest side.
class BrushControls : public EffectForm {
    Q_OBJECT

  public:
    explicit BrushControls(Effect& effect);

    /// Whether a tool is in the hand, whose shape the brush can take. Without one it is a ball.
    void set_tool(bool there);
    /// Shows a choice, even one that the controls would not allow.
    void set_choice(const BrushChoice& choice);
    const BrushChoice& choice() const { return choice_; }
    /// The change that was emitted last cannot be: shows the choice before, and why.
    void refuse(const BrushChoice& before, const QString& why);
    void set_history(std::size_t undo_steps, std::size_t redo_steps, bool changed);
    /// One sentence why nothing can be edited, which also shows the switch off. Empty: it can.
    void set_reason(const QString& why);
    QString reason() const { return reason_->text(); }
    /// As if the switch was pressed.
    void toggle() { on_->click(); }

  Q_SIGNALS:
    void changed(const palpate::viewer::BrushChoice& choice);
    void undo();
    void redo();
    void save();

  private:
    QWidget* make_kinds();
    QWidget* make_value();
    QLayout* make_form();
    QWidget* make_history();
    Quantity* limited(const Words& words, const Span& span, double BrushChoice::*member,
                      const QString& limits);
    void change(const std::function<void(BrushChoice&)>& how);
    void begin() override;
    void clear() override;
    double fitting() const;

    BrushChoice choice_;
    std::array<std::optional<double>, 4> values_;  // by kind
    double ball_ = 3, beyond_ = 1;  // [mm] the radius of a ball, and beyond the skin of a tool
    double rate_ = 10;              // [1/s] while it is not at once
    bool typed_ = false;            // a whole number that does not count yet
    bool tool_ = false;
    QWidget* body_;
    Note* reason_;
    QPushButton* on_;
    Quantity* radius_ = nullptr;
    QPushButton *undo_ = nullptr, *redo_ = nullptr;
    QLabel* state_;
};

}  // namespace palpate::viewer

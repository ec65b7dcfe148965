// The brush at the probe: its controls, with undo, redo and save, and the brush of the live run's
// editor.
#pragma once

#include <array>
#include <functional>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/window/desk.hpp"
#include "palpate/run/brush.hpp"
#include "palpate/run/volume_editor.hpp"

namespace palpate::viewer {

/// Smoothing has no value of its own.
struct BrushChoice : run::HandBrush {
    bool on = false;  ///< the probe edits where it is

    bool operator==(const BrushChoice&) const = default;
};

/// Remembers a typed value for each kind of brush, as a value that carves cannot add. With each
/// session the brush is off, its values are automatic, there are no edits and no reason. Its radius
/// goes from the largest spacing of the grid to a quarter of the shortest side.
class BrushControls : public EffectForm, protected Desk {
    Q_OBJECT

  public:
    explicit BrushControls(const Desk& desk);

    /// Takes a choice, even one that the controls would not allow.
    void set_choice(const BrushChoice& choice);
    const BrushChoice& choice() const { return choice_; }
    /// As if the switch was pressed. Says why if nothing can be edited.
    void toggle();
    /// While the hand is lifted the brush does nothing.
    void rest(bool on);
    void undo();
    void redo();
    /// The edits of the live run. Without an editor there are none.
    run::EditState history() const;
    /// Shows what can be undone; about thirty times a second.
    void observe();

  Q_SIGNALS:
    void save_wanted();
    /// Other edits can be undone or made again.
    void history_changed();

  private:
    QWidget* make_kinds();
    QWidget* make_value();
    QLayout* make_form();
    QWidget* make_history();
    Quantity* limited(const Words& words, const Span& span, double BrushChoice::*member,
                      const QString& limits);
    void change(const std::function<void(BrushChoice&)>& how);
    void show_choice(const BrushChoice& choice);
    void use();
    /// Whether a tool is in the hand, whose shape the brush can take. Without one it is a ball.
    void set_tool(bool there);
    void show_history(const run::EditState& state);
    /// One sentence why nothing can be edited, which also shows the switch off. Empty: it can.
    void set_reason(const QString& why);
    void step(bool (run::VolumeEditor::*take)(const OnProgress&), const QString& if_none);
    void begin() override;
    void clear() override;
    double fitting() const;

    BrushChoice choice_, used_;  // and the last one that the editor could use
    bool resting_ = false;
    QString problem_;                              // of the editor
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

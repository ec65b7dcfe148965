// Controls of the brush at the probe, with undo, redo and save.
#pragma once

#include <QCheckBox>
#include <QPushButton>
#include <QWidget>

#include <array>
#include <functional>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "palpate/run/brush.hpp"

class QButtonGroup;

namespace palpate::viewer {

/// Smoothing has no value of its own.
struct BrushChoice : run::HandBrush {
    bool on = false;  ///< the probe edits where it is

    bool operator==(const BrushChoice&) const = default;
};

/// Remembers a typed value for each kind of brush, as a value that carves cannot add. Setters emit
/// nothing.
class BrushControls : public QWidget {
    Q_OBJECT

  public:
    BrushControls();

    /// The radius goes from the largest spacing of the grid to a quarter of the shortest side of
    /// the grid; a radius outside goes to the nearer end; choice() has the result.
    void set_grid(const Geometry& geometry);
    /// What "automatic" stands for now [data units]: for carving, and for adding and painting.
    void set_fitting(double carve, double add);
    /// Whether a tool is in the hand, whose shape the brush can take. Without one it is a ball.
    void set_tool(bool there);
    /// Shows a choice, even one that the controls would not allow.
    void set_choice(const BrushChoice& choice);
    const BrushChoice& choice() const { return choice_; }
    /// The change that was emitted last cannot be: shows the choice before, and why.
    void refuse(const BrushChoice& before, const QString& why);
    /// Off, and the values of all kinds automatic: another volume.
    void reset();
    void set_history(std::size_t undo_steps, std::size_t redo_steps, bool changed);
    /// One sentence why nothing can be edited, which also shows the switch off. Empty: it can.
    void set_reason(const QString& why);
    QString reason() const { return reason_->text(); }
    /// As if the switch was pressed.
    void toggle() { on_->click(); }
    void drop();

  Q_SIGNALS:
    void changed(const palpate::viewer::BrushChoice& choice);
    void undo();
    void redo();
    void save();
    /// What cannot be chosen, and why; the choice stays.
    void nonsense(const QString& why);

  private:
    void build();
    QWidget* make_kinds();
    void connect_inputs();
    void connect_numbers();
    void change(const std::function<void(BrushChoice&)>& how);
    void show_choice();
    double fitting() const;

    BrushChoice choice_;
    std::array<std::optional<double>, 4> values_;  // by kind
    double carve_fits_ = 0, add_fits_ = 0;
    double ball_ = 3, beyond_ = 1;  // [mm] the radius of a ball, and beyond the skin of a tool
    double rate_ = 10;              // [1/s] while it is not at once
    bool typed_ = false;            // a whole number that does not count yet
    QWidget* body_;
    Note* reason_;
    QPushButton* on_;
    QButtonGroup* kinds_;
    QCheckBox* as_tool_;
    Quantity* radius_;
    Quantity* hardness_;
    Quantity* rate_box_;
    QCheckBox* at_once_;
    NumberBox* value_;
    QCheckBox* automatic_;
    QPushButton *undo_, *redo_, *save_;
    QLabel* state_;
};

}  // namespace palpate::viewer

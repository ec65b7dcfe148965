// Layers: the choice of a set, what is touched now, the list of layers with the properties of one,
// and the force along the stroke.
#pragma once

#include <QComboBox>
#include <QElapsedTimer>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QWidget>

#include <functional>
#include <optional>
#include <vector>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/inputs.hpp"

namespace palpate::viewer {

class CurveControls;
class LayerEditor;
class NeedleControls;
class Note;
class StrokePlot;

/// A set that can be chosen. One by label may lack the places of its labels: labels_wanted().
struct LayersChoice {
    SharedLayers layers;
    QString about;
    QString note;          ///< what a person should know who feels it in these data; empty: nothing
    bool possible = true;  ///< not in these data; the note says why
};

class LayersControls : public QWidget {
    Q_OBJECT

  public:
    explicit LayersControls(Effect& effect);

    void set_choices(std::vector<LayersChoice> choices);
    /// As they are shown: those in effect, or asked for in a moment.
    const SharedLayers& layers() const { return layers_; }
    /// They were changed, and are in no file.
    bool unsaved() const;
    void set_saved() { saved_ = layers_; }
    /// Of the layer that is chosen; nothing: there is none, or layers are by label.
    std::optional<double> chosen_level() const;
    /// What a file that was opened says; shown until another set is chosen.
    void say(const QString& note);
    /// As by hand.
    void use(const SharedLayers& layers);
    void move_level(int layer, double level);
    /// Of the property that is chosen.
    void set_curve(const std::vector<Curve::Knot>& knots);
    /// The same, over the gradient.
    void set_factors(const std::vector<Curve::Knot>& knots);
    HapticProperty curve_property() const;
    void choose_layer(int layer);
    LevelRoom room(int layer) const;
    /// What moves fast: the force along a stroke. About sixty times a second.
    void show_snapshot(const Snapshot& now);
    /// A change of the same number that comes within `ms` is one step to undo with the one before.
    void set_one_step(int ms) { one_step_ms_ = ms; }

  Q_SIGNALS:
    /// The places of its labels are to be looked up, then use().
    void labels_wanted(const palpate::viewer::SharedLayers& layers);
    /// The curve of another property is to be shown.
    void curve_chosen();
    void open_wanted();
    void save_wanted();

  private:
    QWidget* make_choice();
    QWidget* make_stroke();
    QWidget* make_list();
    void connect_list();
    void connect_curve();
    void connect_inputs();
    void connect_effect();
    void begin();
    void clear();
    void request(const SharedLayers& layers);
    void edit(const SharedLayers& next, const QString& key);
    void change(const QString& key, const std::function<void(Layers&)>& how);
    void add_layer();
    void remove_layer();
    void shift_layer(int by);
    void begin_curve();
    void step(bool back);
    void show();
    void show_choice();
    void show_list();
    void show_item(int row);
    void show_order();
    int chosen() const;

    Effect& effect_;
    SharedLayers layers_, saved_;
    double low_ = 0, high_ = 1;
    std::vector<LayersChoice> choices_;
    LayersHistory history_;
    QString last_key_;
    QElapsedTimer since_edit_;
    int one_step_ms_ = 1000;

    QComboBox* choice_;
    QPushButton *open_, *save_, *undo_, *redo_, *add_, *remove_, *earlier_, *later_;
    Note* note_;
    QLabel* touched_;
    QWidget* body_;
    QListWidget* list_;
    CurveControls* curve_;
    LayerEditor* editor_;
    NeedleControls* needle_;
    StrokePlot* plot_;
    RateLimiter limiter_;
};

}  // namespace palpate::viewer

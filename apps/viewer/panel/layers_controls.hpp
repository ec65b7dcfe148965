// Layers: the choice of a set, what is touched now, the list of layers with the properties of one,
// and the force along the stroke.
#pragma once

#include <QCheckBox>
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
#include "apps/viewer/panel/rate_limiter.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

class LayerEditor;
class Note;
class StrokePlot;

/// A set that can be chosen.
struct LayersChoice {
    SharedLayers layers;
    QString about;
    QString note;          ///< what a person should know who feels it in these data; empty: nothing
    bool possible = true;  ///< not in these data; the note says why
};

class LayersControls : public QWidget {
    Q_OBJECT

  public:
    LayersControls();

    /// Of data from `low` to `high`. There is nothing to undo.
    void set_data(double low, double high, Solid solid);
    void clear();
    void set_choices(std::vector<LayersChoice> choices);
    /// Shows the layers in effect; emits nothing. With none, one can be added at `isovalue`.
    void set_layers(const RendererSettings& settings, double isovalue);
    const SharedLayers& layers() const { return layers_; }
    /// Of the layer that is chosen; nothing: there is none.
    std::optional<double> chosen_level() const;
    /// What a file that was opened says; shown until another set is chosen.
    void say(const QString& note);
    /// As by hand.
    void use(const SharedLayers& layers);
    void move_level(int layer, double level);
    void set_stiffness_curve(const std::vector<Curve::Knot>& knots);
    void choose_layer(int layer);
    LevelRoom room(int layer) const;
    void show_snapshot(const Snapshot& now);
    /// Forgets a request that waits.
    void drop() { limiter_.drop(); }

  Q_SIGNALS:
    /// At most 60 a second. Null: none.
    void wanted(const palpate::viewer::SharedLayers& layers);
    void open_wanted();
    void save_wanted();

  private:
    QWidget* make_choice();
    QWidget* make_stroke();
    QWidget* make_list();
    void connect_inputs();
    void edit(const SharedLayers& next, const QString& key);
    void change(const QString& key, const std::function<void(Layers&)>& how);
    void add_layer();
    void remove_layer();
    void step(bool back);
    void show();
    void show_choice();
    void show_list();
    int chosen() const;

    SharedLayers layers_;
    RendererSettings settings_;
    double isovalue_ = 0, low_ = 0, high_ = 1;
    Solid solid_ = Solid::above;
    std::vector<LayersChoice> choices_;
    LayersHistory history_;
    QString last_key_;
    QElapsedTimer since_edit_;

    QComboBox* choice_;
    QPushButton *open_, *save_, *undo_, *redo_, *add_, *remove_;
    Note* note_;
    QLabel* touched_;
    QWidget* body_;
    QListWidget* list_;
    QCheckBox* needle_;
    LayerEditor* editor_;
    StrokePlot* plot_;
    RateLimiter limiter_;
};

}  // namespace palpate::viewer

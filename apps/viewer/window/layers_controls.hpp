// Layers: the choice of a set that suits the volume, opening and saving others, what is touched
// now, the list of layers with the properties of one, and the force along the stroke.
#pragma once

#include <QCoreApplication>
#include <QElapsedTimer>
#include <QLabel>
#include <QListWidget>
#include <QtGlobal>

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/io/layers_file.hpp"

namespace palpate::viewer {

class LookControls;
class OverlayControls;
class StrokePlot;
struct Overlay;
struct SessionFile;

/// Names, units and usual ranges of what layers and their curves give.
struct PropertyWords {
    HapticProperty property;
    const char *label, *name, *unit;
    double high, step;  ///< of the slider, the box
    const char* tip;
};

/// In the order of HapticProperty.
struct PropertyTable {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::LayersControls)
  public:
    static constexpr std::array<PropertyWords, haptic_property_count> rows{
        {{HapticProperty::stiffness, QT_TR_NOOP("Stiffness"), "layer_stiffness", "N/mm", 3, 0.05,
          QT_TR_NOOP("Stiffness of the layer's surface [N/mm]")},
         {HapticProperty::static_friction, QT_TR_NOOP("Static friction"), "layer_static_friction",
          "", 1.5, 0.05,
          QT_TR_NOOP("Coefficient past which the proxy begins to slide on the surface (no unit)")},
         {HapticProperty::dynamic_friction, QT_TR_NOOP("Dynamic friction"),
          "layer_dynamic_friction", "", 1.5, 0.05,
          QT_TR_NOOP("Coefficient while it slides; counts as at most the static one")},
         {HapticProperty::damping, QT_TR_NOOP("Damping"), "layer_damping", "N s/mm", 2e-3, 1e-4,
          QT_TR_NOOP("Of the surface, against motion along its normal [N s/mm]")},
         {HapticProperty::viscosity, QT_TR_NOOP("Viscosity"), "layer_viscosity", "N s/mm", 1e-3,
          1e-4, QT_TR_NOOP("Of what lies behind the surface, against all motion there [N s/mm]")},
         {HapticProperty::puncture_force, QT_TR_NOOP("Puncture force"), "layer_puncture_force", "N",
          3, 0.1, QT_TR_NOOP("Force of the press at which the surface gives way [N]")},
         {HapticProperty::drag, QT_TR_NOOP("Drag"), "layer_drag", "N/mm", 0.1, 0.005,
          QT_TR_NOOP("Rubbing on a needle's shaft for each millimetre of it in the "
                     "layer [N/mm]; without a needle there is none")}}};
};
inline constexpr const auto& property_words = PropertyTable::rows;

inline constexpr const PropertyWords& words_of(HapticProperty property) {
    return property_words[static_cast<std::size_t>(property)];
}

/// A set that can be chosen. One by label may lack the places of its labels.
struct LayersChoice {
    SharedLayers layers;
    QString about;
    QString note;          ///< what a person should know who feels it in these data; empty: nothing
    bool possible = true;  ///< not in these data; the note says why
};

/// Object names: layer_name, layer_level, layer_colour, layer_opacity, layer_stiffness and so on
/// for the properties, layer_never; with _clear, the button that clears a property. Of their
/// curves: curve_property, start_curve, remove_curve, curve_note; start_gradient, remove_gradient,
/// gradient_chart. layers_closing, needle, needle_lateral, needle_static_ratio, needle_stick_speed.
class LayersControls : public EffectForm, protected Desk {
    Q_OBJECT

  public:
    LayersControls(const Desk& desk, LookControls& look, OverlayControls& overlays);

    /// Whether the text of a JSON file is that of layers, and of no session.
    static bool is_layers(const std::string& text);
    /// Feels the layers of a file. Errors are shown; the layers before stay then.
    void take(const QString& path, const io::LayersFile& file);
    /// Each hand of the session feels its layers that lack_labels() once their label volume has
    /// been read; a name that is relative counts from the working folder, then from that of `file`.
    void restore(const SessionFile& session, const QString& file);
    void set_choices(std::vector<LayersChoice> choices);
    const SharedLayers& layers() const { return effect_.settings().layers; }
    /// They were changed, and are in no file.
    bool unsaved() const;
    void set_saved() { saved_ = layers(); }
    /// Of the layer that is chosen; nothing: there is none, or layers are by label.
    std::optional<double> chosen_level() const;
    /// As by hand.
    void use(const SharedLayers& layers);
    void move_level(int layer, double level);
    /// Of the property that is chosen.
    void set_curve(const Knots& knots);
    HapticProperty curve_property() const { return property_; }
    void choose_layer(int layer);
    LevelRoom room(int layer) const;
    /// What moves fast: the force along a stroke. About sixty times a second.
    void show_snapshot(const Snapshot& now);
    /// A change of the same number that comes within `ms` is one step to undo with the one before.
    void set_one_step(int ms) { one_step_ms_ = ms; }

  Q_SIGNALS:
    /// The curve of another property is to be shown.
    void curve_chosen();

  private:
    QWidget* make_choice();
    QWidget* make_list();
    QWidget* make_layer();
    void add_property(QFormLayout& form, const PropertyWords& words);
    QWidget* make_never(Quantity& puncture);
    QWidget* make_needle();
    QWidget* make_curves();
    QComboBox* make_property();
    QWidget* make_curve(Curve PropertyCurves::*curve, const QString& label, const Words& start,
                        const Words& remove, std::function<Curve::Knot()> first);
    void begin() override;
    void clear() override;
    void choose_set(int at);
    LayersChoice choice_of(const io::LayersFile& file) const;
    LayersChoice choice_of_labels(const Overlay& labels) const;
    void limit_to_labels(LayersChoice& choice) const;
    void offer();
    void feel_labels();
    void feel(const LayersChoice& choice);
    void place(const SharedLayers& layers);
    void show_label_map();
    void ask_open();
    void open(const QString& path);
    void ask_save();
    void save(const QString& path);
    void edit(const SharedLayers& next, const QString& key = {});
    bool request(const SharedLayers& next);
    void change(const QString& key, const std::function<void(Layers&)>& how);
    /// Changes by this key continue each other.
    Parts<Layers> whole(const QString& key);
    Parts<Layer> chosen_part(const QString& key);
    void set_knots(Curve PropertyCurves::*curve, const Knots& knots);
    void add_layer();
    void remove_layer();
    void shift_layer(int by);
    void step(bool back);
    void show_choice();
    void show_list();
    int chosen() const;
    bool by_label() const { return layers() && layers()->by_label; }
    int count() const { return static_cast<int>(all().layers.size()); }
    int levels() const { return static_cast<int>(levels_in(layers())); }
    /// Empty ones where there are none.
    const Layers& all() const;
    double gap() const;

    LookControls& look_;
    OverlayControls& overlays_;
    std::vector<io::LayersFile> files_;  // built in, then those that were opened
    std::size_t built_in_ = 0;           // how many of them
    BackgroundTask reader_;              // of layers and of labels
    SharedLayers saved_;
    double low_ = 0, high_ = 1;
    std::vector<LayersChoice> choices_;
    LayersHistory history_;
    QString last_key_;
    QElapsedTimer since_edit_;
    int one_step_ms_ = 1000;
    HapticProperty property_ = HapticProperty::stiffness;  // whose curves are shown
    double last_puncture_ = 1;                             // [N] to go back to

    QComboBox* choice_;
    Note* note_;
    QLabel* touched_;
    QListWidget* list_;
    LevelChart* factors_;
    StrokePlot* plot_;
};

}  // namespace palpate::viewer

// Names, units and usual ranges of what layers and their curves give.
#pragma once

#include <QtGlobal>
#include <array>

#include "palpate/layers.hpp"

namespace palpate::viewer {

struct PropertyWords {
    HapticProperty property;
    const char *label, *name, *unit;
    double high, step;  ///< of the slider, the box
    const char* tip;
};

/// In the order of HapticProperty. LayerEditor::tr() has the words.
inline constexpr std::array<PropertyWords, haptic_property_count> property_words{
    PropertyWords{HapticProperty::stiffness,
                  QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor", "Stiffness"), "layer_stiffness",
                  "N/mm", 3, 0.05,
                  QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor",
                                    "Stiffness of the layer's surface [N/mm]")},
    PropertyWords{HapticProperty::static_friction,
                  QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor", "Static friction"),
                  "layer_static_friction", "", 1.5, 0.05,
                  QT_TRANSLATE_NOOP(
                      "palpate::viewer::LayerEditor",
                      "Coefficient past which the proxy begins to slide on the surface (no unit)")},
    PropertyWords{
        HapticProperty::dynamic_friction,
        QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor", "Dynamic friction"),
        "layer_dynamic_friction", "", 1.5, 0.05,
        QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor",
                          "Coefficient while it slides; counts as at most the static one")},
    PropertyWords{HapticProperty::damping,
                  QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor", "Damping"), "layer_damping",
                  "N s/mm", 2e-3, 1e-4,
                  QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor",
                                    "Of the surface, against motion along its normal [N s/mm]")},
    PropertyWords{
        HapticProperty::viscosity, QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor", "Viscosity"),
        "layer_viscosity", "N s/mm", 1e-3, 1e-4,
        QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor",
                          "Of what lies behind the surface, against all motion there [N s/mm]")},
    PropertyWords{HapticProperty::puncture_force,
                  QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor", "Puncture force"),
                  "layer_puncture_force", "N", 3, 0.1,
                  QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor",
                                    "Force of the press at which the surface gives way [N]")},
    PropertyWords{HapticProperty::drag, QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor", "Drag"),
                  "layer_drag", "N/mm", 0.1, 0.005,
                  QT_TRANSLATE_NOOP("palpate::viewer::LayerEditor",
                                    "Rubbing on a needle's shaft for each millimetre of it in the "
                                    "layer [N/mm]; without a needle there is none")}};

inline constexpr const PropertyWords& words_of(HapticProperty property) {
    return property_words[static_cast<std::size_t>(property)];
}

}  // namespace palpate::viewer

// Sections of the panel that only show and change the session in effect. Each is a form in a source
// of its own.
#pragma once

namespace palpate::viewer {

class Effect;
class Form;
class LevelChart;

/// Switches for forces, freeze and clutch, the force against its limit, and the contact.
Form* session_section(Effect& effect);

/// How contact feels: a row for each number in the tables of force and friction. The sliders end at
/// what the device can render.
Form* force_section(Effect& effect);

/// Whether surfaces give way, past which threshold, and the ranges of levels that are felt. These
/// are bands on the chart, too, which the section does not own. Object names: penetrability,
/// threshold, add_range, and of the ranges, from N = 1, range_N_low, range_N_high, range_N_remove.
Form* penetrability_section(Effect& effect, LevelChart& chart);

}  // namespace palpate::viewer

// Stage 4, edit: changes to samples as values, and what the samples are after one. Copy on write:
// only the bricks that an edit touches are made anew, whoever looks at the version before goes on
// doing so. Not for the servo thread. See docs/living_data.md.
#pragma once

#include <variant>

#include "palpate/field.hpp"

namespace palpate {

enum class BrushKind : std::uint8_t {
    carve,   ///< takes solid away: no sample becomes more solid
    add,     ///< puts solid on: no sample becomes less solid
    smooth,  ///< blurs (3 x 3 x 3 binomial)
    paint,   ///< brings samples to a value, up or down
};
/// "carve", "add", "smooth" or "paint".
std::string_view name_of(BrushKind kind);
/// The inverse; throws std::invalid_argument with the accepted names.
BrushKind brush_kind_from(std::string_view name);

/// A round brush. Its effect falls from whole to none over an edge about `radius`, where half of it
/// is left.
struct Brush {
    BrushKind kind = BrushKind::carve;
    double radius = 3;  ///< [mm, physical] > 0
    /// 1: the edge is as narrow as the grid can show without steps, two voxels; 0: as wide as the
    /// brush.
    double hardness = 1;
    /// How much of the way to its aim one touch brings a sample, above 0 to 1. A tool that works at
    /// a rate r [1/s] has 1 - exp(-r dt) for a touch of dt. Integer samples go at least one unit
    /// where it would be a sixteenth (but for smooth), so faint touches do not stand still.
    double strength = 1;
    /// carve, add: the level whose surface the brush shapes [data units]: it comes to lie at
    /// `radius`, as smooth as the grid can show.
    double level = 0;
    Solid solid = Solid::above;  ///< carve, add: which side of `level` is solid
    /// What a whole touch leaves [data units]. carve: on the free side of `level`, the background
    /// say; add: on its solid side; paint: any; smooth: no matter.
    double value = 0;
};

namespace edit {
/// A brush swept along a straight line, without gaps however fast: a spherical burr.
struct Stroke {
    Brush brush;
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< [mm, physical]
};
/// One value for all samples of a box.
struct Fill {
    SampleBox box;
    double value = 0;  ///< [data units]
};
/// Samples from elsewhere, of any type, put in place with their first one at `at`; their geometry
/// is not looked at but for its size. What an application simulates comes in by this.
struct Replace {
    Index3 at = Index3::Zero();
    Volume samples;
};
}  // namespace edit
/// All are cut at the border of the grid.
using Edit = std::variant<edit::Stroke, edit::Fill, edit::Replace>;

/// Samples after an edit, and the box of those that it changed.
struct Edited {
    std::shared_ptr<const Samples> samples;  ///< the same as before if nothing changed
    SampleBox changed;
};

/// Throws std::invalid_argument, saying what is wrong, for an edit that cannot be made: numbers out
/// of range or not finite, or samples that are a sequence (take one frame of it).
void check(const Edit& edit, const Samples& samples);
/// The samples after an edit; values beyond the sample type's are cut to it. The same input gives
/// the same bits. Throws as check().
Edited edited(const std::shared_ptr<const Samples>& samples, const Edit& edit);

/// A brush that carves at the level felt down to the field's background, or adds as much above the
/// level as the background lies below it.
Brush brush_for(BrushKind kind, const Field& field, double isovalue, double radius);

}  // namespace palpate

// Stage 4, edit: changes to samples as values, the samples that result, and an editor that applies
// them with undo and redo. Copy on write: an edit copies only the bricks it touches, and the
// previous version stays valid for its readers. Not for the servo thread. See
// docs/changing_data.md.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/field.hpp"
#include "palpate/names.hpp"
#include "palpate/progress.hpp"
#include "palpate/tool.hpp"

namespace palpate {

/// Named in names.hpp.
enum class BrushKind : std::uint8_t {
    carve,   ///< removes solid: no sample becomes more solid
    add,     ///< adds solid: no sample becomes less solid
    smooth,  ///< blurs (3 x 3 x 3 binomial)
    paint,   ///< moves samples to a value, up or down
};

/// A brush, round or with a tool's own shape. Its effect falls from full to none across an edge,
/// and is half at `radius`.
struct Brush {
    BrushKind kind = BrushKind::carve;
    /// [mm, physical] > 0. With a tool's shape: how far the brush works beyond the tool's surface.
    double radius = 3;
    /// 1: the edge is two voxels wide, the narrowest edge without steps on the grid. 0: as wide as
    /// the brush.
    double hardness = 1;
    /// The fraction of the difference to its target by which one touch changes a sample, above 0 to
    /// 1. A tool with a rate r [1/s] uses 1 - exp(-r dt) for a touch of dt. Except with smooth, an
    /// integer sample that should change by a sixteenth of a unit or more changes by at least one
    /// unit, so that weak touches have an effect.
    double strength = 1;
    /// carve, add: the level whose surface the brush shapes [data units]. The new surface is at
    /// `radius`, as smooth as the grid allows.
    double level = 0;
    Solid solid = Solid::above;  ///< carve, add: which side of `level` is solid
    /// The value that a full touch leaves [data units]. carve: on the free side of `level`, for
    /// example the background; add: on its solid side; paint: any; smooth: not used.
    double value = 0;
};
template <>
inline constexpr auto settings_of<Brush> = std::tuple{
    setting(&Brush::kind, "kind", "", "'carve', 'add', 'smooth' or 'paint'"),
    setting(&Brush::radius, "radius", "mm, physical",
            "Distance at which half of the effect is left")
        .titled("radius of the brush")
        .within(ranges::positive),
    setting(&Brush::hardness, "hardness", "", "1: an edge two voxels wide; 0: as wide as the brush")
        .titled("hardness of the brush")
        .within(ranges::part),
    setting(&Brush::strength, "strength", "", "Part of the way to its target that one touch goes")
        .titled("strength of the brush")
        .within({0, 1, true, "above 0 and at most 1"}),
    setting(&Brush::level, "level", "data units", "carve, add: the level whose surface it shapes")
        .titled("level of the brush")
        .within(ranges::finite),
    setting(&Brush::solid, "solid", "", "'above' or 'below' that level"),
    setting(&Brush::value, "value", "data units", "Value that a full touch leaves")
        .titled("value of the brush")
        .within(ranges::finite)};

namespace edit {
/// A brush swept along a straight line without gaps, like a spherical burr.
struct Stroke {
    Brush brush;
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< [mm, physical]
};
/// A brush with a tool's own shape, swept between two poses without gaps: it moves straight and
/// turns evenly, by the smaller angle. The body has to know distances as far as the brush works
/// (reach_of()).
struct Sweep {
    Brush brush;
    std::shared_ptr<const ToolBody> body;  ///< not null
    Pose from, to;
};
/// Sets all samples of a box to one value.
struct Fill {
    SampleBox box;
    /// [data units] Rounded for whole numbers, and clamped to the sample type.
    double value = 0;
};
/// Replaces a box of the grid by the samples of another volume, of any type, the first one at `at`.
/// Only the size of that volume's geometry counts. Applications can insert simulated data with
/// this.
struct Replace {
    Index3 at = Index3::Zero();
    Volume samples;
};
}  // namespace edit
/// All are clipped at the border of the grid.
using Edit = std::variant<edit::Stroke, edit::Sweep, edit::Fill, edit::Replace>;

/// The largest distance from the surface of a body, outside or inside, at which such a brush has an
/// effect on this grid [mm].
double reach_of(const Brush& brush, const Geometry& geometry);
/// The body of a tool, fine and wide enough for sweeps of this brush on this grid. Throws
/// std::invalid_argument as ToolBody does.
ToolBody body_for(const Brush& brush, const Geometry& geometry, std::shared_ptr<const Tool> tool);

/// The samples after an edit, and the box of samples that it changed.
struct Edited {
    std::shared_ptr<const Samples> samples;  ///< the same as before if nothing changed
    SampleBox changed;
};

/// Reads a box of a grid that is not wholly in memory, both corners included, as before all edits:
/// samples of the volume's type, x fastest. May wait, and may throw anything.
using ReadSamples = std::function<void(const SampleBox& box, std::span<std::byte> out)>;

/// Throws std::invalid_argument, with the reason, for an impossible edit: numbers out of range or
/// not finite, or samples that are a sequence (edit one frame of it instead).
void check(const Edit& edit, const Samples& samples);
/// Throws std::invalid_argument for a value that would be clamped. For values that a person enters.
void check(const edit::Fill& fill, SampleType type);
/// The samples after an edit. Values outside the sample type's range are clamped. The same input
/// gives the same bits. For a large grid, `read` gives the samples of the bricks that are edited
/// for the first time, in memory or not. Throws as check() does, for a large grid without `read`,
/// and whatever `read` and `progress` throw.
Edited edited(const std::shared_ptr<const Samples>& samples, const Edit& edit,
              const ReadSamples& read = {}, const OnProgress& progress = {});

/// A brush with a value that fits the level: carving leaves the field's background, adding and
/// painting leave a value as far above the level as the background lies below it.
Brush brush_for(BrushKind kind, const Field& field, double isovalue, double radius);

/// Whether an edit is a new step for undo(), or part of the last one (a stroke of a brush is many
/// edits).
enum class EditStep : std::uint8_t { own, same };

/// Applies edits to samples. Each step keeps its version of them, and versions share all bricks
/// that did not change. One thread at a time.
class Editor {
  public:
    using Versions = std::vector<std::shared_ptr<const Samples>>;

    /// Keeps at most `history_bytes` of samples for undo() and redo(). The oldest steps are dropped
    /// first. `read` is for large grids, see edited().
    explicit Editor(std::shared_ptr<const Samples> samples,
                    std::size_t history_bytes = std::size_t{512} << 20, ReadSamples read = {});

    /// The current version.
    const std::shared_ptr<const Samples>& samples() const { return samples_; }
    /// Applies an edit and returns the box of samples that changed. Throws as edited() does, and
    /// has then changed nothing.
    SampleBox apply(const Edit& edit, EditStep step = EditStep::own,
                    const OnProgress& progress = {});
    /// The same for an edit of samples(), computed with edited(). Versions that undo() and redo()
    /// no longer lead to are added to `dropped`, if it is given, for a caller that frees them
    /// later.
    SampleBox take(Edited result, EditStep step = EditStep::own, Versions* dropped = nullptr);
    /// Undoes the last step, or redoes the step undone last. Returns the box of samples that
    /// changed. It is empty if there is no such step.
    SampleBox undo();
    SampleBox redo();
    std::size_t undo_steps() const { return undone_from_; }
    std::size_t redo_steps() const { return steps_.size() - undone_from_; }
    /// Bytes that undo() and redo() hold beyond the current version.
    std::size_t history_bytes() const;
    /// True if the current version is not the saved one. At the start the first version is saved.
    bool changed() const { return samples_ != saved_; }
    /// Marks the current version as saved. Returns the one that was before.
    std::shared_ptr<const Samples> set_saved() { return std::exchange(saved_, samples_); }

  private:
    struct Step {
        std::shared_ptr<const Samples> before, after;
        SampleBox box;
        std::size_t bytes = 0;
    };
    void drop(std::size_t first, std::size_t end, Versions* dropped);
    void forget(Versions* dropped);

    std::shared_ptr<const Samples> samples_, saved_;
    std::deque<Step> steps_;  // in order, of which those from undone_from_ on are undone
    std::size_t undone_from_ = 0;
    bool begun_ = false;  // a new step has begun, and changed nothing so far
    std::size_t most_bytes_;
    ReadSamples read_;
};

}  // namespace palpate

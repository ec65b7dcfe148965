// The surface of one level of a field, extracted in the background and kept at the newest. A finer
// part of it replaces it where the data are an overview of a store (docs/viewer_internals.md). Also
// surfaces of labels.
#pragma once

#include <QObject>

#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "apps/viewer/model/detail_choice.hpp"
#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/scene/surface_extractor.hpp"

namespace palpate::viewer {

/// A box of whole cells of the overview; on a side where the data end it has no end.
struct PatchBounds {
    Geometry grid;  ///< of the overview
    /// Planes between cells, in its index space; infinite: none.
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();

    bool operator==(const PatchBounds&) const = default;
    bool has(const Vec3& index) const {
        return (index.array() >= low.array()).all() && (index.array() <= high.array()).all();
    }
};

/// The finer part: its samples reach at least two beyond the bounds, and come to be those of the
/// overview's field there (model/patch_samples.hpp).
struct ScenePatch {
    std::shared_ptr<const DetailField> detail;
    PatchBounds bounds;
};

/// Puts the two together. What did not change stays the same, block by block.
class PatchedSurface {
  public:
    /// Of the whole surface the triangles outside, each of which lies in one cell; of the finer one
    /// those that reach in.
    ExtractedSurface of(const ExtractedSurface& whole, const ExtractedSurface& finer,
                        const PatchBounds& bounds);

  private:
    using Mesh = std::shared_ptr<const RenderMesh>;
    enum class Keep : std::uint8_t { outside, not_inside, reaching_in };
    struct Cut {
        Mesh from, to;
    };
    Mesh cut(const Mesh& mesh, Keep keep);

    PatchBounds bounds_;
    ExtractedSurface whole_, finer_, both_;                          // as they were last time
    std::map<std::pair<const RenderMesh*, Keep>, Cut> cuts_, used_;  // of last time, of this time
};

/// Belongs to the window's thread.
class SurfaceSource : public QObject {
    Q_OBJECT
  public:
    explicit SurfaceSource(const SurfaceLimits& limits = {});

    /// Other data, without a patch: the surface is empty until there is a new one.
    void set_field(const Field& field, double level);
    /// Another version of the data; these samples have changed.
    void update_field(const Field& field, const SampleBox& changed);
    /// A finer part of the data; what was shown stays until its surface is there. Nothing: none.
    void set_patch(const std::optional<ScenePatch>& patch);
    /// Extracted again, coarse first; the newest level wins. Without a field it does nothing.
    void set_level(double level);
    void clear();
    /// From the next surface on.
    void set_most_triangles(std::size_t triangles) { extractor_.set_most_triangles(triangles); }

    double level() const { return level_; }
    /// Of the newest level that is there: one that is dragged is seen to move.
    const ExtractedSurface& surface() const { return surface_; }
    bool extracting() const { return extracting_ || (finer_ && finer_->extracting()); }
    /// The surface of the whole data is still being made.
    bool extracting_whole() const { return extracting_; }

  Q_SIGNALS:
    /// surface() is another one.
    void made();
    /// That of the whole data is as fine as it will be, not after an update alone.
    void finished();
    void problem(const QString& what);

  private:
    void take(ExtractedSurface surface);
    void take_finer();
    void drop_patch();
    void put_together();

    SurfaceLimits limits_;
    std::optional<Field> field_;
    ExtractedSurface whole_, surface_;  // the latter with the finer part
    double level_ = std::nan("");
    std::uint64_t request_ = 0, oldest_ = 1;  // the last one; the first one of these data
    bool extracting_ = false;
    bool asked_ = false;  // not by an update
    SurfaceExtractor extractor_;

    std::unique_ptr<SurfaceSource> finer_;  // from the first patch on: it has a thread
    std::optional<ScenePatch> patch_;       // whose surface is made
    struct Finer {
        PatchBounds bounds;
        ExtractedSurface surface;
    };
    std::optional<Finer> shown_;
    PatchedSurface both_;
};

/// One for each label, as smooth as its mask allows; positions from the middle of the overlay's
/// grid. `progress` may throw to stop.
std::vector<ExtractedSurface> label_surfaces(const Overlay& overlay,
                                             const std::function<void(double part)>& progress);

}  // namespace palpate::viewer

// The surface of one level: of the whole data, and of a finer part of them in its place.
#pragma once

#include <QObject>

#include <memory>
#include <optional>

#include "apps/viewer/scene/surface_patch.hpp"
#include "apps/viewer/scene/surface_source.hpp"

namespace palpate::viewer {

/// As SurfaceSource, of which it has two. Belongs to the window's thread.
class PatchedSource : public QObject {
    Q_OBJECT
  public:
    explicit PatchedSource(const SurfaceLimits& limits = {});

    /// Other data, without a patch.
    void set_field(const Field& field, double level);
    void update_field(const Field& field, const SampleBox& changed);
    /// A finer part of the data; what was shown stays until its surface is there. Nothing: none.
    void set_patch(const std::optional<ScenePatch>& patch);
    void set_level(double level);
    void clear();
    void set_most_triangles(std::size_t triangles) { whole_.set_most_triangles(triangles); }

    double level() const { return whole_.level(); }
    const ExtractedSurface& surface() const { return surface_; }
    bool extracting() const { return whole_.extracting() || (finer_ && finer_->extracting()); }
    /// The surface of the whole data is still being made.
    bool extracting_whole() const { return whole_.extracting(); }

  Q_SIGNALS:
    /// surface() is another one.
    void made();
    /// As SurfaceSource, of the whole.
    void finished();
    void problem(const QString& what);

  private:
    void make_source();
    void take_finer();
    void put_together();

    SurfaceLimits limits_;
    SurfaceSource whole_;
    std::unique_ptr<SurfaceSource> finer_;  // from the first patch on: it has a thread
    std::optional<ScenePatch> patch_;       // whose surface is made
    /// What is shown of a patch.
    struct Finer {
        PatchBounds bounds;
        ExtractedSurface surface;
    };
    std::optional<Finer> shown_;
    PatchedSurface both_;
    ExtractedSurface surface_;
};

}  // namespace palpate::viewer

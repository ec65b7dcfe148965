// The surface of one level of a field, extracted in the background and kept at the newest.
#pragma once

#include <QObject>

#include <cmath>
#include <optional>

#include "apps/viewer/scene/surface_extractor.hpp"

namespace palpate::viewer {

/// Belongs to the window's thread.
class SurfaceSource : public QObject {
    Q_OBJECT
  public:
    explicit SurfaceSource(const SurfaceLimits& limits = {});

    /// Other data: the surface is empty until there is a new one.
    void set_field(const Field& field, double level);
    /// Another version of the data; these samples have changed.
    void update_field(const Field& field, const SampleBox& changed);
    /// Extracted again, coarse first; the newest level wins. Without a field it does nothing.
    void set_level(double level);
    void clear();
    /// From the next surface on.
    void set_most_triangles(std::size_t triangles) { extractor_.set_most_triangles(triangles); }

    /// As SurfaceExtractor::set_origin().
    void set_origin(const Vec3& origin) { extractor_.set_origin(origin); }

    double level() const { return level_; }
    /// Of the newest level that is there: one that is dragged is seen to move.
    const ExtractedSurface& surface() const { return surface_; }
    bool extracting() const { return extracting_; }

  Q_SIGNALS:
    /// surface() is another one.
    void made();
    /// surface() is as fine as it will be, not after an update alone.
    void finished();
    void problem(const QString& what);

  private:
    void take(ExtractedSurface surface);

    std::optional<Field> field_;
    ExtractedSurface surface_;
    double level_ = std::nan("");
    std::uint64_t request_ = 0, oldest_ = 1;  // the last one; the first one of these data
    bool extracting_ = false;
    bool asked_ = false;  // not by an update
    SurfaceExtractor extractor_;
};

}  // namespace palpate::viewer

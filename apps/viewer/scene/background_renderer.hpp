// Lets painters render the static part of the scene, and keeps the newest image. No
// widget: input and display are in scene.hpp.
#pragma once

#include <QObject>
#include <QTimer>

#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/detail.hpp"
#include "apps/viewer/scene/render_request.hpp"
#include "apps/viewer/scene/surface_maker.hpp"

namespace palpate::viewer {

/// A finer part of the data: its samples reach at least two beyond the bounds, and come to be those
/// of the overview's field there (joined_samples()).
struct ScenePatch {
    std::shared_ptr<const DetailField> detail;
    PatchBounds bounds;
};

/// Belongs to the window's thread. Two painters: one for quick images, and one for fine
/// images, which may take long and are cancelled when something changes.
class BackgroundRenderer : public QObject {
    Q_OBJECT
  public:
    explicit BackgroundRenderer(MakePainter make_painter);
    ~BackgroundRenderer() override;

    void set_field(const Field& field, double isovalue);
    /// As Scene::update_field().
    void update_field(const Field& field);
    /// As Scene::set_patch().
    void set_patch(const std::optional<ScenePatch>& patch);
    void clear();
    void set_isovalue(double isovalue);
    void set_most_triangles(std::size_t triangles) { whole_.set_most_triangles(triangles); }
    /// Surfaces that do not depend on the field, drawn with it. The same again draw nothing anew.
    void set_overlay(std::vector<DrawnSurface> surfaces);
    /// Draws this, with the number, field and surfaces that are kept here, if it differs from the
    /// last request.
    void request(const RenderRequest& request);

    const std::optional<Field>& field() const { return request_.field; }
    /// Null before the first.
    const std::shared_ptr<const RenderedImage>& shown() const { return shown_; }
    bool settled() const;
    /// The fine picture of the newest camera is there, of the surfaces of the whole data at least.
    bool shows_whole() const;
    double frame_seconds() const { return frame_seconds_; }

  Q_SIGNALS:
    /// shown() is another one.
    void painted();
    void surface_ready(double isovalue, double seconds);
    void problem(const QString& what);

  private:
    void make_painters();
    std::vector<double> levels() const;
    void collect_surfaces();
    void paint();
    void take(RenderedImage image);
    void observe_speed(const RenderedImage& image);

    MakePainter make_painter_;
    RenderRequest request_;
    std::shared_ptr<const RenderedImage> shown_;
    std::optional<ScenePatch> patch_;
    double isovalue_ = 0;
    bool announce_ = false;  // the felt surface was asked for, not by a version of the data
    bool edited_ = false;    // since the camera moved
    double frame_seconds_ = 0;
    int slow_pictures_ = 0;  // in succession
    bool broken_ = false;    // no painter can draw
    QTimer rest_;
    SurfaceMaker whole_, finer_;  // of all data, of the patch; the felt level first
    std::vector<DrawnSurface> overlay_;
    std::unique_ptr<Painter> quick_, fine_;
};

}  // namespace palpate::viewer

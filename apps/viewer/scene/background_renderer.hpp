// Renders the static part of the scene on threads of its own, and keeps the newest image. No
// widget: input and display are in scene.hpp.
#pragma once

#include <QObject>
#include <QTimer>

#include <memory>
#include <optional>

#include "apps/viewer/scene/render_request.hpp"
#include "apps/viewer/scene/render_thread.hpp"
#include "apps/viewer/scene/surface_extractor.hpp"

namespace palpate::viewer {

/// Belongs to the window's thread. Two render threads: one for quick images, and one for fine
/// images, which may take long and are cancelled when something changes.
class BackgroundRenderer : public QObject {
    Q_OBJECT
  public:
    BackgroundRenderer();
    ~BackgroundRenderer() override;

    void set_field(const Field& field, double isovalue);
    /// As Scene::update_field().
    void update_field(const Field& field, const std::optional<SampleBox>& changed);
    void clear();
    void set_isovalue(double isovalue);
    /// Draws this, with the number, field and surface that are kept here, if it differs from the
    /// last request.
    void request(const RenderRequest& request);

    const std::optional<Field>& field() const { return request_.field; }
    /// Null before the first.
    const std::shared_ptr<const RenderedImage>& shown() const { return shown_; }
    bool settled() const;
    double frame_seconds() const { return frame_seconds_; }

  Q_SIGNALS:
    /// shown() is another one.
    void painted();
    void surface_ready(double isovalue, double seconds);
    void problem(const QString& what);

  private:
    void start_threads();
    void paint();
    void take(RenderedImage image);
    void take(ExtractedSurface surface);

    RenderRequest request_;
    std::shared_ptr<const RenderedImage> shown_;
    std::uint64_t surface_request_ = 0, oldest_surface_request_ = 1;
    bool extracting_ = false;
    bool asked_ = false, announce_ = false;  // not by an update
    double isovalue_ = 0;
    double frame_seconds_ = 0;
    bool broken_ = false;  // no render thread can draw
    QTimer rest_;
    SurfaceExtractor extractor_;
    std::unique_ptr<RenderThread> quick_, fine_;
};

}  // namespace palpate::viewer

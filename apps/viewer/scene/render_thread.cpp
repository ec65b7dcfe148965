// Draws render requests with VTK on a thread, in an OpenGL context of its own, so that the window
// never waits for an image. Keeps the actors in step with the request, draws them and reads the
// image back.
#include "apps/viewer/scene/render_request.hpp"

#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkPlaneCollection.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkVolumeMapper.h>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFunctions>
#include <QThread>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/scene/actors.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/layer_prop.hpp"
#include "apps/viewer/scene/surface_blocks.hpp"
#include "apps/viewer/scene/threads.hpp"
#include "apps/viewer/scene/view_space.hpp"
#include "pictures/vtk/material.hpp"
#include "pictures/vtk/offscreen.hpp"
#include "pictures/vtk/props.hpp"

namespace palpate::viewer {
namespace {

void check_abort(vtkObject* window, unsigned long, void* give_up, void*) {
    if (*static_cast<const std::atomic<bool>*>(give_up)) {
        static_cast<vtkRenderWindow*>(window)->SetAbortRender(1);
    }
}

/// VTK 9.1 takes the aspect ratio as known if the numbers it was computed from are those of the
/// last time, which are not initialised: a renderer in the memory of an older one may keep 1, and a
/// volume is drawn too wide.
void renew_aspect(vtkRenderer& renderer) {
    renderer.SetPixelAspect(2, 1);
    renderer.ComputeAspect();
    renderer.SetPixelAspect(1, 1);
    renderer.ComputeAspect();
}

constexpr std::int64_t moving_samples = 128 * 128 * 144;
constexpr std::int64_t most_samples = 512LL * 512 * 640;  // with what VTK keeps beside, 1 GB
// Slower than the one, moving pictures have half the pixels a side; quicker than the other, all.
constexpr double slow_seconds = 0.065, fast_seconds = 0.012;
constexpr double moving_seconds = 0.06;  // what a moving picture of a volume may take

/// In an invisible window in the current OpenGL context. Belongs to one thread, as that context
/// does.
class OffscreenRenderer {
  public:
    /// While `give_up` is true, drawing ends as soon as it can; must outlive the renderer.
    /// `hardware`: OpenGL here is the machine's graphics hardware.
    OffscreenRenderer(const std::atomic<bool>& give_up, bool hardware);
    ~OffscreenRenderer();

    /// Returns nothing if it was cancelled. Throws std::runtime_error if OpenGL fails.
    std::optional<RenderedImage> draw(const RenderRequest& request);

  private:
    void show(const RenderRequest& request);
    void show_surfaces(const RenderRequest& request);
    void dress(const SurfacePart& part, const DrawnSurface& surface);
    void drop(const std::vector<vtkSmartPointer<vtkActor>>& actors);
    pictures::Layer glass_layer(const RenderRequest& request, const pictures::Layer& solid);
    void show_slices(const RenderRequest& request);
    void show_box(const RenderRequest& request);
    void show_volume(const RenderRequest& request);
    const Volume& volume_of(const Field& field, bool coarse);
    pictures::Layer layer_of(vtkRenderer& renderer);

    const std::atomic<bool>& give_up_;
    vtkSmartPointer<vtkGenericOpenGLRenderWindow> window_;
    vtkSmartPointer<vtkRenderer> solid_, glass_;
    bool hardware_;

    vtkSmartPointer<vtkPlaneCollection> cut_;
    struct Surface {
        SurfacePart whole, finer;  // the one without what the other is shown for
    };
    std::vector<Surface> surfaces_;  // as in the request
    std::optional<Field> sliced_;    // what the slices show
    Vec3 crosshair_ = Vec3::Zero();
    std::array<vtkSmartPointer<vtkProp>, 3> slices_;
    std::optional<std::pair<Geometry, int>> boxed_;  // its grid, and how far beyond
    vtkSmartPointer<vtkActor> box_;
    std::unique_ptr<VolumePart> volume_;
    /// A volume in one piece, and what of.
    struct Cast {
        Field field;
        int every;
        Volume volume;
    };
    std::optional<Cast> cast_;
    bool cast_coarse_ = false;  // another one is to come, even where pictures are not quick ones
    int pixel_ = 1;  // of a moving picture, in pixels of the request: 1, or 2 where that is slow
    double coarseness_ = 3;  // pixels a ray while moving, as quick as it turned out
};

OffscreenRenderer::OffscreenRenderer(const std::atomic<bool>& give_up, bool hardware)
    : give_up_(give_up),
      window_(pictures::offscreen_window()),
      solid_(vtkSmartPointer<vtkRenderer>::New()),
      glass_(vtkSmartPointer<vtkRenderer>::New()),
      hardware_(hardware),
      cut_(vtkSmartPointer<vtkPlaneCollection>::New()) {
    glass_->SetBackground(0, 0, 0);
    glass_->SetBackgroundAlpha(0);
    glass_->SetActiveCamera(solid_->GetActiveCamera());
    pictures::keep_alpha(*glass_, *window_);
    for (vtkRenderer* renderer : {solid_.Get(), glass_.Get()}) pictures::light(*renderer);
    vtkNew<vtkCallbackCommand> abort;
    abort->SetCallback(check_abort);
    abort->SetClientData(const_cast<std::atomic<bool>*>(&give_up_));
    window_->AddObserver(vtkCommand::AbortCheckEvent, abort);
}

OffscreenRenderer::~OffscreenRenderer() {
    window_->Finalize();
}

void OffscreenRenderer::drop(const std::vector<vtkSmartPointer<vtkActor>>& actors) {
    for (const auto& gone : actors) {
        solid_->RemoveActor(gone);
        glass_->RemoveActor(gone);
        gone->ReleaseGraphicsResources(window_);
    }
}

void OffscreenRenderer::show_surfaces(const RenderRequest& request) {
    const bool quick = request.moving && !hardware_;
    while (surfaces_.size() > request.surfaces.size()) {
        drop(surfaces_.back().whole.show({}));
        drop(surfaces_.back().finer.show({}));
        surfaces_.pop_back();
    }
    while (surfaces_.size() < request.surfaces.size()) {
        const SurfacePart none(give_up_, hardware_, cut_);
        surfaces_.push_back({none, none});
    }
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
        const DrawnSurface& surface = request.surfaces[i];
        const ExtractedSurface &whole = surface.surface, &finer = surface.finer;
        auto& [coarse_part, finer_part] = surfaces_[i];
        // Coarse cells do not end with the part: the two overlap a little while things move.
        drop(coarse_part.show(quick ? whole.moving : whole.blocks, finer.part,
                              quick ? Keep::reaching_out : Keep::outside));
        drop(finer_part.show(quick ? finer.moving : finer.blocks, finer.part, Keep::reaching_in));
        dress(coarse_part, surface);
        dress(finer_part, surface);
    }
}

void OffscreenRenderer::dress(const SurfacePart& part, const DrawnSurface& surface) {
    const double opacity = std::clamp(surface.opacity, 0.0, 1.0);
    vtkRenderer& in = opacity < 1 ? *glass_ : *solid_;
    vtkRenderer& out = opacity < 1 ? *solid_ : *glass_;
    for (const auto& one : part.actors()) {
        vtkActor* const actor = one.actor;
        if (!actor) continue;
        const Colour& c = surface.colour;
        actor->GetProperty()->SetColor(c.red, c.green, c.blue);
        actor->SetVisibility(opacity > 0);
        actor->SetPosition(Vec3(surface.offset).data());
        if (actor->GetProperty()->GetOpacity() == opacity && in.HasViewProp(actor)) continue;
        pictures::set_glass(*actor, opacity);
        out.RemoveActor(actor);
        in.AddActor(actor);
    }
}

/// Each translucent surface is drawn alone, its nearest part, and these are put over each other
/// where the solid does not hide them.
pictures::Layer OffscreenRenderer::glass_layer(const RenderRequest& request,
                                               const pictures::Layer& solid) {
    const auto is_glass = [](const DrawnSurface& s) { return s.opacity > 0 && s.opacity < 1; };
    const auto set_visible = [&](std::size_t i, bool visible) {
        for (const SurfacePart* part : {&surfaces_[i].whole, &surfaces_[i].finer}) {
            for (const auto& one : part->actors()) {
                if (one.actor) one.actor->SetVisibility(visible);
            }
        }
    };
    std::vector<pictures::Layer> layers;
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
        if (is_glass(request.surfaces[i])) set_visible(i, false);
    }
    for (std::size_t i = 0; i < surfaces_.size() && !give_up_; ++i) {
        if (!is_glass(request.surfaces[i])) continue;
        set_visible(i, true);
        layers.push_back(layer_of(*glass_));
        set_visible(i, false);
    }
    if (give_up_) return {};
    return composed(std::move(layers), solid);
}

void OffscreenRenderer::show_slices(const RenderRequest& request) {
    const bool outdated =
        !sliced_ || !same_samples(*sliced_, *request.field) || crosshair_ != request.crosshair;
    if (slices_[0] && (outdated || !request.look.slices)) {
        for (auto& slice : slices_) {
            solid_->RemoveActor(slice);
            slice->ReleaseGraphicsResources(window_);
            slice = nullptr;
        }
        sliced_.reset();
    }
    if (!request.look.slices || slices_[0]) return;
    slices_ = slice_actors(*request.field, request.crosshair);
    sliced_ = request.field;
    crosshair_ = request.crosshair;
    for (const auto& slice : slices_) solid_->AddActor(slice);
}

void OffscreenRenderer::show_box(const RenderRequest& request) {
    // All surfaces lie inside, also those of bodies that the grid's end cuts.
    const Field& field = *request.field;
    const std::pair outline(field.geometry(), closing_samples(field.interpolation()));
    if (boxed_ != outline) {
        if (box_) solid_->RemoveActor(box_);
        boxed_ = outline;
        box_ = box_actor(outline.first, outline.second);
        solid_->AddActor(box_);
    }
    box_->SetVisibility(request.look.box);
    box_->GetProperty()->SetColor(request.ink.red, request.ink.green, request.ink.blue);
    box_->GetProperty()->SetOpacity(1);
    box_->GetProperty()->SetLineWidth(static_cast<float>(std::round(request.pixel_ratio)));
}

/// Samples that change are put in one piece: few of them for moving pictures, all once they rest.
const Volume& OffscreenRenderer::volume_of(const Field& field, bool coarse) {
    const auto samples = static_cast<double>(sample_count(field.geometry()));
    const auto limit = static_cast<double>(coarse ? moving_samples : most_samples);
    const int every = samples > limit ? static_cast<int>(std::ceil(std::cbrt(samples / limit))) : 1;
    if (!cast_ || cast_->every != every || !same_samples(cast_->field, field)) {
        cast_.reset();
        cast_.emplace(Cast{field, every,
                           every > 1 ? coarse_volume(field, every, 0)
                                     : flattened(field.samples(), field.moment())});
    }
    return cast_->volume;
}

void OffscreenRenderer::show_volume(const RenderRequest& request) {
    const bool wanted = request.look.volume && request.look.transfer.points.size() > 1;
    const auto remove = [&] {
        if (!volume_) return;
        solid_->RemoveVolume(volume_->prop());
        volume_->prop()->ReleaseGraphicsResources(window_);
        volume_.reset();
    };
    cast_coarse_ = false;
    if (!wanted) {
        remove();
        cast_.reset();
        return;
    }
    const Field& field = *request.field;
    const bool copied = field.samples().bricks() || field.moment().weight > 0;
    const bool coarse = request.moving && !hardware_;
    cast_coarse_ = request.moving && hardware_ && copied;
    const Volume& volume = volume_of(field, coarse || cast_coarse_);
    if (volume_ && !volume_->shows(volume)) remove();
    if (!volume_) {
        volume_ =
            std::make_unique<VolumePart>(volume, physical_centre(field.geometry()), hardware_);
        volume_->prop()->GetMapper()->SetClippingPlanes(cut_);
        solid_->AddVolume(volume_->prop());
    }
    volume_->set_look(request.look, field.geometry().spacing.minCoeff());
    const double spacing = volume.geometry().spacing.minCoeff();
    volume_->set_fineness(coarse ? coarseness_ * request.pixel_ratio / pixel_ : 1,
                          coarse ? spacing : 0.5 * spacing);
}

void OffscreenRenderer::show(const RenderRequest& request) {
    const Colour& b = request.background;
    solid_->SetBackground(b.red, b.green, b.blue);
    if (!request.field) {
        solid_->RemoveAllViewProps();
        glass_->RemoveAllViewProps();
        surfaces_.clear();
        slices_ = {};
        sliced_.reset();
        box_ = nullptr;
        boxed_.reset();
        volume_.reset();
        cast_.reset();
        return;
    }
    const Geometry& geometry = request.field->geometry();
    put_planes(*cut_, planes_of(request.look, geometry), physical_centre(geometry));
    show_surfaces(request);
    show_slices(request);
    show_box(request);
    show_volume(request);
    direct(*solid_->GetActiveCamera(), request.camera, physical_centre(geometry),
           reach_of(geometry));
}

/// Empty if it was cancelled.
pictures::Layer OffscreenRenderer::layer_of(vtkRenderer& renderer) {
    window_->AddRenderer(&renderer);
    renew_aspect(renderer);
    window_->SetAbortRender(0);
    window_->Render();
    pictures::Layer layer = give_up_ ? pictures::Layer{} : pictures::layer_of(*window_);
    window_->RemoveRenderer(&renderer);
    return layer;
}

std::optional<RenderedImage> OffscreenRenderer::draw(const RenderRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    const bool quick = request.moving && !hardware_;
    const int every = quick ? pixel_ : 1;
    RenderedImage image;
    image.width = (request.width + every - 1) / every;
    image.height = (request.height + every - 1) / every;
    window_->SetSize(image.width, image.height);
    // A volume is cast up to the depths that lie before it: those of whole pixels.
    const bool smooth = (hardware_ || !request.moving) && !request.look.volume;
    window_->SetMultiSamples(smooth ? 4 : 0);
    show(request);
    image.number = request.number;
    image.camera = request.camera;
    image.reach = request.field ? reach_of(request.field->geometry()) : 1;
    image.moving = quick || cast_coarse_;
    image.hardware = hardware_;
    image.solid = layer_of(*solid_);
    if (!give_up_ && request.field) {
        window_->SetMultiSamples(0);
        image.glass = glass_layer(request, image.solid);
    }
    if (give_up_) return std::nullopt;
    image.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (quick && image.seconds > slow_seconds) pixel_ = 2;
    if (quick && image.seconds < fast_seconds) pixel_ = 1;
    if (volume_ && quick) {
        const double wanted = coarseness_ * std::sqrt(image.seconds / moving_seconds);
        coarseness_ = std::clamp(0.5 * (coarseness_ + wanted), 2.0, 8.0);
    }
    return image;
}

}  // namespace

bool is_hardware(const std::string& name) {
    for (const char* software : {"llvmpipe", "softpipe", "swr", "SWR", "Software", "software"}) {
        if (name.find(software) != std::string::npos) return false;
    }
    return !name.empty();
}

namespace {

class RenderThread final : public Painter {
  public:
    RenderThread(Priority priority, Results results)
        : priority_(priority),
          results_(std::move(results)),
          surface_(std::make_unique<QOffscreenSurface>()),
          context_(std::make_unique<QOpenGLContext>()) {
        QSurfaceFormat format = QVTKOpenGLNativeWidget::defaultFormat();
        format.setSamples(0);
        surface_->setFormat(format);
        surface_->create();
        context_->setFormat(format);
        context_->create();
        thread_.reset(QThread::create([this] { run(); }));
        context_->moveToThread(thread_.get());
        thread_->start();
    }

    /// Cancels the present request and waits for the thread.
    ~RenderThread() override {
        give_up();
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        changed_.notify_all();
        thread_->wait();
    }

    void draw(RenderRequest request) override {
        {
            const std::lock_guard lock(mutex_);
            next_ = std::move(request);
        }
        changed_.notify_all();
    }

    void give_up() override {
        const std::lock_guard lock(mutex_);
        next_.reset();
        give_up_ = true;
    }

  private:
    void run() {
        if (priority_ == Priority::low) lower_thread_priority();
        if (!context_->makeCurrent(surface_.get())) {
            results_.failed("the 3-D view gets no OpenGL context");
            context_.reset();
            return;
        }
        try {
            const GLubyte* const name = context_->functions()->glGetString(GL_RENDERER);
            OffscreenRenderer renderer(give_up_,
                                       name && is_hardware(reinterpret_cast<const char*>(name)));
            for (;;) {
                RenderRequest request;
                {
                    std::unique_lock lock(mutex_);
                    changed_.wait(lock, [this] { return stopping_ || next_; });
                    if (stopping_) break;
                    request = std::move(*next_);
                    next_.reset();
                    give_up_ = false;
                }
                std::optional<RenderedImage> image = renderer.draw(request);
                if (image) results_.drawn(std::move(*image));
            }
        } catch (const std::exception& error) {
            results_.failed(error.what());
        }
        context_->doneCurrent();
        context_.reset();
    }

    Priority priority_;
    Results results_;
    std::unique_ptr<QOffscreenSurface> surface_;
    std::unique_ptr<QOpenGLContext> context_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<RenderRequest> next_;
    bool stopping_ = false;
    std::atomic<bool> give_up_{false};
    std::unique_ptr<QThread> thread_;
};

}  // namespace

std::unique_ptr<Painter> make_render_thread(Painter::Priority priority, Painter::Results results) {
    return std::make_unique<RenderThread>(priority, std::move(results));
}

}  // namespace palpate::viewer

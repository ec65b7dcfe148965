// Decides which render thread draws what, and which image is shown.
#include "apps/viewer/scene/background_renderer.hpp"

#include <QMetaObject>

#include <cmath>
#include <stdexcept>

#include "apps/viewer/model/sample_block.hpp"

namespace palpate::viewer {
namespace {

constexpr int rest_ms = 150;  // without a change: a fine picture

/// The part of the look that is rendered here; the window draws the rest over it.
Look rendered_part(Look look) {
    look.contact = look.tetrahedra = look.planes = look.orientation = look.scale_bar = false;
    if (!look.volume) {
        look.transfer = {};
        look.shading = look.maximum = false;
    }
    return look;
}

bool same_picture(const RenderRequest& a, const RenderRequest& b) {
    const bool slices = a.look.slices;
    return rendered_part(a.look) == rendered_part(b.look) &&
           (!slices || a.crosshair == b.crosshair) && a.background == b.background &&
           a.ink == b.ink && a.camera == b.camera && a.width == b.width && a.height == b.height &&
           a.pixel_ratio == b.pixel_ratio;
}

/// Calls `work` on the thread of `object`, unless that was destroyed before.
template <class Work>
void hand_over(QObject* object, Work work) {
    QMetaObject::invokeMethod(object, std::move(work), Qt::QueuedConnection);
}

}  // namespace

BackgroundRenderer::BackgroundRenderer()
    : extractor_({[this](ExtractedSurface surface) {
                      hand_over(this, [this, surface] { take(surface); });
                  },
                  [this](std::uint64_t request, const std::string& what) {
                      hand_over(this, [this, request, what] {
                          if (request != surface_request_) return;
                          extracting_ = false;
                          Q_EMIT problem(QString::fromStdString(what));
                      });
                  }}) {
    rest_.setSingleShot(true);
    rest_.setInterval(rest_ms);
    connect(&rest_, &QTimer::timeout, this, [this] {
        if (!fine_ || broken_) return;
        RenderRequest request = request_;
        request.moving = false;
        fine_->draw(std::move(request));
    });
}

BackgroundRenderer::~BackgroundRenderer() {
    // All are cancelled before the first is waited for.
    extractor_.forget();
    if (fine_) fine_->give_up();
    if (quick_) quick_->give_up();
}

void BackgroundRenderer::start_threads() {
    const RenderThread::Results results{
        [this](RenderedImage image) {
            auto shared = std::make_shared<RenderedImage>(std::move(image));
            hand_over(this, [this, shared] { take(std::move(*shared)); });
        },
        [this](const std::string& what) {
            hand_over(this, [this, what] {
                if (!broken_) Q_EMIT problem(QString::fromStdString(what));
                broken_ = true;
            });
        }};
    quick_ = std::make_unique<RenderThread>(RenderThread::Priority::normal, results);
    fine_ = std::make_unique<RenderThread>(RenderThread::Priority::low, results);
}

void BackgroundRenderer::paint() {
    ++request_.number;
    if (request_.width < 1 || request_.height < 1 || broken_) return;
    if (!quick_) start_threads();
    fine_->give_up();
    RenderRequest request = request_;
    request.moving = true;
    quick_->draw(std::move(request));
    rest_.start();
}

void BackgroundRenderer::request(const RenderRequest& request) {
    const bool first = request_.number == 0;
    if (!first && same_picture(request_, request)) return;
    RenderRequest next = request;
    next.number = request_.number;
    next.field = request_.field;
    next.surface = request_.surface;
    request_ = std::move(next);
    paint();
}

void BackgroundRenderer::set_field(const Field& field, double isovalue) {
    request_.field = field;
    request_.surface = {};
    oldest_surface_request_ = surface_request_ + 1;
    isovalue_ = std::nan("");
    set_isovalue(isovalue);
    paint();
}

void BackgroundRenderer::update_field(const Field& field, const std::optional<SampleBox>& changed) {
    if (!request_.field || request_.field->geometry() != field.geometry()) {
        throw std::invalid_argument("the scene shows no other version of these data");
    }
    const bool edited = same_but_for_edits(*request_.field, field);
    const SampleBox box = edited && changed ? *changed : changed_between(*request_.field, field);
    request_.field = field;
    if (box.empty()) return;
    if (std::isfinite(isovalue_)) {
        extracting_ = true;
        extractor_.update(++surface_request_, field, isovalue_, box);
    }
    if (request_.look.volume || request_.look.slices) paint();
}

void BackgroundRenderer::clear() {
    request_.field.reset();
    request_.surface = {};
    oldest_surface_request_ = surface_request_ + 1;
    extracting_ = false;
    extractor_.forget();
    paint();
}

void BackgroundRenderer::set_isovalue(double isovalue) {
    if (!request_.field || isovalue == isovalue_) return;
    isovalue_ = isovalue;
    extracting_ = asked_ = true;
    extractor_.ask(++surface_request_, *request_.field, isovalue);
}

void BackgroundRenderer::take(ExtractedSurface surface) {
    // Of an older request, too, while a newer one is not there: a level that is dragged is seen to
    // move. Never of other data.
    if (surface.request < oldest_surface_request_ || surface.request < request_.surface.request)
        return;
    if (surface.request == surface_request_ && surface.finished) {
        extracting_ = false;
        announce_ = announce_ || asked_;
        asked_ = false;
    }
    request_.surface = std::move(surface);
    paint();
}

void BackgroundRenderer::take(RenderedImage image) {
    const bool older = shown_ && image.number < shown_->number;
    const bool coarser = shown_ && image.number == shown_->number && !shown_->moving;
    if (older || (coarser && image.moving)) return;
    if (image.hardware && !image.moving && image.number == request_.number) rest_.stop();
    if (image.moving || image.hardware) {
        frame_seconds_ =
            frame_seconds_ > 0 ? 0.8 * frame_seconds_ + 0.2 * image.seconds : image.seconds;
    }
    shown_ = std::make_shared<const RenderedImage>(std::move(image));
    Q_EMIT painted();
    if (settled() && announce_) {
        announce_ = false;
        Q_EMIT surface_ready(request_.surface.isovalue, request_.surface.seconds);
    }
}

bool BackgroundRenderer::settled() const {
    if (broken_) return true;
    return shown_ && shown_->number == request_.number && !shown_->moving && !extracting_;
}

}  // namespace palpate::viewer

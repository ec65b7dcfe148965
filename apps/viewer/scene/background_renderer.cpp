// Decides which painter draws what, and which image is shown.
#include "apps/viewer/scene/background_renderer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/scene/threads.hpp"

namespace palpate::viewer {
namespace {

constexpr int rest_ms = 150;  // without a change: a fine picture

/// The part of the look that is rendered here; the window draws the rest over it.
Look rendered_part(Look look) {
    look.contact = look.tetrahedra = look.planes = look.orientation = look.scale_bar = false;
    // Of the slices beside the scene: those in it are grey, and an overlay's surfaces come with
    // set_overlay(), coloured already.
    look.colours = {};
    look.overlay = {};
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

/// Beside the felt one: several of them are in memory.
constexpr SurfaceLimits limits_of_others{2'000'000, 20'000};

}  // namespace

BackgroundRenderer::BackgroundRenderer(MakePainter make_painter)
    : make_painter_(std::move(make_painter)) {
    connect(&felt_, &SurfaceSource::made, this, &BackgroundRenderer::paint);
    connect(&felt_, &SurfaceSource::finished, this, [this] { announce_ = true; });
    connect(&felt_, &SurfaceSource::problem, this, &BackgroundRenderer::problem);
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
    felt_.clear();
    for (const auto& source : others_) source->clear();
    if (fine_) fine_->give_up();
    if (quick_) quick_->give_up();
}

void BackgroundRenderer::make_painters() {
    const Painter::Results results{
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
    quick_ = make_painter_(Painter::Priority::normal, results);
    fine_ = make_painter_(Painter::Priority::low, results);
}

void BackgroundRenderer::paint() {
    ++request_.number;
    if (request_.width < 1 || request_.height < 1 || broken_) return;
    if (!quick_) make_painters();
    fine_->give_up();
    collect_surfaces();
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
    request_ = std::move(next);
    match_sources();
    paint();
}

/// One source a surface of the look: those that have its level already, then any.
void BackgroundRenderer::match_sources() {
    const auto& wanted = request_.look.surfaces;
    auto old = std::exchange(others_, {});
    others_.resize(wanted.size());
    const auto claim = [&](auto fits) {
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            if (others_[i]) continue;
            const auto found = std::ranges::find_if(
                old, [&](const auto& source) { return source && fits(*source, wanted[i]); });
            if (found != old.end()) others_[i] = std::move(*found);
        }
    };
    claim([](const SurfaceSource& s, const SeenSurface& w) { return s.level() == w.level; });
    claim([](const SurfaceSource&, const SeenSurface&) { return true; });
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (!others_[i]) {
            others_[i] = std::make_unique<SurfaceSource>(limits_of_others);
            connect(others_[i].get(), &SurfaceSource::made, this, &BackgroundRenderer::paint);
            connect(others_[i].get(), &SurfaceSource::problem, this, &BackgroundRenderer::problem);
            if (request_.field) {
                others_[i]->set_field(*request_.field, wanted[i].level);
                others_[i]->set_patch(patch_);
            }
        }
        others_[i]->set_level(wanted[i].level);
    }
}

void BackgroundRenderer::collect_surfaces() {
    const Look& look = request_.look;
    request_.surfaces.clear();
    if (!request_.field) return;
    request_.surfaces.push_back(
        {felt_.surface(), look.surface_colour, look.surface ? look.surface_opacity : 0});
    for (std::size_t i = 0; i < others_.size(); ++i) {
        const SeenSurface& seen = look.surfaces[i];
        request_.surfaces.push_back(
            {others_[i]->surface(), seen.colour, seen.shown ? seen.opacity : 0});
    }
    request_.surfaces.insert(request_.surfaces.end(), overlay_.begin(), overlay_.end());
}

void BackgroundRenderer::set_overlay(std::vector<DrawnSurface> surfaces) {
    if (surfaces == overlay_) return;
    overlay_ = std::move(surfaces);
    paint();
}

void BackgroundRenderer::set_field(const Field& field, double isovalue) {
    request_.field = field;
    patch_.reset();
    felt_.set_field(field, isovalue);
    for (std::size_t i = 0; i < others_.size(); ++i) {
        others_[i]->set_field(field, request_.look.surfaces[i].level);
    }
    paint();
}

void BackgroundRenderer::update_field(const Field& field) {
    if (!request_.field || request_.field->geometry() != field.geometry()) {
        throw std::invalid_argument("the scene shows no other version of these data");
    }
    const SampleBox box = changed_between(*request_.field, field);
    request_.field = field;
    if (box.empty()) return;
    felt_.update_field(field, box);
    for (const auto& source : others_) source->update_field(field, box);
    if (request_.look.volume || request_.look.slices) paint();
}

void BackgroundRenderer::set_patch(const std::optional<ScenePatch>& patch) {
    patch_ = patch;
    felt_.set_patch(patch);
    for (const auto& source : others_) source->set_patch(patch);
}

void BackgroundRenderer::clear() {
    request_.field.reset();
    patch_.reset();
    felt_.clear();
    for (const auto& source : others_) source->clear();
    overlay_.clear();
    paint();
}

void BackgroundRenderer::set_isovalue(double isovalue) {
    felt_.set_level(isovalue);
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
        Q_EMIT surface_ready(felt_.surface().isovalue, felt_.surface().seconds);
    }
}

bool BackgroundRenderer::shows_whole() const {
    const auto extracting = [](const auto& source) { return source->extracting_whole(); };
    return shown_ && shown_->number == request_.number && !shown_->moving &&
           !felt_.extracting_whole() && std::ranges::none_of(others_, extracting);
}

bool BackgroundRenderer::settled() const {
    if (broken_) return true;
    const auto extracting = [](const auto& source) { return source->extracting(); };
    return shown_ && shown_->number == request_.number && !shown_->moving && !felt_.extracting() &&
           std::ranges::none_of(others_, extracting);
}

}  // namespace palpate::viewer

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
// So many quick pictures in succession that take longer than this need a coarser surface: 15
// pictures per second leave 66 ms, and the window needs the processor as well.
constexpr int many_slow_pictures = 5;
constexpr double slow_seconds = 0.05;
// While the data are edited and nothing else moves, a surface of at most so many is drawn whole, or
// small cuts would not be seen.
constexpr std::size_t most_of_edited = 1'000'000;

/// The part of the look that is rendered here; the window draws the rest over it.
Look rendered_part(Look look) {
    look.contact = look.tetrahedra = look.planes = look.orientation = look.scale_bar = false;
    // These colours are for the slices beside the scene. Slices in the scene are grey, and the
    // surfaces of an overlay already have colours (set_overlay()).
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

/// The finer part is drawn at once as it is: coarser ones would not fit the parts around it.
SurfaceLimits limits_of_patch() {
    SurfaceLimits limits;
    limits.most_triangles = 4'000'000;
    limits.coarse_first = false;
    return limits;
}

}  // namespace

BackgroundRenderer::BackgroundRenderer(MakePainter make_painter)
    : make_painter_(std::move(make_painter)), finer_(limits_of_patch()) {
    for (const SurfaceMaker* maker : {&whole_, &finer_}) {
        connect(maker, &SurfaceMaker::made, this, &BackgroundRenderer::paint);
        connect(maker, &SurfaceMaker::problem, this, &BackgroundRenderer::problem);
    }
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
    whole_.clear();
    finer_.clear();
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
    for (DrawnSurface& one : request.surfaces) {
        ExtractedSurface& surface = one.surface;
        const bool whole = edited_ && triangle_count(surface.blocks) <= most_of_edited;
        if (whole) surface.moving = surface.blocks;
    }
    quick_->draw(std::move(request));
    rest_.start();
}

void BackgroundRenderer::request(const RenderRequest& request) {
    const bool first = request_.number == 0;
    if (!first && same_picture(request_, request)) return;
    edited_ = edited_ && request_.camera == request.camera;
    RenderRequest next = request;
    next.number = request_.number;
    next.field = request_.field;
    request_ = std::move(next);
    whole_.set_levels(levels());
    finer_.set_levels(levels());
    paint();
}

std::vector<double> BackgroundRenderer::levels() const {
    std::vector<double> levels{isovalue_};
    for (const SeenSurface& seen : request_.look.surfaces) levels.push_back(seen.level);
    return levels;
}

void BackgroundRenderer::collect_surfaces() {
    const Look& look = request_.look;
    request_.surfaces.clear();
    if (!request_.field) return;
    const auto at = [](const SurfaceMaker& maker, double level) {
        return std::ranges::find(maker.surfaces(), level, &ExtractedSurface::isovalue);
    };
    const auto add = [&](std::size_t i, double level, const Colour& colour, double opacity) {
        const auto& all = whole_.surfaces();
        DrawnSurface drawn{{}, colour, opacity};
        if (const auto found = at(whole_, level); found != all.end()) {
            drawn.surface = *found;
        } else if (i < all.size()) {
            drawn.surface = all[i];  // stands in for it
        }
        const auto finer = at(finer_, drawn.surface.isovalue);
        if (finer != finer_.surfaces().end()) drawn.finer = *finer;
        request_.surfaces.push_back(std::move(drawn));
    };
    add(0, isovalue_, look.surface_colour, look.surface ? look.surface_opacity : 0);
    for (std::size_t i = 0; i < look.surfaces.size(); ++i) {
        const SeenSurface& seen = look.surfaces[i];
        add(i + 1, seen.level, seen.colour, seen.shown ? seen.opacity : 0);
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
    edited_ = false;
    isovalue_ = isovalue;
    set_patch({});
    whole_.set_moving_triangles(SurfaceLimits().moving_triangles);
    whole_.set_field(field, levels());
    announce_ = true;
    paint();
}

void BackgroundRenderer::update_field(const Field& field) {
    if (!request_.field || request_.field->geometry() != field.geometry()) {
        throw std::invalid_argument("the scene shows no other version of these data");
    }
    const SampleBox box = changed_between(*request_.field, field);
    request_.field = field;
    if (box.empty()) return;
    edited_ = box != whole_box(field.geometry());
    whole_.update_field(field, box);
    if (request_.look.volume || request_.look.slices) paint();
}

void BackgroundRenderer::set_patch(const std::optional<ScenePatch>& patch) {
    const auto before = std::exchange(patch_, patch);
    if (!patch) {
        finer_.clear();
        if (before) paint();
        return;
    }
    const Field& field = patch->detail->field;
    // Changes of all of it would be taken for a sequence, whose surfaces are coarse.
    const SampleBox& changed = patch->detail->changed;
    if (changed != whole_box(field.geometry()) && before && before->bounds == patch->bounds &&
        before->detail->field.geometry() == field.geometry()) {
        return finer_.update_field(field, changed);
    }
    finer_.set_field(field, levels(), patch->bounds);
}

void BackgroundRenderer::clear() {
    request_.field.reset();
    set_patch({});
    whole_.clear();
    overlay_.clear();
    announce_ = false;
    paint();
}

void BackgroundRenderer::set_isovalue(double isovalue) {
    if (isovalue == isovalue_) return;
    isovalue_ = isovalue;
    whole_.set_levels(levels());
    finer_.set_levels(levels());
    announce_ = request_.field.has_value();
}

void BackgroundRenderer::take(RenderedImage image) {
    const bool older = shown_ && image.number < shown_->number;
    const bool coarser = shown_ && image.number == shown_->number && !shown_->moving;
    if (older || (coarser && image.moving)) return;
    if (image.hardware && !image.moving && image.number == request_.number) rest_.stop();
    observe_speed(image);
    shown_ = std::make_shared<const RenderedImage>(std::move(image));
    Q_EMIT painted();
    if (!announce_ || !settled()) return;
    announce_ = false;
    const auto& surfaces = whole_.surfaces();
    if (!surfaces.empty() && surfaces[0].finished) {
        Q_EMIT surface_ready(surfaces[0].isovalue, surfaces[0].seconds);
    }
}

void BackgroundRenderer::observe_speed(const RenderedImage& image) {
    if (!image.moving && !image.hardware) return;
    frame_seconds_ =
        frame_seconds_ > 0 ? 0.8 * frame_seconds_ + 0.2 * image.seconds : image.seconds;
    // A volume has its own ways to become quicker.
    const bool slow =
        image.seconds > slow_seconds && !image.hardware && !request_.look.volume && !edited_;
    slow_pictures_ = slow ? slow_pictures_ + 1 : 0;
    if (slow_pictures_ < many_slow_pictures) return;
    slow_pictures_ = 0;
    whole_.set_moving_triangles(SurfaceLimits().moving_of_others);
}

bool BackgroundRenderer::shows_whole() const {
    return shown_ && shown_->number == request_.number && !shown_->moving && !whole_.extracting();
}

bool BackgroundRenderer::settled() const {
    return broken_ || (shows_whole() && !finer_.extracting());
}

}  // namespace palpate::viewer

// Who paints when.
#include "apps/viewer/scene/backstage.hpp"

#include <QMetaObject>

#include <cmath>
#include <stdexcept>

#include "apps/viewer/scene/sample_block.hpp"

namespace palpate::viewer {
namespace {

constexpr int rest_ms = 150;  // without a change: a fine picture

bool same(const pictures::Camera& a, const pictures::Camera& b) {
    return a.focus == b.focus && a.towards_viewer == b.towards_viewer && a.up == b.up &&
           a.half_height == b.half_height;
}

/// What painters have to do with: the rest the window lays over their pictures.
Look painted_part(Look look) {
    look.contact = look.tetrahedra = look.planes = look.orientation = look.scale_bar = false;
    if (!look.volume) {
        look.transfer = {};
        look.shading = false;
    }
    return look;
}

bool same_picture(const Shot& a, const Shot& b) {
    const bool slices = a.look.slices;
    return painted_part(a.look) == painted_part(b.look) &&
           (!slices || a.crosshair == b.crosshair) && a.background == b.background &&
           a.ink == b.ink && same(a.camera, b.camera) && a.width == b.width &&
           a.height == b.height && a.pixel_ratio == b.pixel_ratio;
}

/// What is done with results that come from other threads: in the thread of `object`, and never if
/// that is gone.
template <class Work>
void hand_over(QObject* object, Work work) {
    QMetaObject::invokeMethod(object, std::move(work), Qt::QueuedConnection);
}

}  // namespace

Backstage::Backstage()
    : surface_work_(
          {[this](DrawnSurface surface) { hand_over(this, [this, surface] { take(surface); }); },
           [this](std::uint64_t wish, const std::string& what) {
               hand_over(this, [this, wish, what] {
                   if (wish != wish_) return;
                   extracting_ = false;
                   Q_EMIT problem(QString::fromStdString(what));
               });
           }}) {
    rest_.setSingleShot(true);
    rest_.setInterval(rest_ms);
    connect(&rest_, &QTimer::timeout, this, [this] {
        if (!fine_ || broken_) return;
        Shot shot = shot_;
        shot.moving = false;
        fine_->paint(std::move(shot));
    });
}

Backstage::~Backstage() {
    // At once, so that none waits for the other.
    surface_work_.forget();
    if (fine_) fine_->give_up();
    if (quick_) quick_->give_up();
}

void Backstage::start_painters() {
    const Painter::Results results{
        [this](Backdrop backdrop) {
            auto shared = std::make_shared<Backdrop>(std::move(backdrop));
            hand_over(this, [this, shared] { take(std::move(*shared)); });
        },
        [this](const std::string& what) {
            hand_over(this, [this, what] {
                if (!broken_) Q_EMIT problem(QString::fromStdString(what));
                broken_ = true;
            });
        }};
    quick_ = std::make_unique<Painter>(Painter::Pace::prompt, results);
    fine_ = std::make_unique<Painter>(Painter::Pace::patient, results);
}

void Backstage::paint() {
    ++shot_.number;
    if (shot_.width < 1 || shot_.height < 1 || broken_) return;
    if (!quick_) start_painters();
    fine_->give_up();
    Shot shot = shot_;
    shot.moving = true;
    quick_->paint(std::move(shot));
    rest_.start();
}

void Backstage::stage(const Shot& shot) {
    const bool first = shot_.number == 0;
    if (!first && same_picture(shot_, shot)) return;
    Shot next = shot;
    next.number = shot_.number;
    next.field = shot_.field;
    next.surface = shot_.surface;
    shot_ = std::move(next);
    paint();
}

void Backstage::set_field(const Field& field, double isovalue) {
    shot_.field = field;
    shot_.surface = {};
    oldest_wish_ = wish_ + 1;
    isovalue_ = std::nan("");
    set_isovalue(isovalue);
    paint();
}

void Backstage::update_field(const Field& field, const std::optional<SampleBox>& changed) {
    if (!shot_.field || shot_.field->geometry() != field.geometry()) {
        throw std::invalid_argument("the scene shows no other version of these data");
    }
    const bool edited = same_but_for_edits(*shot_.field, field);
    const SampleBox box = edited && changed ? *changed : changed_between(*shot_.field, field);
    shot_.field = field;
    if (box.empty()) return;
    if (std::isfinite(isovalue_)) {
        extracting_ = true;
        surface_work_.update(++wish_, field, isovalue_, box);
    }
    if (shot_.look.volume || shot_.look.slices) paint();
}

void Backstage::clear() {
    shot_.field.reset();
    shot_.surface = {};
    oldest_wish_ = wish_ + 1;
    extracting_ = false;
    surface_work_.forget();
    paint();
}

void Backstage::set_isovalue(double isovalue) {
    if (!shot_.field || isovalue == isovalue_) return;
    isovalue_ = isovalue;
    extracting_ = asked_ = true;
    surface_work_.ask(++wish_, *shot_.field, isovalue);
}

void Backstage::take(DrawnSurface surface) {
    // Of an older wish, too, while a newer one is not there: a level that is dragged is seen to
    // move. Never of other data.
    if (surface.wish < oldest_wish_ || surface.wish < shot_.surface.wish) return;
    if (surface.wish == wish_ && surface.finished) {
        extracting_ = false;
        announce_ = announce_ || asked_;
        asked_ = false;
    }
    shot_.surface = std::move(surface);
    paint();
}

void Backstage::take(Backdrop backdrop) {
    const bool older = shown_ && backdrop.number < shown_->number;
    const bool coarser = shown_ && backdrop.number == shown_->number && !shown_->moving;
    if (older || (coarser && backdrop.moving)) return;
    if (backdrop.hardware && !backdrop.moving && backdrop.number == shot_.number) rest_.stop();
    if (backdrop.moving || backdrop.hardware) {
        frame_seconds_ =
            frame_seconds_ > 0 ? 0.8 * frame_seconds_ + 0.2 * backdrop.seconds : backdrop.seconds;
    }
    shown_ = std::make_shared<const Backdrop>(std::move(backdrop));
    Q_EMIT painted();
    if (settled() && announce_) {
        announce_ = false;
        Q_EMIT surface_ready(shot_.surface.isovalue, shot_.surface.seconds);
    }
}

bool Backstage::settled() const {
    if (broken_) return true;
    return shown_ && shown_->number == shot_.number && !shown_->moving && !extracting_;
}

}  // namespace palpate::viewer

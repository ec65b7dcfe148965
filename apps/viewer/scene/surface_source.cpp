// Numbers requests, and takes surfaces that are not too old.
#include "apps/viewer/scene/surface_source.hpp"

#include "apps/viewer/scene/hand_over.hpp"

namespace palpate::viewer {

SurfaceSource::SurfaceSource(const SurfaceLimits& limits)
    : extractor_({[this](ExtractedSurface surface) {
                      hand_over(this, [this, surface] { take(surface); });
                  },
                  [this](std::uint64_t request, const std::string& what) {
                      hand_over(this, [this, request, what] {
                          if (request != request_) return;
                          extracting_ = false;
                          Q_EMIT problem(QString::fromStdString(what));
                      });
                  }},
                 limits) {}

void SurfaceSource::set_field(const Field& field, double level) {
    field_ = field;
    surface_ = {};
    oldest_ = request_ + 1;
    level_ = std::nan("");
    set_level(level);
}

void SurfaceSource::update_field(const Field& field, const SampleBox& changed) {
    field_ = field;
    if (changed.empty() || !std::isfinite(level_)) return;
    extracting_ = true;
    extractor_.update(++request_, field, level_, changed);
}

void SurfaceSource::set_level(double level) {
    if (!field_ || level == level_) return;
    level_ = level;
    extracting_ = asked_ = true;
    extractor_.ask(++request_, *field_, level);
}

void SurfaceSource::clear() {
    field_.reset();
    surface_ = {};
    oldest_ = request_ + 1;
    extracting_ = false;
    extractor_.forget();
}

void SurfaceSource::take(ExtractedSurface surface) {
    // Of an older request, too, while a newer one is not there. Never of other data.
    if (surface.request < oldest_ || surface.request < surface_.request) return;
    const bool last = surface.request == request_ && surface.finished;
    surface_ = std::move(surface);
    if (last) extracting_ = false;
    Q_EMIT made();
    if (!last || !asked_) return;
    asked_ = false;
    Q_EMIT finished();
}

}  // namespace palpate::viewer

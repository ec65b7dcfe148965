// One hand, one loader, and the judge of where the proxy goes.
#include "evaluation/stroke.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "palpate/renderer.hpp"
#include "palpate/stream/loader.hpp"

namespace palpate::evaluation {
namespace {

/// The allowed error [voxel]: rounding to levels of two voxels, twice at a coarser level (which is
/// interpolated). There, straight lines between samples also cut off a part of a ball of 256
/// voxels, and so does the smooth field.
double allowance(int level) {
    return (level > 0 ? 2.5 : 1.5) + std::ldexp(1.0, 2 * level) / 256;
}

/// The coarsest level of the samples that the field at a point may depend on.
int level_near(const Field& field, const Vec3& point) {
    constexpr double around = 2 * ball_voxel;
    int level = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        level = std::max(level, level_at(field, point + around * side));
    }
    return level;
}

/// There and back through a row of balls.
Vec3 hand_at(double way) {
    const Vec3 begin(1.54, 5.0, 5.1), end(9.98, 5.1, 4.9);
    const double parts = way / (end - begin).norm();
    const double part = parts - 2 * std::floor(parts / 2);
    return begin + std::min(part, 2 - part) * (end - begin);
}

/// Follows the proxy's path step by step.
class Judge {
  public:
    Judge(StrokeResult& result, const Renderer& renderer) : result_(result), renderer_(renderer) {}

    StepObserver observer() {
        return {[](const Step& step, void* self) { static_cast<Judge*>(self)->take(step); }, this};
    }
    void end_tick(const ProxyUpdate& update) {
        const bool waiting = update.status == UpdateStatus::waiting;
        ++result_.ticks;
        result_.waiting += waiting;
        result_.touching += update.mode == Mode::constrained && !waiting;
        result_.coarse += !waiting && update.level > 0;
        const bool not_placed = waiting && update.scp == update.hip;
        const double depth = ball_depth(update.scp);
        const int level = level_near(renderer_.field, update.scp);
        // If finer samples came over a proxy, the coarser ones count until it is out.
        level_ = depth <= allowance(level) ? level : std::max(level_, level);
        // A hand may be in a ball when the first samples come; its proxy feels nothing and goes
        // out, as one does over which a surface came.
        const bool lost = not_placed || update.status == UpdateStatus::recovering ||
                          update.status == UpdateStatus::refused;
        is_outside_ = !lost && (is_outside_ || depth <= allowance(level_));
        if (is_outside_) judge(update.scp);
    }

  private:
    void take(const Step& step) {
        if (step.kind == StepKind::goal) return;
        const bool moved = begun_ && step.kind != StepKind::recover && step.kind != StepKind::place;
        if (moved && is_outside_) {
            const double way = (step.point - last_).norm() / ball_voxel;
            const int count = static_cast<int>(std::clamp(std::ceil(way), 1.0, 1e4));
            for (int n = 1; n <= count; ++n) judge(last_ + n * (step.point - last_) / count);
        }
        last_ = step.point;
        begun_ = true;
    }
    void judge(const Vec3& point) {
        const double depth = ball_depth(point);
        const int level = std::max(level_, level_near(renderer_.field, point));
        result_.deepest = std::max(result_.deepest, depth);
        result_.beyond = std::max(result_.beyond, depth - allowance(level));
    }

    StrokeResult& result_;
    const Renderer& renderer_;
    Vec3 last_ = Vec3::Zero();
    bool begun_ = false, is_outside_ = false;
    int level_ = 0;
};

}  // namespace

StrokeResult feel(const Stroke& stroke, const std::function<void(double)>& progress) {
    using SteadyClock = std::chrono::steady_clock;
    const SteadyClock::time_point opened = SteadyClock::now();
    const auto since_opened = [&] {
        return std::chrono::duration<double>(SteadyClock::now() - opened).count();
    };
    const auto store = std::make_shared<VirtualStore>(stroke.network, stroke.seed);
    stream::BrickLoaderSettings settings;
    settings.memory = stroke.memory;
    settings.coarse_first = stroke.coarse_first;
    stream::BrickLoader loader(store, stream::overview_of(*store), settings);
    const Field field(loader.empty(), Solid::above, 0, Interpolation::cubic);
    Renderer renderer = make_renderer(field, ball_isovalue);
    StrokeResult result;
    Judge judge(result, renderer);
    const auto period = std::chrono::duration<double>(1 / stroke.rate);
    const auto looks = std::max<std::int64_t>(1, std::llround(stroke.rate / 200));
    const auto count = std::llround(stroke.seconds * stroke.rate);
    SteadyClock::time_point due = SteadyClock::now();
    Vec3 before = hand_at(0);
    for (std::int64_t tick = 0; tick < count; ++tick) {
        const double time = static_cast<double>(tick) / stroke.rate;
        const Vec3 hand = hand_at(stroke.speed * time);
        if (tick % looks == 0) {
            const double passed = static_cast<double>(looks) / stroke.rate;
            const Vec3 scp = renderer.proxy.placed ? renderer.proxy.scp_physical : hand;
            const stream::Interest interest{scp, hand, (hand - before) / passed};
            before = hand;
            loader.look({&interest, 1});
            if (const auto version = loader.take()) {
                field_will_change(renderer.proxy, renderer.field);
                renderer.field.use(version->samples);
            }
            if (tick % (20 * looks) == 0)
                progress(static_cast<double>(tick) / static_cast<double>(count));
        }
        judge.end_tick(render(renderer, {time, hand, true}, judge.observer()).proxy);
        if (result.first_contact_s < 0 && result.touching > 0) {
            result.first_contact_s = since_opened();
        }
        due += std::chrono::duration_cast<SteadyClock::duration>(period);
        std::this_thread::sleep_until(due);
    }
    result.most_bytes = loader.status().most_bytes;
    result.traffic = loader.status().traffic;
    return result;
}

}  // namespace palpate::evaluation

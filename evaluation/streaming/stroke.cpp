// One hand, one loader, and the judge of where the proxy goes.
#include "evaluation/streaming/stroke.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "palpate/reach.hpp"
#include "palpate/renderer.hpp"
#include "palpate/stream/loader.hpp"

namespace palpate::evaluation {
namespace {

/// What rounding to levels of two voxels may take, at a coarser level twice (it is interpolated),
/// and there what straight lines between samples cut off a ball of 256 voxels (and the smooth field
/// once more) [voxel].
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

class Judge {
  public:
    explicit Judge(StrokeResult& result) : result_(result) {}

    void look(const ProxyUpdate& update, const Field& field) {
        const bool waiting = update.status == UpdateStatus::waiting;
        ++result_.ticks;
        result_.waiting += waiting;
        const bool touches = update.mode == Mode::constrained && !waiting;
        result_.touching += touches;
        result_.coarse += !waiting && update.level > 0;
        // A proxy over which a surface comes, because finer samples did, goes out of it.
        const bool lost =
            update.status == UpdateStatus::recovering || update.status == UpdateStatus::refused;
        if (lost) has_before_ = is_outside_ = false;
        if (lost || (waiting && update.scp == update.hip)) return;
        // Where finer samples came over a proxy, the coarser ones count until it is out.
        const double depth_now = ball_depth(update.scp);
        level_ =
            depth_now <= allowance(update.level) ? update.level : std::max(level_, update.level);
        const int level = std::max(level_before_, level_);
        level_before_ = level_;
        const auto judge = [&](const Vec3& point) {
            const double depth = ball_depth(point);
            result_.deepest = std::max(result_.deepest, depth);
            const double allowed = allowance(std::max(level, level_near(field, point)));
            result_.beyond = std::max(result_.beyond, depth - allowed);
        };
        // A hand may be in a ball when the first samples come; its proxy feels nothing and goes
        // out.
        is_outside_ = is_outside_ || depth_now <= allowance(level);
        if (!is_outside_) return;
        judge(update.scp);
        // A proxy that catches up slides round a ball in one tick: a long line would cut it off.
        constexpr double longest = 32;
        if (has_before_) {
            const double way = (update.scp - before_).norm() / ball_voxel;
            const int steps = way <= longest ? static_cast<int>(std::ceil(way)) : 0;
            for (int n = 1; n < steps; ++n) {
                judge(before_ + n * (update.scp - before_) / steps);
            }
        }
        before_ = update.scp;
        has_before_ = true;
    }

  private:
    StrokeResult& result_;
    Vec3 before_ = Vec3::Zero();
    bool has_before_ = false, is_outside_ = false;
    int level_ = 0, level_before_ = 0;
};

}  // namespace

StrokeResult feel(const Stroke& stroke, const std::function<void()>& alive) {
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
    Judge judge(result);
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
            if (tick % (20 * looks) == 0) alive();
        }
        const Tick felt = render(renderer, {time, hand, true});
        judge.look(felt.proxy, renderer.field);
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

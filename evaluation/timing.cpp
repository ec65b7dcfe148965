// Times updates in passes, in batches and one by one, with warm and with empty caches.
#include "evaluation/timing.hpp"

#include <algorithm>
#include <chrono>

#include "evaluation/table.hpp"

namespace palpate::evaluation {
namespace {

using Clock = std::chrono::steady_clock;

double nanoseconds(Clock::duration duration) {
    return std::chrono::duration<double, std::nano>(duration).count();
}

struct Timed {
    const Subject& subject;
    ProxyMethod method;
    const std::vector<Trajectory>& trajectories;

    /// `update` is called with the proxy and each place of the hand; the move to a trajectory's
    /// start is not timed.
    template <class Update>
    void follow(Update&& update) const {
        evaluation::follow(
            subject, trajectories,
            [&](Proxy& proxy, const Trajectory& hand, std::size_t i) { update(proxy, hand[i]); });
    }
    ProxyUpdate update(Proxy& proxy, const Vec3& hip) const {
        return method(proxy, subject.field, hip, {}, {});
    }
};

/// Mean over all updates [ns]: timed in batches without a clock inside, so short that most of them
/// are not interrupted; of each batch the median over the passes counts.
double mean_of_batches(const Timed& timed, int passes, std::int64_t updates) {
    constexpr std::size_t batch = 50;
    std::vector<std::vector<double>> batches;  // [ns], of each the passes
    for (int pass = 0; pass < passes; ++pass) {
        std::size_t number = 0;
        for (const Trajectory& trajectory : timed.trajectories) {
            Proxy proxy;
            place(proxy, timed.subject.field, trajectory.front(), timed.subject.isovalue);
            for (std::size_t first = 1; first < trajectory.size(); first += batch, ++number) {
                const std::size_t last = std::min(trajectory.size(), first + batch);
                if (number == batches.size()) batches.emplace_back();
                const auto begin = Clock::now();
                for (std::size_t i = first; i < last; ++i) timed.update(proxy, trajectory[i]);
                batches[number].push_back(nanoseconds(Clock::now() - begin));
            }
        }
    }
    double sum = 0;
    for (const auto& times : batches) sum += quantile(times, 0.5);
    return sum / static_cast<double>(updates);
}

void count(const Timed& timed, UpdateTimes& times) {
    timed.follow([&](Proxy& proxy, const Vec3& hip) {
        const ProxyUpdate update = timed.update(proxy, hip);
        ++times.updates;
        times.tetrahedra += update.tetrahedra;
        times.constrained += update.mode == Mode::constrained;
        times.unfinished += update.status == UpdateStatus::out_of_budget ||
                            update.status == UpdateStatus::recovering;
    });
}

double clock_cost() {
    std::vector<double> empty(1001);
    for (double& ns : empty) {
        const auto begin = Clock::now();
        ns = nanoseconds(Clock::now() - begin);
    }
    return quantile(empty, 0.5);
}

/// Times of the updates one by one: for each its median over the passes.
void time_singly(const Timed& timed, int passes, UpdateTimes& times) {
    const auto updates = static_cast<std::size_t>(times.updates);
    const auto width = static_cast<std::size_t>(passes);
    std::vector<float> readings(updates * width);  // [ns]
    for (std::size_t pass = 0; pass < width; ++pass) {
        float* reading = readings.data() + pass;
        timed.follow([&](Proxy& proxy, const Vec3& hip) {
            const auto begin = Clock::now();
            timed.update(proxy, hip);
            *reading = static_cast<float>(nanoseconds(Clock::now() - begin));
            reading += width;
        });
    }
    std::vector<double> medians;
    medians.reserve(updates);
    for (std::size_t i = 0; i < updates; ++i) {
        const auto begin = readings.begin() + static_cast<std::ptrdiff_t>(i * width);
        const auto end = begin + passes;
        std::sort(begin, end);
        times.interrupted_max_ns = std::max<double>(times.interrupted_max_ns, *(end - 1));
        medians.push_back(*(begin + (passes - 1) / 2));
    }
    times.p50_ns = quantile(medians, 0.5);
    times.p99_ns = quantile(medians, 0.99);
    times.p999_ns = quantile(medians, 0.999);
    times.max_ns = largest(medians);
}

/// Median over updates before each of which more memory was walked through than caches hold: what
/// an update costs if the rest of the tick has used all of them.
double cold_median(const Timed& timed, int wanted, std::int64_t updates) {
    constexpr std::size_t more_than_caches = std::size_t{48} << 20;
    constexpr std::size_t line = 64;  // bytes
    std::vector<std::uint8_t> memory(wanted > 0 ? more_than_caches : 0, 1);
    volatile std::uint8_t* const walked = memory.data();
    const std::int64_t every = std::max<std::int64_t>(1, updates / std::max(1, wanted));
    std::vector<double> cold;
    std::int64_t number = 0;
    timed.follow([&](Proxy& proxy, const Vec3& hip) {
        if (wanted <= 0 || ++number % every != 0) {
            timed.update(proxy, hip);
            return;
        }
        for (std::size_t i = 0; i < memory.size(); i += line) walked[i] = 2;
        const auto begin = Clock::now();
        timed.update(proxy, hip);
        cold.push_back(nanoseconds(Clock::now() - begin));
    });
    return quantile(cold, 0.5);
}

}  // namespace

UpdateTimes time_updates(const Subject& subject, ProxyMethod method,
                         const std::vector<Trajectory>& trajectories, const TimingPlan& plan) {
    const Timed timed{subject, method, trajectories};
    UpdateTimes times;
    count(timed, times);
    times.mean_ns = mean_of_batches(timed, plan.passes, times.updates);
    time_singly(timed, plan.passes, times);
    times.clock_ns = clock_cost();
    times.cold_p50_ns = cold_median(timed, plan.cold_updates, times.updates);
    return times;
}

}  // namespace palpate::evaluation

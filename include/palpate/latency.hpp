// Stage 17, latency: histograms of durations, counted without locks. They give percentiles and the
// maximum, because a mean says nothing about a servo loop.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>

namespace palpate {

/// Percentiles p50, p99 and p99.9, exact to 1/16, and the maximum of the durations counted [ns].
struct LatencySummary {
    std::uint64_t count = 0;
    std::int64_t p50 = 0, p99 = 0, p999 = 0, max = 0;
};

/// A histogram with 16 buckets per doubling. One thread adds; any thread may read meanwhile.
class LatencyHistogram {
  public:
    /// Wait-free; negative durations count as 0.
    void add(std::int64_t ns) noexcept {
        const auto duration = static_cast<std::uint64_t>(std::max<std::int64_t>(0, ns));
        auto& bucket = buckets_[bucket_of(duration)];
        bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        if (ns > max_.load(std::memory_order_relaxed)) max_.store(ns, std::memory_order_relaxed);
    }

    LatencySummary summary() const noexcept {
        LatencySummary summary;
        for (const auto& bucket : buckets_) summary.count += bucket.load(std::memory_order_relaxed);
        summary.max = max_.load(std::memory_order_relaxed);
        summary.p50 = percentile(0.5, summary);
        summary.p99 = percentile(0.99, summary);
        summary.p999 = percentile(0.999, summary);
        return summary;
    }

    /// How many were no longer than this, exact to 1/16 of it.
    std::uint64_t count_to(std::int64_t ns) const noexcept {
        std::uint64_t count = 0;
        for (unsigned b = 0; b < bucket_count && top_of(b) <= ns; ++b) {
            count += buckets_[b].load(std::memory_order_relaxed);
        }
        return count;
    }

  private:
    static constexpr unsigned steps = 16;  // buckets per doubling
    static constexpr unsigned bucket_count = (64 - 3) * steps;

    static unsigned bucket_of(std::uint64_t ns) {
        if (ns < steps) return static_cast<unsigned>(ns);
        const auto octave = static_cast<unsigned>(std::bit_width(ns)) - 5;  // 0 for 16 to 31
        return (octave + 1) * steps + static_cast<unsigned>(ns >> octave & (steps - 1));
    }
    /// The largest duration that falls into a bucket.
    static std::int64_t top_of(unsigned bucket) {
        if (bucket < steps) return bucket;
        const unsigned octave = bucket / steps - 1;
        const std::uint64_t low = std::uint64_t{steps + bucket % steps} << octave;
        return static_cast<std::int64_t>(low + ((std::uint64_t{1} << octave) - 1));
    }
    std::int64_t percentile(double part, const LatencySummary& of) const noexcept {
        const auto wanted = part * static_cast<double>(of.count);
        std::uint64_t seen = 0;
        for (unsigned b = 0; b < bucket_count; ++b) {
            seen += buckets_[b].load(std::memory_order_relaxed);
            if (seen > 0 && static_cast<double>(seen) >= wanted) return std::min(top_of(b), of.max);
        }
        return of.max;
    }

    std::array<std::atomic<std::uint64_t>, bucket_count> buckets_{};
    std::atomic<std::int64_t> max_{0};
};

}  // namespace palpate

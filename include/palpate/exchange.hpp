// Stage 11, exchange: two containers with which threads exchange values without waiting, and
// histograms of durations that one thread counts and others read. All data between the servo thread
// and others (snapshots, commands, recordings, devices) goes through them.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <type_traits>
#include <utility>

namespace palpate {

/// The newest of a stream of values: one thread puts, any number of threads get. Neither waits,
/// locks or allocates. T is plain data that owns nothing, because it is copied byte by byte.
///
/// A ring of slots, each with a sequence number that tells a reader whether its copy was
/// overwritten meanwhile. The bytes are atomic words, so there is no data race, and no fence, which
/// a thread sanitizer could not follow. A word is stored with release after the slot was marked, so
/// a reader that meets a newer word (acquire) also meets the newer mark.
template <class T>
requires std::is_trivially_destructible_v<T>
class Newest {
  public:
    /// By one thread only.
    void put(const T& value) noexcept {
        const std::uint64_t number = count_.load(std::memory_order_relaxed) + 1;
        Slot& slot = slots_[number % slot_count];
        std::array<std::uint64_t, word_count> bytes{};
        std::memcpy(bytes.data(), static_cast<const void*>(&value), sizeof(T));
        slot.number.store(0, std::memory_order_relaxed);
        for (std::size_t i = 0; i < word_count; ++i) {
            slot.words[i].store(bytes[i], std::memory_order_release);
        }
        slot.number.store(number, std::memory_order_release);
        count_.store(number, std::memory_order_release);
    }

    /// The newest value, or nothing if none was put yet. The number of attempts is bounded: a
    /// reader that is overtaken by a whole ring of values in each attempt also gets nothing.
    std::optional<T> get() const noexcept {
        for (int attempt = 0; attempt < attempts; ++attempt) {
            const std::uint64_t number = count_.load(std::memory_order_acquire);
            if (number == 0) return std::nullopt;
            const Slot& slot = slots_[number % slot_count];
            if (slot.number.load(std::memory_order_acquire) != number) continue;
            std::array<std::uint64_t, word_count> bytes;
            for (std::size_t i = 0; i < word_count; ++i) {
                bytes[i] = slot.words[i].load(std::memory_order_acquire);
            }
            if (slot.number.load(std::memory_order_relaxed) != number) continue;
            std::optional<T> value(std::in_place);
            std::memcpy(static_cast<void*>(&*value), bytes.data(), sizeof(T));
            return value;
        }
        return std::nullopt;
    }

    /// How many values were put so far.
    std::uint64_t count() const noexcept { return count_.load(std::memory_order_acquire); }

  private:
    static constexpr std::size_t word_count = (sizeof(T) + 7) / 8;
    static constexpr std::size_t slot_count = 4;
    static constexpr int attempts = 16;

    struct Slot {
        std::atomic<std::uint64_t> number{0};
        std::array<std::atomic<std::uint64_t>, word_count> words{};
    };

    alignas(64) std::atomic<std::uint64_t> count_{0};
    alignas(64) std::array<Slot, slot_count> slots_{};
};

/// A bounded queue: any number of threads push, one thread pops. Neither waits, locks or, after
/// construction, allocates. Values come out in the order in which the pushes took their places
/// (Vyukov's bounded queue).
// The padding keeps the two ends on different cache lines.
template <class T>
class Queue {  // NOLINT(clang-analyzer-optin.performance.Padding)
  public:
    /// Room for at least `capacity` values. Throws std::bad_alloc.
    explicit Queue(std::size_t capacity) {
        std::size_t size = 2;
        while (size < capacity) size *= 2;
        mask_ = size - 1;
        cells_ = std::make_unique<Cell[]>(size);
        for (std::size_t i = 0; i < size; ++i) cells_[i].turn.store(i, std::memory_order_relaxed);
    }

    /// False, and nothing happens, if the queue is full.
    bool push(const T& value) noexcept(std::is_nothrow_copy_assignable_v<T>) {
        std::size_t place = tail_.load(std::memory_order_relaxed);
        for (;;) {
            Cell& cell = cells_[place & mask_];
            const std::size_t turn = cell.turn.load(std::memory_order_acquire);
            if (turn == place) {
                if (tail_.compare_exchange_weak(place, place + 1, std::memory_order_relaxed)) {
                    cell.value = value;
                    cell.turn.store(place + 1, std::memory_order_release);
                    return true;
                }
            } else if (turn < place) {
                return false;
            } else {
                place = tail_.load(std::memory_order_relaxed);
            }
        }
    }

    /// The oldest value, or nothing. By one thread only.
    std::optional<T> pop() noexcept(std::is_nothrow_move_constructible_v<T>) {
        Cell& cell = cells_[head_ & mask_];
        if (cell.turn.load(std::memory_order_acquire) != head_ + 1) return std::nullopt;
        // Moved out, so that an empty cell owns nothing.
        std::optional<T> value(std::move(cell.value));
        cell.turn.store(head_ + mask_ + 1, std::memory_order_release);
        ++head_;
        return value;
    }

    std::size_t capacity() const noexcept { return mask_ + 1; }

  private:
    struct Cell {
        std::atomic<std::size_t> turn{0};
        T value{};
    };

    std::size_t mask_ = 0;
    std::unique_ptr<Cell[]> cells_;
    alignas(64) std::atomic<std::size_t> tail_{0};
    alignas(64) std::size_t head_ = 0;  // of the popping thread
};

/// Percentiles p50, p99 and p99.9, exact to 1/16, and the maximum of the durations counted [ns].
struct LatencySummary {
    std::uint64_t count = 0;
    std::int64_t p50 = 0, p99 = 0, p999 = 0, max = 0;
};

/// A histogram with 16 buckets per doubling. One thread adds, and any thread may read meanwhile.
class LatencyHistogram {
  public:
    /// Wait-free. Negative durations count as 0.
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

    /// The number of durations up to this one, exact to 1/16 of it.
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

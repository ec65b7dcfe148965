// Replaces samples that are not finite. See the header.
#include "stream/formats/finite_store.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "palpate/io/error.hpp"
#include "stream/box_bytes.hpp"
#include "stream/sample_bytes.hpp"

namespace palpate::stream {
namespace {

/// Samples that are searched at most.
constexpr std::int64_t most_searched = std::int64_t{1} << 28;

/// Calls visit(sample, its bytes) for each, if they are of a type that has others than finite ones.
template <class Visit>
void for_each_float(SampleType type, std::span<std::byte> bytes, Visit&& visit) {
    if (type != SampleType::float32) return;
    for (std::size_t at = 0; at + sizeof(float) <= bytes.size(); at += sizeof(float)) {
        float sample;
        std::memcpy(&sample, bytes.data() + at, sizeof sample);
        visit(sample, bytes.data() + at);
    }
}

}  // namespace

void FiniteStore::read(int level, const SampleBox& box, std::span<std::byte> out,
                       std::stop_token stop) const {
    check_request(level_of(*this, level).geometry, box, info_.type, out.size());
    const auto place = [&](const Index3& first, std::size_t) {
        return out.data() + place_in(box, first) * size_of(info_.type);
    };
    put(level, box, place, stop);
    bool all = true;
    for_each_float(info_.type, out,
                   [&](float sample, auto) { all = all && std::isfinite(sample); });
    if (all) return;
    const auto least = static_cast<float>(least_finite(stop));
    for_each_float(info_.type, out, [&](float sample, std::byte* at) {
        if (!std::isfinite(sample)) std::memcpy(at, &least, sizeof least);
    });
}

double FiniteStore::least_finite(const std::stop_token& stop) const {
    if (info_.range) return info_.range->minimum;
    const UnpackingRoom::Share only(searching_, 1, stop);
    if (!least_finite_) least_finite_ = searched(stop);
    return *least_finite_;
}

/// The least finite sample of the finest level of at most `most_searched` samples. If each level
/// has more: that of as many, in pieces spread evenly over the coarsest level. Damaged pieces are
/// left out; the fill value if nothing is found so.
double FiniteStore::searched(const std::stop_token& stop) const {
    const auto is_too_large = [&](int level) {
        return sample_count(level_of(*this, level).geometry) > most_searched || !can_unpack(level);
    };
    int level = 0;
    while (level + 1 < static_cast<int>(info_.levels.size()) && is_too_large(level)) ++level;
    const Level& of = level_of(*this, level);
    const Geometry& grid = of.geometry;
    const Index3& piece = of.chunk;
    const Index3 pieces = (grid.size + piece - Index3::Ones()).cwiseQuotient(piece);
    int step = 1;
    const auto taken = [&] {
        const auto along = ((pieces.array() + (step - 1)) / step).cast<std::int64_t>().eval();
        return along.prod();
    };
    const bool all = sample_count(grid) <= most_searched;
    const auto in_piece = piece.cast<std::int64_t>().prod();
    while (!all && taken() > 1 && taken() * in_piece > most_searched) ++step;
    float least = std::numeric_limits<float>::infinity();
    bool damaged = false;
    std::vector<std::byte> run;
    const auto next_run = [&](const Index3&, std::size_t count) {
        for_each_float(info_.type, run, [&](float sample, auto) {
            if (sample < least && std::isfinite(sample)) least = sample;
        });
        run.resize(count * size_of(info_.type));
        return run.data();
    };
    for_each_index({Index3::Zero(), (pieces - Index3::Ones()) / step}, [&](const Index3& at) {
        const Index3 low = step * at.cwiseProduct(piece);
        const Index3 high = (low + piece).cwiseMin(grid.size) - Index3::Ones();
        try {
            put(level, {low, high}, next_run, stop);
            next_run(low, 0);
        } catch (const io::InputError&) {
            damaged = true;
            run.clear();
        }
    });
    if (std::isfinite(least)) return least;
    if (!all || damaged) return info_.fill;
    throw io::InputError(info_.address +
                         ": none of its samples is a finite number; export it again");
}

}  // namespace palpate::stream

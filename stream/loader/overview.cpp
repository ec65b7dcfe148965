// Overviews and whole levels of stores, and single bricks as they are loaded.
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <stdexcept>

#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "palpate/stream/loader.hpp"
#include "stream/at_once.hpp"
#include "stream/box_bytes.hpp"
#include "stream/loader/brick_loader.hpp"
#include "stream/loader/upsample.hpp"
#include "stream/while_telling.hpp"

namespace palpate::stream {
namespace {

/// That read an overview at a time.
constexpr int threads = 32;
/// Most reads for an overview of a level that is too large to be read whole: of rows, or of pieces.
constexpr std::int64_t most_rows = 4096;
constexpr std::int64_t most_pieces = 512;
/// Rows of more chunks than this are not read whole.
constexpr int most_chunks_in_row = 16;

/// By several threads, piece by piece, each of which says what part is made.
Volume whole_level(const Store& store, int level, const std::stop_token& stop,
                   const std::function<void(double)>& made = {}) {
    const StoreInfo& info = store.info();
    const Geometry& geometry = level_of(store, level).geometry;
    const SampleBox box = whole_box(geometry);
    std::vector<SampleBox> pieces;
    for_each_piece(piece_of(level_of(store, level)), box,
                   [&](const Index3&, const SampleBox& piece) { pieces.push_back(piece); });
    std::vector<std::byte> all(bytes_of(box, info.type));
    std::atomic<std::size_t> done{0};
    for_all_at_once(pieces.size(), threads, stop, [&](std::size_t i, const auto& until) {
        std::vector<std::byte> bytes(bytes_of(pieces[i], info.type));
        store.read(level, pieces[i], bytes, until);
        copy_box(pieces[i], bytes.data(), box, all.data(), size_of(info.type));
        if (made) made(static_cast<double>(++done) / static_cast<double>(pieces.size()));
    });
    return volume_from(geometry, info.type, std::move(all));
}

/// Every n-th sample along each axis of the coarsest level.
Volume thinned_level(const Store& store, std::int64_t samples, std::stop_token stop) {
    const StoreInfo& info = store.info();
    const auto level = static_cast<int>(info.levels.size()) - 1;
    const Level& grid = info.levels.back();
    const bool by_row =
        is_stored_in_rows(grid) && (grid.geometry.size[0] - 1) / grid.chunk[0] < most_chunks_in_row;
    const auto count_at = [&](int step) {
        return Index3((grid.geometry.size + Index3::Constant(step - 1)) / step);
    };
    int step = 1;
    for (;; ++step) {
        const Eigen::Matrix<std::int64_t, 3, 1> n = count_at(step).cast<std::int64_t>();
        const std::int64_t reads = by_row ? n[1] * n[2] : n.prod();
        if (n.prod() <= samples && reads <= (by_row ? most_rows : most_pieces)) break;
    }
    Geometry geometry = grid.geometry;
    geometry.size = count_at(step);
    geometry.spacing *= step;
    const std::size_t each = size_of(info.type);
    std::vector<std::byte> bytes(static_cast<std::size_t>(sample_count(geometry)) * each);
    const auto rows =
        static_cast<std::size_t>(geometry.size[1]) * static_cast<std::size_t>(geometry.size[2]);
    const auto along = static_cast<std::size_t>(geometry.size[0]);
    for_all_at_once(rows, threads, stop, [&](std::size_t r, const auto& until) {
        const auto j = static_cast<int>(r % static_cast<std::size_t>(geometry.size[1]));
        const auto k = static_cast<int>(r / static_cast<std::size_t>(geometry.size[1]));
        const Index3 low(0, j * step, k * step);
        std::byte* out = bytes.data() + r * along * each;
        std::vector<std::byte> row;
        if (by_row) {
            row.resize(static_cast<std::size_t>(grid.geometry.size[0]) * each);
            store.read(level, {low, low + Index3(grid.geometry.size[0] - 1, 0, 0)}, row, until);
        }
        for (int i = 0; i < geometry.size[0]; ++i, out += each) {
            const Index3 at = low + Index3(i * step, 0, 0);
            if (by_row) {
                std::memcpy(out, row.data() + static_cast<std::size_t>(at[0]) * each, each);
            } else {
                store.read(level, {at, at}, {out, each}, until);
            }
        }
    });
    return volume_from(geometry, info.type, std::move(bytes));
}

}  // namespace

const Level& level_of(const Store& store, int level) {
    const auto count = static_cast<int>(store.info().levels.size());
    if (level < 0 || level >= count) {
        throw std::invalid_argument(io::without_secrets(store.info().address) +
                                    ": there is no level " + std::to_string(level) + ": it has " +
                                    std::to_string(count) +
                                    (count == 1 ? " level, 0" : " levels, from 0"));
    }
    return store.info().levels[static_cast<std::size_t>(level)];
}

Volume read_level(const Store& store, int level, const io::Progress& progress) {
    const double samples = static_cast<double>(sample_count(level_of(store, level).geometry));
    const auto memory = static_cast<double>(io::machine_memory());
    if (samples * static_cast<double>(size_of(store.info().type)) > memory) {
        throw io::InputError(store.info().address + ": level " + std::to_string(level) +
                             " is larger than the memory there is; take a coarser one");
    }
    return while_telling(progress, [&](const std::stop_token& stop, std::atomic<double>& made) {
        return whole_level(store, level, stop, [&](double part) { made = part; });
    });
}

Volume overview_of(const Store& store, std::int64_t samples, std::stop_token stop) {
    const std::vector<Level>& levels = store.info().levels;
    for (std::size_t level = 0; level < levels.size(); ++level) {
        if (sample_count(levels[level].geometry) > samples) continue;
        return whole_level(store, static_cast<int>(level), stop);
    }
    return thinned_level(store, samples, stop);
}

/// The samples of the store that a brick is made of.
SampleBox BrickLoader::Parts::source_of(const Index3& brick, int coarser) const {
    const SampleBox box = ResidentBricks::box_of(brick, geometry_.size);
    if (coarser == 0) return box;
    const Geometry& grid = level_of(*store_, settings_.level + coarser).geometry;
    const auto index_in = [&](const Index3& at) {
        return index_from_physical(grid, physical_from_index(geometry_, at.cast<double>()));
    };
    const Vec3 a = index_in(box.low), b = index_in(box.high);
    const Vec3 last = (grid.size - Index3::Ones()).cast<double>();
    const auto inside = [&](const Vec3& at) {
        return Index3(at.cwiseMax(Vec3::Zero()).cwiseMin(last).cast<int>());
    };
    return {inside(a.cwiseMin(b).array().floor()), inside(a.cwiseMax(b).array().ceil())};
}

/// Whether all that the store is asked for is in memory or being read.
bool BrickLoader::Parts::has_all(const Index3& brick, int coarser) const {
    return blocks_->has_all(settings_.level + coarser, source_of(brick, coarser));
}

Brick BrickLoader::Parts::read(const Index3& brick, int coarser, const std::stop_token& stop) {
    const SampleType type = overview_.type();
    const std::size_t each = size_of(type);
    const int level = settings_.level + coarser;
    const SampleBox box = ResidentBricks::box_of(brick, geometry_.size);
    const SampleBox from = source_of(brick, coarser);
    if (coarser == 0) {
        blocks_->load(level, box, stop);  // before it takes memory
        const std::shared_ptr<std::byte[]> samples = memory_->take();
        blocks_->read(level, box, room_of(brick), {samples.get(), ResidentBricks::per_brick * each},
                      stop);
        return {samples, 0};
    }
    const Geometry& grid = level_of(*store_, level).geometry;
    std::vector<std::byte> bytes(bytes_of(from, type));
    blocks_->read(level, from, from, bytes, stop);
    const std::shared_ptr<std::byte[]> samples = memory_->take();
    upsample(geometry_of(grid, from), bytes.data(), type, geometry_, box,
             {samples.get(), ResidentBricks::row, ResidentBricks::slice});
    return {samples, static_cast<std::uint8_t>(coarser)};
}

}  // namespace palpate::stream

// Decoded pieces of a store. See the header.
#include "stream/loader/blocks.hpp"

#include "stream/box_bytes.hpp"

namespace palpate::stream {
namespace {

/// Calls `work(place, box)` for each piece of a level that holds samples of `box`.
template <class Work>
void for_each_whole(const Level& grid, const SampleBox& box, Work&& work) {
    const Index3 last = grid.geometry.size - Index3::Ones();
    for_each_piece(grid.chunk, box, [&](const Index3& at, const SampleBox&) {
        const Index3 low = at.cwiseProduct(grid.chunk);
        work(at, SampleBox{low, (low + grid.chunk - Index3::Ones()).cwiseMin(last)});
    });
}

}  // namespace

Blocks::Blocks(const Store& store, std::uint64_t most_bytes, std::shared_ptr<Loader> loader,
               For whom)
    : store_(store), most_bytes_(most_bytes), loader_(std::move(loader)), whom_(whom) {}

Blocks::~Blocks() {
    const std::scoped_lock lock(loader_->pieces_mutex_);
    for (const Key& key : ages_) loader_->kept_.erase(key);
}

void Blocks::read(int level, const SampleBox& box, const SampleBox& room, std::span<std::byte> out,
                  std::stop_token stop) {
    const SampleType type = store_.info().type;
    const auto put = [&](const SampleBox& own, const std::vector<std::byte>& bytes) {
        copy_box(own, bytes.data(), room, out.data(), size_of(type));
    };
    if (keeps(level)) {
        load(level, box, stop);
        for_each_whole(grid_of(level), box, [&](const Index3& at, const SampleBox& own) {
            put(own, *block(level, at, own, stop));
        });
    } else if (box == room) {
        store_.read(level, box, out, stop);
    } else {
        std::vector<std::byte> bytes(bytes_of(box, type));
        store_.read(level, box, bytes, stop);
        put(box, bytes);
    }
}

void Blocks::load(int level, const SampleBox& box, const std::stop_token& stop) {
    if (!keeps(level)) return;
    for_each_whole(grid_of(level), box, [&](const Index3& at, const SampleBox& own) {
        if (!has(level, at)) block(level, at, own, stop);
    });
}

const Level& Blocks::grid_of(int level) const {
    return store_.info().levels[static_cast<std::size_t>(level)];
}

/// False for pieces that are too large, and for rows, which cost nothing to read in parts.
bool Blocks::keeps(int level) const {
    const Index3& chunk = grid_of(level).chunk;
    const SampleBox piece{Index3::Zero(), chunk - Index3::Ones()};
    const bool is_row = chunk[1] == 1 && chunk[2] == 1;
    return !is_row && bytes_of(piece, store_.info().type) <= most_bytes_ / 4;
}

bool Blocks::has_all(int level, const SampleBox& box) const {
    bool all = keeps(level);
    if (!all) return false;
    const std::scoped_lock lock(loader_->pieces_mutex_);
    for_each_whole(grid_of(level), box, [&](const Index3& at, const SampleBox&) {
        const auto kept = loader_->kept_.find({level, at[0], at[1], at[2]});
        all = all && kept != loader_->kept_.end() &&
              kept->second.bytes.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    });
    return all;
}

bool Blocks::has_unread(int level, const SampleBox& box) const {
    bool unread = false;
    if (!keeps(level)) return unread;
    for_each_whole(grid_of(level), box,
                   [&](const Index3& at, const SampleBox&) { unread = unread || !has(level, at); });
    return unread;
}

void Blocks::read_one(int level, const SampleBox& box, std::stop_token stop) {
    bool found = false;
    for_each_whole(grid_of(level), box, [&](const Index3& at, const SampleBox& own) {
        if (found || has(level, at)) return;
        found = true;
        block(level, at, own, stop);
    });
}

/// True for a piece that is kept or that a thread reads now.
bool Blocks::has(int level, const Index3& at) const {
    const std::scoped_lock lock(loader_->pieces_mutex_);
    return loader_->kept_.contains({level, at[0], at[1], at[2]});
}

Blocks::Bytes Blocks::block(int level, const Index3& at, const SampleBox& box,
                            std::stop_token stop) {
    const Key key{level, at[0], at[1], at[2]};
    std::promise<Bytes> promise;
    std::shared_future<Bytes> others;
    {
        const std::scoped_lock lock(loader_->pieces_mutex_);
        const auto found = loader_->kept_.find(key);
        if (found != loader_->kept_.end()) {
            use(found->second);
            others = found->second.bytes;
        } else {
            ages_.push_front(key);
            const std::uint64_t size = bytes_of(box, store_.info().type);
            loader_->kept_[key] = {promise.get_future().share(), ages_.begin(), size, this};
            bytes_ += size;
        }
        forget_old(key);
    }
    const auto read = [&] {
        auto bytes = std::make_shared<std::vector<std::byte>>(bytes_of(box, store_.info().type));
        store_.read(level, box, *bytes, stop);
        return bytes;
    };
    if (others.valid()) {
        constexpr std::chrono::milliseconds between{20};
        while (others.wait_for(between) != std::future_status::ready) {
            if (stop.stop_requested()) throw Cancelled{};  // the other one may go on for long
        }
        if (Bytes bytes = others.get()) return bytes;
        // It failed; but another caller may have cancelled it, or it began before its cause was
        // mended.
        return read();
    }
    try {
        const Bytes bytes = read();
        promise.set_value(bytes);
        return bytes;
    } catch (...) {
        forget(key);
        promise.set_value(nullptr);  // an error is the reader's own, never shared by threads
        throw;
    }
}

/// Needs the lock. Makes a piece the newest, and a hand's own.
void Blocks::use(Kept& kept) {
    if (kept.owner != this && (whom_ == For::eyes || kept.owner->whom_ == For::hands)) return;
    ages_.splice(ages_.begin(), kept.owner->ages_, kept.age);
    kept.owner->bytes_ -= kept.size;
    kept.owner = this;
    bytes_ += kept.size;
}

void Blocks::forget(const Key& key) {
    const std::scoped_lock lock(loader_->pieces_mutex_);
    const auto found = loader_->kept_.find(key);
    if (found == loader_->kept_.end()) return;
    found->second.owner->bytes_ -= found->second.size;
    found->second.owner->ages_.erase(found->second.age);
    loader_->kept_.erase(found);
}

/// Needs the lock. Drops the own pieces that were not used for longest. Who reads one has its own
/// share of it.
void Blocks::forget_old(const Key& but) {
    while (bytes_ > most_bytes_ && ages_.back() != but) {
        const auto oldest = loader_->kept_.find(ages_.back());
        bytes_ -= oldest->second.size;
        loader_->kept_.erase(oldest);
        ages_.pop_back();
    }
}

std::uint64_t Blocks::bytes() const {
    const std::scoped_lock lock(loader_->pieces_mutex_);
    return bytes_;
}

}  // namespace palpate::stream

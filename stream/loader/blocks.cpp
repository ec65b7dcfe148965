// Decoded pieces of a store. See the header.
#include "stream/loader/blocks.hpp"

#include "stream/box_bytes.hpp"

namespace palpate::stream {

Blocks::Blocks(const Store& store, std::uint64_t most_bytes, std::shared_ptr<Loader> loader,
               For whom)
    : store_(store), most_bytes_(most_bytes), loader_(std::move(loader)), whom_(whom) {}

Blocks::~Blocks() {
    const std::scoped_lock lock(loader_->pieces_mutex_);
    for (const Key& key : ages_) loader_->kept_.erase(key);
}

/// Calls `work(piece)` for each piece that holds samples of a box. If pieces are not kept, the box
/// itself is one.
template <class Work>
void Blocks::for_each_stored(int level, const SampleBox& box, Work&& work) const {
    if (!keeps(level)) return work(box);
    for_each_piece(piece_of(level_of(store_, level)), box,
                   [&](const Index3&, const SampleBox& part) { work(whole(level, part)); });
}

void Blocks::read(int level, const SampleBox& box, const SampleBox& room, std::span<std::byte> out,
                  const std::stop_token& stop) {
    load(level, box, stop);
    for_each_stored(level, box, [&](const SampleBox& part) {
        const StoredPiece stored = piece(level, part, stop);
        copy_box(stored.box, stored.samples->data(), room, out.data(), size_of(store_.info().type));
    });
}

void Blocks::load(int level, const SampleBox& box, const std::stop_token& stop) {
    if (!keeps(level)) return;
    for_each_stored(level, box,
                    [&](const SampleBox& piece) { read_if_unread(level, piece, stop); });
}

bool Blocks::load_one(int level, const SampleBox& box, const std::stop_token& stop) {
    if (!keeps(level)) return false;
    bool is_done = false;
    for_each_stored(level, box, [&](const SampleBox& piece) {
        is_done = is_done || read_if_unread(level, piece, stop);
    });
    return is_done;
}

StoredPiece Blocks::piece(int level, const SampleBox& part, const std::stop_token& stop) {
    if (!keeps(level)) return {part, read_now(level, part, stop)};
    const SampleBox box = whole(level, part);
    return {box, block(level, box, stop)};
}

StoredPiece Blocks::kept(int level, const SampleBox& part) {
    const SampleBox box = whole(level, part);
    const std::scoped_lock lock(loader_->pieces_mutex_);
    const auto found = loader_->kept_.find(key_of(level, box));
    if (found == loader_->kept_.end() ||
        found->second.bytes.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
        return {};
    }
    use(found->second);
    return {box, found->second.bytes.get()};
}

bool Blocks::has_all(int level, const SampleBox& box) const {
    if (!keeps(level)) return true;
    bool all = true;
    const std::scoped_lock lock(loader_->pieces_mutex_);
    for_each_stored(level, box, [&](const SampleBox& piece) {
        all = all && loader_->kept_.contains(key_of(level, piece));
    });
    return all;
}

bool Blocks::keeps(int level) const {
    const Level& grid = level_of(store_, level);
    const SampleBox piece{Index3::Zero(), piece_of(grid) - Index3::Ones()};
    return !is_stored_in_rows(grid) && bytes_of(piece, store_.info().type) <= most_bytes_ / 4;
}

/// The piece that a part lies in.
SampleBox Blocks::whole(int level, const SampleBox& part) const {
    const Level& grid = level_of(store_, level);
    const Index3 piece = piece_of(grid);
    const Index3 low = part.low.cwiseQuotient(piece).cwiseProduct(piece);
    const Index3 last = grid.geometry.size - Index3::Ones();
    return {low, (low + piece - Index3::Ones()).cwiseMin(last)};
}

Blocks::Bytes Blocks::read_now(int level, const SampleBox& box, const std::stop_token& stop) const {
    auto bytes = std::make_shared<std::vector<std::byte>>(bytes_of(box, store_.info().type));
    store_.read(level, box, *bytes, stop);
    return bytes;
}

Blocks::Bytes Blocks::block(int level, const SampleBox& box, const std::stop_token& stop) {
    std::promise<Bytes> promise;
    const std::shared_future<Bytes> others = others_or_claim(level, box, promise);
    if (!others.valid()) return read_claimed(level, box, promise, stop);
    constexpr std::chrono::milliseconds between{20};
    while (others.wait_for(between) != std::future_status::ready) {
        if (stop.stop_requested()) throw Cancelled{};  // the other one may go on for long
    }
    if (Bytes bytes = others.get()) return bytes;
    // It failed; but another caller may have cancelled it, or it began before its cause was mended.
    return read_now(level, box, stop);
}

/// Whether it was neither kept nor being read.
bool Blocks::read_if_unread(int level, const SampleBox& box, const std::stop_token& stop) {
    std::promise<Bytes> promise;
    if (others_or_claim(level, box, promise).valid()) return false;
    read_claimed(level, box, promise, stop);
    return true;
}

/// The samples that are kept or that another thread reads. If there are none, nothing: the piece is
/// then the caller's to read, with read_claimed(), and others wait for `promise`.
std::shared_future<Blocks::Bytes> Blocks::others_or_claim(int level, const SampleBox& box,
                                                          std::promise<Bytes>& promise) {
    const Key key = key_of(level, box);
    const std::scoped_lock lock(loader_->pieces_mutex_);
    const auto found = loader_->kept_.find(key);
    if (found != loader_->kept_.end()) {
        use(found->second);
        std::shared_future<Bytes> others = found->second.bytes;
        forget_old(key);
        return others;
    }
    ages_.push_front(key);
    const std::uint64_t size = bytes_of(box, store_.info().type);
    loader_->kept_[key] = {promise.get_future().share(), ages_.begin(), size, this};
    bytes_ += size;
    forget_old(key);
    return {};
}

Blocks::Bytes Blocks::read_claimed(int level, const SampleBox& box, std::promise<Bytes>& promise,
                                   const std::stop_token& stop) {
    try {
        const Bytes bytes = read_now(level, box, stop);
        promise.set_value(bytes);
        return bytes;
    } catch (...) {
        forget(key_of(level, box));
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

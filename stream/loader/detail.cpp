// Boxes of a store for pictures. See the header.
#include "palpate/stream/detail.hpp"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>

#include "stream/box_bytes.hpp"
#include "stream/loader/blocks.hpp"
#include "stream/loader/upsample.hpp"

namespace palpate::stream {
namespace {

using Clock = std::chrono::steady_clock;

/// How often the reader's thread looks whether it is time to publish.
constexpr std::chrono::milliseconds look_again{30}, idle{500};
/// Pieces of a viewer that are read and not copied yet.
constexpr std::size_t most_read = 16;
/// Pieces of levels that are stored in rows: samples along each axis that are read at a time.
constexpr int piece_of_rows = 64;

void check(const Store& store, const DetailBox& of) {
    const SampleBox whole = whole_box(level_of(store, of.level).geometry);
    if (of.box.empty() || united(whole, of.box) != whole) {
        throw std::invalid_argument("a box that is empty or not inside its level");
    }
}

/// The box in parts as they are stored, the nearest to its middle first.
std::vector<SampleBox> parts_of(const Level& level, const SampleBox& box) {
    const Index3 piece =
        is_stored_in_rows(level) ? Index3(Index3::Constant(piece_of_rows)) : piece_of(level);
    std::vector<SampleBox> parts;
    for_each_piece(piece, box,
                   [&](const Index3&, const SampleBox& part) { parts.push_back(part); });
    const auto away = [&](const SampleBox& part) {
        return (part.low + part.high - box.low - box.high).cast<std::int64_t>().squaredNorm();
    };
    std::ranges::stable_sort(parts, {}, away);
    return parts;
}

/// A stored piece, as far as it lies in a box.
struct Piece {
    enum class State : std::uint8_t { waiting, reading, read, there, failed };

    SampleBox box;  // of the level's grid
    State state = State::waiting;
    Clock::time_point again = {};  // failed: not tried before
    StoredPiece stored = {};       // read
    // For the reader's thread:
    bool copied = false;  // its samples are in the box
    bool based = false;   // samples interpolated from the newest base are
};

/// The request of one viewer. Except for members of the reader's thread alone, its members need the
/// mutex of Parts.
struct Work {
    struct Stage {
        DetailBox of;
        std::vector<Piece> pieces;
        std::vector<std::byte> samples;  // of the reader's thread

        std::size_t count(Piece::State state) const {
            return static_cast<std::size_t>(std::ranges::count(pieces, state, &Piece::state));
        }
    };
    int viewer = 0;
    std::chrono::milliseconds interval{};
    std::vector<Stage> stages;  // coarse to fine
    std::size_t stage = 0;      // whose pieces are read, once those of the last that are kept are
    bool has_new = false;       // not published yet
    bool looked = false;        // for pieces of the last stage that are kept
    // For the reader's thread:
    Clock::time_point published = Clock::now();
    std::optional<Volume> base;  // of a coarser stage; none: the overview
    SampleBox changed;           // of the last stage's box, since it was published
    bool done = false;           // published with all its pieces

    Stage& last() { return stages.back(); }
    bool complete() const {
        return stages.back().count(Piece::State::there) == stages.back().pieces.size();
    }
    /// All of a coarse stage has come that will.
    bool has_base() const {
        const Stage& now = stages[stage];
        return !complete() && stage + 1 < stages.size() &&
               now.count(Piece::State::there) + now.count(Piece::State::failed) ==
                   now.pieces.size();
    }
};

}  // namespace

/// Interpolates a box of `grid`, all of whose samples are in `out`.
void interpolate_into(const Volume& coarse, const Geometry& grid, const SampleBox& box,
                      std::byte* out) {
    const std::ptrdiff_t row = grid.size[0], slice = row * grid.size[1];
    std::byte* const first = out + place_in(whole_box(grid), box.low) * size_of(coarse.type());
    upsample(coarse.geometry(), static_cast<const std::byte*>(coarse.data()), coarse.type(), grid,
             box, {first, row, slice});
}

struct DetailReader::Parts {
    Parts(std::shared_ptr<const Store> store, Volume overview, DetailSettings settings, Made made)
        : store_(std::move(store)),
          overview_(std::move(overview)),
          made_(std::move(made)),
          loader_(loader_for(settings.shared, settings.threads)),
          blocks_(*store_, settings.memory, loader_, For::eyes),
          reading_(*loader_, For::eyes, [this](bool) { return next(); }),
          thread_([this, begin = std::move(settings.begin_thread)](const std::stop_token& stop) {
              if (begin) begin();
              run(stop);
          }) {}

    void want(int viewer, const std::vector<DetailBox>& coarse_to_fine,
              std::chrono::milliseconds interval) {
        if (coarse_to_fine.empty()) throw std::invalid_argument("no box");
        auto work = std::make_shared<Work>();
        work->viewer = viewer;
        work->interval = interval;
        for (const DetailBox& of : coarse_to_fine) {
            check(*store_, of);
            Work::Stage stage{of, {}, {}};
            for (const SampleBox& part : parts_of(level_of(*store_, of.level), of.box)) {
                stage.pieces.push_back({part});
            }
            work->stages.push_back(std::move(stage));
        }
        const std::scoped_lock lock(mutex_);
        work_[viewer] = std::move(work);
        ++news_;
        changed_.notify_all();
    }

    DetailStatus status() {
        DetailStatus status;
        status.bytes = blocks_.bytes();
        const auto fails = [](const Piece& piece) {  // also while it is tried again
            return piece.state != Piece::State::there && piece.again != Clock::time_point{};
        };
        const std::scoped_lock lock(mutex_);
        for (const auto& [viewer, work] : work_) {
            const std::size_t first = work->complete() ? work->stages.size() - 1 : work->stage;
            for (std::size_t i = first; i < work->stages.size(); ++i) {
                const Work::Stage& stage = work->stages[i];
                status.wanted += stage.pieces.size();
                status.missing += stage.pieces.size() - stage.count(Piece::State::there);
                status.coming += stage.count(Piece::State::reading);
                status.failed += stage.count(Piece::State::failed);
                if (std::ranges::any_of(stage.pieces, fails)) status.problem = problem_;
            }
        }
        return status;
    }

    /// The next piece that a thread of the store reads: stage by stage.
    Turn next() {
        const std::scoped_lock lock(mutex_);
        const Clock::time_point now = Clock::now();
        for (const auto& [viewer, work] : work_) {
            Work::Stage& stage = work->stages[work->stage];
            if (!work->looked || work->complete() || stage.count(Piece::State::read) >= most_read) {
                continue;
            }
            for (Piece& piece : stage.pieces) {
                const bool again = piece.state == Piece::State::failed && piece.again <= now &&
                                   work->stage + 1 == work->stages.size();
                if (piece.state != Piece::State::waiting && !again) continue;
                Turn turn;
                // clang 14 captures no name of a structured binding.
                turn.job = [this, held = work, &stage, &piece](const std::stop_token& stop) {
                    read(stage, piece, stop);
                };
                piece.state = Piece::State::reading;
                return turn;
            }
        }
        return {};
    }

    void run(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
            const std::uint64_t known = news_;
            if (step(lock)) continue;
            const bool has_new =
                std::ranges::any_of(work_, [](const auto& each) { return each.second->has_new; });
            changed_.wait_for(lock, stop, has_new ? look_again : idle,
                              [&] { return news_ != known; });
        }
    }

    /// Needs the lock. Does one thing that waits for no read: copies a piece that was read,
    /// publishes, makes the base of a stage, or takes pieces of the last stage that are kept.
    bool step(std::unique_lock<std::mutex>& lock) {
        const auto unlocked = [&](const auto& what) {
            lock.unlock();
            bool done = false;
            try {
                what();
                done = true;
            } catch (const std::exception&) {  // no memory: what is shown stays
            }
            lock.lock();
            return done;
        };
        for (const auto& [viewer, held] : work_) {
            const std::shared_ptr<Work> work = held;
            for (Work::Stage& stage : work->stages) {
                const auto piece =
                    std::ranges::find(stage.pieces, Piece::State::read, &Piece::state);
                if (piece == stage.pieces.end()) continue;
                if (unlocked([&] { put(*work, stage, *piece); })) {
                    piece->state = Piece::State::there;
                    work->has_new = work->has_new || &stage == &work->last();
                } else {
                    fail(*piece, "no memory");  // so short that it needs none
                }
                if (stage.count(Piece::State::read) + 1 == most_read) loader_->wake();
                return true;
            }
            const bool waited = Clock::now() - work->published >= work->interval;
            if (work->has_new && (work->complete() || waited)) {
                work->has_new = false;
                unlocked([&] { publish(*work); });
                work->published = Clock::now();
                return true;
            }
            if (work->has_base()) {
                unlocked([&] { make_base(*work); });
                ++work->stage;
                work->has_new = true;
                loader_->wake();
                return true;
            }
            if (work->looked) continue;
            if (take_kept(work->last())) return true;
            work->looked = true;
            loader_->wake();
        }
        return false;
    }

    /// Needs the lock. Some pieces that are in memory, if there are any: nothing is read for them,
    /// even if they are dropped meanwhile.
    bool take_kept(Work::Stage& stage) {
        std::size_t taken = 0;
        for (Piece& piece : stage.pieces) {
            if (piece.state != Piece::State::waiting || taken == most_read) continue;
            piece.stored = blocks_.kept(stage.of.level, piece.box);
            if (!piece.stored.samples) continue;
            piece.state = Piece::State::read;
            ++taken;
        }
        return taken > 0;
    }

    void read(const Work::Stage& stage, Piece& piece, const std::stop_token& stop) {
        StoredPiece stored;
        std::string problem;
        try {
            stored = blocks_.piece(stage.of.level, piece.box, stop);
        } catch (const Cancelled&) {
            return;  // the reader ends
        } catch (const std::exception& e) {
            problem = text_of(e);
        }
        const std::scoped_lock lock(mutex_);
        if (stored.samples) {
            piece.stored = std::move(stored);
            piece.state = Piece::State::read;
        } else {
            fail(piece, std::move(problem));
        }
        ++news_;
        changed_.notify_all();
    }

    /// Needs the lock.
    void fail(Piece& piece, std::string problem) {
        piece.state = Piece::State::failed;
        piece.again = Clock::now() + pause_after_failure;
        problem_ = std::move(problem);
    }

    /// Copies a piece that was read.
    void put(Work& work, Work::Stage& stage, Piece& piece) const {
        const StoredPiece stored = std::move(piece.stored);
        stage.samples.resize(bytes_of(stage.of.box, store_->info().type));
        copy_box(stored.box, stored.samples->data(), stage.of.box, stage.samples.data(),
                 size_of(store_->info().type));
        piece.copied = true;
        if (&stage == &work.last()) work.changed = united(work.changed, piece.box);
    }

    Geometry grid_of(const DetailBox& of) const {
        return geometry_of(level_of(*store_, of.level).geometry, of.box);
    }

    /// Makes the missing parts of the last stage from the coarse one.
    void make_base(Work& work) const {
        Work::Stage& stage = work.stages[work.stage];
        fill(work, stage);
        work.base = volume_from(grid_of(stage.of), store_->info().type, std::move(stage.samples));
        for (Piece& piece : work.last().pieces) {
            piece.based = false;
            if (!piece.copied) work.changed = united(work.changed, piece.box);
        }
    }
    /// Interpolates the missing parts of a stage from the base, which is coarser. Returns the
    /// number of missing pieces.
    std::size_t fill(const Work& work, Work::Stage& stage) const {
        const Geometry grid = grid_of(stage.of);
        const Index3 low = stage.of.box.low;
        stage.samples.resize(bytes_of(stage.of.box, store_->info().type));
        std::size_t missing = 0;
        for (Piece& piece : stage.pieces) {
            missing += !piece.copied;
            if (piece.copied || piece.based) continue;
            interpolate_into(work.base ? *work.base : overview_, grid,
                             {piece.box.low - low, piece.box.high - low}, stage.samples.data());
            piece.based = true;
        }
        return missing;
    }

    void publish(Work& work) {
        if (work.done) return;
        Work::Stage& last = work.last();
        const std::size_t missing = fill(work, last);
        const Index3 low = last.of.box.low;
        SampleBox changed;
        if (!work.changed.empty()) changed = {work.changed.low - low, work.changed.high - low};
        work.changed = {};
        work.done = missing == 0;  // nothing is added to it
        std::vector<std::byte> samples = work.done ? std::move(last.samples) : last.samples;
        made_(work.viewer,
              {last.of, volume_from(grid_of(last.of), store_->info().type, std::move(samples)),
               last.pieces.size(), missing, changed});
    }

    const std::shared_ptr<const Store> store_;
    const Volume overview_;
    const Made made_;
    const std::shared_ptr<Loader> loader_;
    Blocks blocks_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::map<int, std::shared_ptr<Work>> work_;  // of each viewer
    std::uint64_t news_ = 0;                     // counts what may be a reason to go on
    std::string problem_;
    const Reading reading_;  // last, as the thread: they use all of the above
    std::jthread thread_;
};

DetailReader::DetailReader(std::shared_ptr<const Store> store, Volume overview,
                           DetailSettings settings, Made made)
    : parts_(std::make_unique<Parts>(std::move(store), std::move(overview), std::move(settings),
                                     std::move(made))) {}

DetailReader::~DetailReader() = default;

void DetailReader::want(int viewer, const std::vector<DetailBox>& coarse_to_fine,
                        std::chrono::milliseconds interval) {
    parts_->want(viewer, coarse_to_fine, interval);
}
void DetailReader::forget(int viewer) {
    const std::scoped_lock lock(parts_->mutex_);
    parts_->work_.erase(viewer);
}
DetailStatus DetailReader::status() const {
    return parts_->status();
}

}  // namespace palpate::stream

// Boxes of a store for pictures. See the header.
#include "palpate/stream/detail.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "stream/box_bytes.hpp"
#include "stream/loader/blocks.hpp"
#include "stream/loader/upsample.hpp"
#include "stream/sample_bytes.hpp"

namespace palpate::stream {
namespace {

using Clock = std::chrono::steady_clock;

/// How often threads look whether they may go on.
constexpr std::chrono::milliseconds look_again{30}, idle{500};
/// Of rows, which have no pieces worth keeping: samples along each axis that are read at a time.
constexpr int piece_of_rows = 64;

const Geometry& grid_of(const Store& store, const DetailBox& of) {
    return store.info().levels[static_cast<std::size_t>(of.level)].geometry;
}

Index3 size_of(const SampleBox& box) {
    return box.high - box.low + Index3::Ones();
}

std::size_t count_of(const SampleBox& box) {
    return static_cast<std::size_t>(size_of(box).cast<std::int64_t>().prod());
}

void check(const Store& store, const DetailBox& of) {
    const auto levels = static_cast<int>(store.info().levels.size());
    if (of.level < 0 || of.level >= levels) {
        throw std::invalid_argument("a level that the store does not have");
    }
    const SampleBox whole = whole_box(grid_of(store, of));
    if (of.box.empty() || united(whole, of.box) != whole) {
        throw std::invalid_argument("a box that is empty or not inside its level");
    }
}

/// The box in parts as they are stored, the nearest to its middle first.
std::vector<SampleBox> parts_of(const Level& level, const SampleBox& box) {
    const bool is_row = level.chunk[1] == 1 && level.chunk[2] == 1;
    const Index3 chunk = is_row ? Index3::Constant(piece_of_rows) : level.chunk;
    std::vector<SampleBox> parts;
    for_each_piece(chunk, box,
                   [&](const Index3&, const SampleBox& part) { parts.push_back(part); });
    const auto away = [&](const SampleBox& part) {
        return (part.low + part.high - box.low - box.high).cast<std::int64_t>().squaredNorm();
    };
    std::ranges::stable_sort(parts, {}, away);
    return parts;
}

Volume volume_of(const Geometry& geometry, SampleType type, std::vector<std::byte> bytes) {
    const auto held = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
    return {geometry, type, std::shared_ptr<const void>(held, held->data()), held->size()};
}

}  // namespace

/// A stored piece, as far as it lies in a box.
struct DetailReader::Piece {
    enum class State : std::uint8_t { waiting, reading, there, failed };

    SampleBox box;  // of the level's grid
    State state = State::waiting;
    Clock::time_point again = {};  // failed: not tried before
    // With Work::content:
    bool copied = false;  // its samples are in the box
    bool based = false;   // samples interpolated from the newest base are
};

/// What one viewer wants. But for `content`'s, its members need the reader's mutex.
struct DetailReader::Work {
    struct Stage {
        DetailBox of;
        std::vector<Piece> pieces;
        std::vector<std::byte> samples;  // content

        bool has(Piece::State state) const {
            return std::ranges::any_of(pieces, [&](const Piece& p) { return p.state == state; });
        }
        std::size_t count(Piece::State state) const {
            return static_cast<std::size_t>(std::ranges::count(pieces, state, &Piece::state));
        }
    };
    int viewer = 0;
    std::chrono::milliseconds interval{};
    std::vector<Stage> stages;  // coarse to fine
    std::size_t stage = 0;      // whose pieces are read, once those of the last that are kept are
    bool has_new = false;       // not published yet
    bool publishing = false;
    bool looked = false;  // for pieces of the last stage that are kept
    Clock::time_point published = Clock::now();

    std::mutex content;
    std::optional<Volume> base;  // content: of a coarser stage; none: the overview
    SampleBox changed;           // content: of the last stage's box, since it was published
    bool done = false;           // content: published with all its pieces

    Stage& last() { return stages.back(); }
    bool complete() const {
        return stages.back().count(Piece::State::there) == stages.back().pieces.size();
    }
};

/// Interpolates a box of `grid`, all of whose samples are in `out`.
void interpolate_into(const Volume& coarse, const Geometry& grid, const SampleBox& box,
                      std::byte* out) {
    const std::ptrdiff_t row = grid.size[0], slice = row * grid.size[1];
    const std::ptrdiff_t first = box.low[0] + box.low[1] * row + box.low[2] * slice;
    const auto each = static_cast<std::ptrdiff_t>(palpate::size_of(coarse.type()));
    upsample(coarse.geometry(), static_cast<const std::byte*>(coarse.data()), coarse.type(), grid,
             box, {out + first * each, row, slice});
}

DetailReader::DetailReader(std::shared_ptr<const Store> store, Volume overview,
                           DetailSettings settings, Made made)
    : store_(std::move(store)),
      overview_(std::move(overview)),
      settings_(std::move(settings)),
      made_(std::move(made)),
      blocks_(std::make_unique<Blocks>(*store_, settings_.memory, settings_.pieces, For::eyes)) {
    for (int i = 0; i < std::max(1, settings_.threads); ++i) {
        threads_.emplace_back([this](const std::stop_token& stop) { run(stop); });
    }
}

DetailReader::~DetailReader() {
    for (std::jthread& thread : threads_) thread.request_stop();
    changed_.notify_all();
    threads_.clear();
}

void DetailReader::want(int viewer, const std::vector<DetailBox>& coarse_to_fine,
                        std::chrono::milliseconds interval) {
    if (coarse_to_fine.empty()) throw std::invalid_argument("no box");
    auto work = std::make_shared<Work>();
    work->viewer = viewer;
    work->interval = interval;
    for (const DetailBox& of : coarse_to_fine) {
        check(*store_, of);
        const Level& level = store_->info().levels[static_cast<std::size_t>(of.level)];
        Work::Stage stage{of, {}, {}};
        for (const SampleBox& part : parts_of(level, of.box)) stage.pieces.push_back({part});
        work->stages.push_back(std::move(stage));
    }
    const std::scoped_lock lock(mutex_);
    work_[viewer] = std::move(work);
    ++news_;
    changed_.notify_all();
}

void DetailReader::forget(int viewer) {
    const std::scoped_lock lock(mutex_);
    work_.erase(viewer);
}

DetailStatus DetailReader::status() const {
    DetailStatus status;
    status.bytes = blocks_->bytes();
    const std::scoped_lock lock(mutex_);
    for (const auto& [viewer, work] : work_) {
        const std::size_t first = work->complete() ? work->stages.size() - 1 : work->stage;
        for (std::size_t i = first; i < work->stages.size(); ++i) {
            const Work::Stage& stage = work->stages[i];
            status.wanted += stage.pieces.size();
            status.missing += stage.pieces.size() - stage.count(Piece::State::there);
            status.coming += stage.count(Piece::State::reading);
            status.failed += stage.count(Piece::State::failed);
        }
    }
    if (status.failed > 0) status.problem = problem_;
    return status;
}

/// Needs the lock. Of the last stage what is kept already; then stage by stage.
std::optional<DetailReader::Job> DetailReader::piece_of(const std::shared_ptr<Work>& work,
                                                        bool may_ask) {
    Work::Stage& last = work->last();
    for (Piece& piece : last.pieces) {
        if (work->looked || piece.state != Piece::State::waiting) continue;
        if (!blocks_->has_unread(last.of.level, piece.box)) return Job{work, &piece, false};
    }
    work->looked = true;
    if (!may_ask || work->complete()) return std::nullopt;
    Work::Stage& stage = work->stages[work->stage];
    const Clock::time_point now = Clock::now();
    for (Piece& piece : stage.pieces) {
        const bool again = piece.state == Piece::State::failed && piece.again <= now &&
                           work->stage + 1 == work->stages.size();
        if (piece.state == Piece::State::waiting || again) return Job{work, &piece, true};
    }
    return std::nullopt;
}

/// Needs the lock.
std::optional<DetailReader::Job> DetailReader::next_job() {
    if (work_.empty()) return std::nullopt;
    const int most = settings_.most_at_a_time ? settings_.most_at_a_time() : settings_.threads;
    for (const auto& [viewer, work] : work_) {
        const bool waited = Clock::now() - work->published >= work->interval;
        if (work->has_new && !work->publishing && (work->complete() || waited)) return Job{work};
        if (auto job = piece_of(work, reading_ < most)) return job;
    }
    return std::nullopt;
}

void DetailReader::run(const std::stop_token& stop) {
    if (settings_.begin_thread) settings_.begin_thread();
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        const std::optional<Job> job = next_job();
        if (!job) {
            changed_.wait_for(lock, stop, work_.empty() ? idle : look_again,
                              [this, known = news_] { return news_ != known; });
            continue;
        }
        if (job->piece) {
            job->piece->state = Piece::State::reading;
            reading_ += job->asks;
            lock.unlock();
            read(*job, stop);
        } else {
            job->work->publishing = true;
            job->work->has_new = false;
            lock.unlock();
            try {
                publish(*job->work);
            } catch (const std::exception&) {  // no memory: what is shown stays
            }
        }
        lock.lock();
        if (job->piece) {
            reading_ -= job->asks;
        } else {
            job->work->publishing = false;
            job->work->published = Clock::now();
        }
        ++news_;
        changed_.notify_all();
    }
}

void DetailReader::read(const Job& job, const std::stop_token& stop) {
    Work& work = *job.work;
    Piece& piece = *job.piece;
    const auto stage = std::ranges::find_if(work.stages, [&](const Work::Stage& s) {
        return &piece >= s.pieces.data() && &piece < s.pieces.data() + s.pieces.size();
    });
    const SampleType type = store_->info().type;
    const std::size_t each = palpate::size_of(type);
    std::string problem;
    try {
        std::vector<std::byte> bytes(count_of(piece.box) * each);
        blocks_->read(stage->of.level, piece.box, bytes, stop);
        make_finite(type, bytes, overview_.minimum());
        const std::scoped_lock content(work.content);
        stage->samples.resize(count_of(stage->of.box) * each);
        copy_box(piece.box, bytes.data(), stage->of.box, stage->samples.data(), each);
        piece.copied = true;
        if (stage + 1 == work.stages.end()) work.changed = united(work.changed, piece.box);
    } catch (const Cancelled&) {
        return;  // the reader ends
    } catch (const std::exception& e) {
        problem = e.what();
    }
    bool ends = false;
    {
        const std::scoped_lock lock(mutex_);
        piece.state = problem.empty() ? Piece::State::there : Piece::State::failed;
        if (problem.empty()) {
            work.has_new = work.has_new || stage + 1 == work.stages.end();
        } else {
            piece.again = Clock::now() + pause_after_failure;
            problem_ = problem;
        }
        const bool current = stage - work.stages.begin() == std::ptrdiff_t(work.stage);
        ends = current && stage + 1 != work.stages.end() && !stage->has(Piece::State::waiting) &&
               !stage->has(Piece::State::reading);
    }
    if (ends) end_stage(work);
}

/// All of a coarse stage has come that will: what is missing of the last is made of it.
void DetailReader::end_stage(Work& work) {
    try {
        make_base(work);
    } catch (const std::bad_alloc&) {  // the base of before stays
    }
    const std::scoped_lock lock(mutex_);
    ++work.stage;
    work.has_new = true;
}

void DetailReader::make_base(Work& work) const {
    Work::Stage& stage = work.stages[work.stage];
    const Geometry grid = geometry_of(grid_of(*store_, stage.of), stage.of.box);
    const std::scoped_lock content(work.content);
    {
        const SampleType type = store_->info().type;
        stage.samples.resize(count_of(stage.of.box) * palpate::size_of(type));
        for (const Piece& piece : stage.pieces) {
            if (piece.copied) continue;
            const Index3 low = stage.of.box.low;
            interpolate_into(work.base ? *work.base : overview_, grid,
                             {piece.box.low - low, piece.box.high - low}, stage.samples.data());
        }
        work.base = volume_of(grid, type, std::move(stage.samples));
        for (Piece& piece : work.last().pieces) {
            piece.based = false;
            if (!piece.copied) work.changed = united(work.changed, piece.box);
        }
    }
}

void DetailReader::publish(Work& work) {
    Work::Stage& last = work.last();
    const Geometry grid = geometry_of(grid_of(*store_, last.of), last.of.box);
    const SampleType type = store_->info().type;
    const Index3 low = last.of.box.low;
    std::size_t missing = 0;
    std::vector<std::byte> samples;
    SampleBox changed;
    {
        const std::scoped_lock content(work.content);
        if (work.done) return;
        last.samples.resize(count_of(last.of.box) * palpate::size_of(type));
        for (Piece& piece : last.pieces) {
            missing += !piece.copied;
            if (piece.copied || piece.based) continue;
            interpolate_into(work.base ? *work.base : overview_, grid,
                             {piece.box.low - low, piece.box.high - low}, last.samples.data());
            piece.based = true;
        }
        if (!work.changed.empty()) changed = {work.changed.low - low, work.changed.high - low};
        work.changed = {};
        work.done = missing == 0;  // nothing is added to it
        samples = work.done ? std::move(last.samples) : last.samples;
    }
    made_(work.viewer, {last.of, volume_of(grid, type, std::move(samples)), last.pieces.size(),
                        missing, changed});
}

}  // namespace palpate::stream

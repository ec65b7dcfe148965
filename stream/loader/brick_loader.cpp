// Keeps the bricks around the hands in memory: chooses the next one to read and the one to drop,
// and publishes versions.
#include "stream/loader/brick_loader.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "stream/loader/interest.hpp"

namespace palpate::stream {
namespace {

constexpr std::size_t fewest_bricks = 64;
/// Whose memory is kept for the next ones.
constexpr std::size_t most_free_bricks = 16;
/// Just made, or dropped and still in use.
constexpr std::size_t most_left_bricks = 32;
constexpr std::chrono::milliseconds pause_when_behind{2}, time_to_let_go{20};
/// Part of the memory for decoded pieces.
constexpr std::uint64_t pieces_part = 4;
/// Bricks that the hands need first: a cube of three around one.
constexpr std::size_t most_urgent = 27;
/// Weight of the last brick in the mean time that a brick takes.
constexpr double newest_part = 0.2;
/// With coarse_first: of the hands' speed [s].
constexpr double speed_smoothing = 0.2;
/// The greatest speed that counts [bricks/s].
constexpr double most_speed = 1e6;
/// With coarse_first: bricks that come at both levels before all others.
constexpr std::size_t most_soon = 125;
/// Interval between measurements of the memory of the process.
constexpr std::chrono::milliseconds between_counts{5};
/// Part of it that is left for dropped memory that the system still counts, and for reads that are
/// under way.
constexpr std::uint64_t spare_part = 10;

std::uint64_t bytes_of_brick(SampleType type) {
    return ResidentBricks::per_brick * size_of(type);
}

std::size_t most_bricks(const Store& store, std::uint64_t memory) {
    const std::uint64_t each = bytes_of_brick(store.info().type);
    const auto count = static_cast<std::size_t>((memory - memory / pieces_part) / each);
    if (count < fewest_bricks) {
        throw std::invalid_argument(
            "at least " + std::to_string(fewest_bricks * each * 4 / 3 / 1000000 + 1) +
            " MB of memory are needed to touch " + io::without_secrets(store.info().address));
    }
    return count;
}

/// A kilobyte of metadata can declare a table of bricks of gigabytes.
void check_table(const Store& store, int level, std::uint64_t memory) {
    constexpr double along = ResidentBricks::edge * 16, bytes = 16;  // of a page and its pointer
    constexpr std::uint64_t table_part = 16;
    const Index3& size = level_of(store, level).geometry.size;
    const double table = bytes * (size.cast<double>() / along).array().ceil().prod();
    if (table <= static_cast<double>(memory / table_part)) return;
    throw io::InputError(store.info().address + ": level " + std::to_string(level) + " has " +
                         std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
                         std::to_string(size[2]) + " samples, too many to touch with " +
                         std::to_string(memory / 1000000) +
                         " MB of memory; allow more, or take a coarser level");
}

}  // namespace

std::shared_ptr<const Samples> empty_samples(const Store& store, const Volume& overview, int level,
                                             std::uint64_t memory) {
    check_table(store, level, memory);
    const Geometry& geometry = level_of(store, level).geometry;
    const Range range = store.info().range.value_or(Range{overview.minimum(), overview.maximum()});
    return std::make_shared<const Samples>(overview, geometry, ResidentBricks(geometry.size),
                                           range.minimum, range.maximum);
}

BrickLoader::Parts::Parts(std::shared_ptr<const Store> store, Volume overview,
                          const BrickLoaderSettings& settings)
    : store_(std::move(store)),
      settings_(settings),
      overview_(std::move(overview)),
      empty_(empty_samples(*store_, overview_, settings.level, settings.memory)),
      geometry_(empty_->geometry()),
      most_bricks_(most_bricks(*store_, settings.memory)),
      loader_(loader_for(settings.shared, settings.threads)),
      blocks_(
          std::make_unique<Blocks>(*store_, settings.memory / pieces_part, loader_, For::hands)),
      memory_(std::make_unique<BrickMemory>(bytes_of_brick(store_->info().type), most_free_bricks)),
      bricks_(geometry_.size),
      reading_(*loader_, For::hands, [this](bool urgent) { return next(urgent); }) {}

void BrickLoader::Parts::look(std::span<const Interest> hands, Clock::time_point now) {
    double seconds = 0;
    {
        const std::scoped_lock lock(mutex_);
        choose_levels(hands, now);
        seconds = std::ldexp(brick_s_, -finest_);
    }
    std::vector<Index3> wanted = wanted_bricks(geometry_, empty_->resident()->count(), hands,
                                               most_bricks_ - most_bricks_ / 8, seconds);
    const std::scoped_lock lock(mutex_);
    want(std::move(wanted));
    const auto to_do = [&](const Index3& brick) { return !has(brick, finest_); };
    if (std::ranges::any_of(wanted_, to_do)) wake();  // not 200 times a second for nothing
}

/// Needs the lock. Threads without a job look again, and so does who waits.
void BrickLoader::Parts::wake() {
    loader_->wake();
    changed_.notify_all();
}

std::optional<BrickVersion> BrickLoader::Parts::take() {
    const std::scoped_lock lock(mutex_);
    if (events_.empty()) return std::nullopt;
    std::vector<ResidentBricks::Change> changes;
    for (const BrickEvent& event : events_) {
        const auto held = held_.find(event.brick);
        changes.push_back({event.brick, held == held_.end() ? Brick{} : held->second});
    }
    bricks_ = bricks_.with(changes);
    BrickVersion version{std::make_shared<const Samples>(overview_, geometry_, bricks_,
                                                         empty_->minimum(), empty_->maximum()),
                         std::move(events_)};
    events_.clear();
    return version;
}

void BrickLoader::Parts::wait_for(const Vec3& centre, double radius, const std::stop_token& stop) {
    std::vector<Index3> needed = bricks_round(geometry_, centre, radius);
    const std::size_t room = most_bricks_ - most_bricks_ / 8;
    if (needed.size() > room) {
        throw std::invalid_argument(io::without_secrets(store_->info().address) +
                                    ": a stroke needs more samples at a time than fit into " +
                                    std::to_string(settings_.memory / 1000000) +
                                    " MB: allow more memory or touch a coarser level");
    }
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop, [&] {
        std::size_t bricks = needed.size();
        for (const Waiting& other : waiting_) bricks += other.needed.size();
        return waiting_.empty() || bricks <= room;
    });
    for (const Index3& brick : needed) failed_.erase(brick);
    const auto own = waiting_.insert(waiting_.end(), {std::move(needed), ++waits_, {}});
    want({});
    wake();
    const bool ended = changed_.wait(lock, stop, [&] {
        return !own->problem.empty() ||
               std::ranges::all_of(own->needed, [&](const auto& brick) { return has(brick, 0); });
    });
    const std::string problem = std::move(own->problem);
    waiting_.erase(own);
    wake();
    if (!ended) throw Cancelled{};
    if (!problem.empty()) throw io::InputError(problem);
}

BrickLoaderStatus BrickLoader::Parts::status() const {
    BrickLoaderStatus status;
    status.traffic = store_->traffic();
    const std::scoped_lock lock(mutex_);
    status.resident = held_.size();
    status.wanted = wanted_.size();
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
        const bool missing = !held_.contains(wanted_[i]);
        status.missing += missing;
        status.urgent += missing && i < most_urgent;
    }
    status.bytes = bytes();
    status.most_bytes = std::max(most_bytes_, status.bytes);
    status.loaded = loaded_;
    status.dropped = dropped_;
    status.problem = problem_;
    return status;
}

/// Needs the lock.
void BrickLoader::Parts::choose_levels(std::span<const Interest> hands, Clock::time_point now) {
    if (!settings_.coarse_first) return;
    double speed = 0;
    for (const Interest& hand : hands) {
        const Vec3 bricks = (geometry_.direction.transpose() * hand.velocity)
                                .cwiseQuotient(geometry_.spacing * ResidentBricks::edge);
        if (bricks.allFinite()) speed = std::max(speed, std::min(bricks.norm(), most_speed));
    }
    const int coarsest = static_cast<int>(store_->info().levels.size()) - 1 - settings_.level;
    // If a force releases a hand, the hand jumps for a moment.
    const double passed = std::chrono::duration<double>(now - looked_).count();
    speed_ += std::min(1.0, passed / speed_smoothing) * (speed - speed_);
    looked_ = now;
    const LevelChoice choice = levels_for(speed_, brick_s_, coarsest);
    first_ = choice.first;
    finest_ = choice.finest;
}

/// Needs the lock. The most urgent brick of which something is to be read: all threads work for the
/// first, so that it is there soon. `urgent`: nothing unless it is among the first.
std::optional<BrickLoader::Parts::Job> BrickLoader::Parts::next_job(bool urgent) {
    const bool exact = !waiting_.empty();
    const int first = exact ? 0 : first_, finest = exact ? 0 : finest_;
    // First something everywhere near, then the level that is felt; where the hands are soon, both
    // come before anything elsewhere.
    struct Round {
        std::size_t begin, end;
        int level;
    };
    const std::size_t all = wanted_.size(), soon = std::min(all, most_soon);
    const std::array<Round, 4> rounds{
        {{0, soon, first}, {0, soon, finest}, {soon, all, first}, {soon, all, finest}}};
    const Clock::time_point now = Clock::now();
    for (std::size_t n = 0; n < rounds.size(); ++n) {
        const Round& round = rounds[n];
        std::size_t& begun = begun_[n];
        begun = std::max(begun, round.begin);
        while (begun < round.end && has(wanted_[begun], round.level)) ++begun;
        for (std::size_t i = begun; i < round.end; ++i) {
            auto job = job_for(wanted_[i], round.level, now);
            if (job) return urgent && i >= most_urgent ? std::nullopt : job;
        }
    }
    return std::nullopt;
}

/// Needs the lock, and that next_job() has looked. Of the threads, those that may read for eyes:
/// few while the hands' memory is filled, one while what they need at once is missing.
int BrickLoader::Parts::for_eyes() const {
    const std::size_t all = wanted_.size();
    if (begun_[0] < std::min(all, most_urgent)) return 1;
    return begun_[1] < std::min(all, most_soon) || begun_[3] < all ? 3 : Turn{}.for_eyes;
}

/// Needs the lock. What is to be done for a brick, if anything.
std::optional<BrickLoader::Parts::Job> BrickLoader::Parts::job_for(const Index3& brick, int level,
                                                                   Clock::time_point now) const {
    if (has(brick, level)) return std::nullopt;
    const auto failed = failed_.find(brick);
    if (failed != failed_.end() && now < failed->second) return std::nullopt;
    const auto read = in_flight_.find(brick);
    if (read == in_flight_.end()) return Job{brick, level, false};
    const int coarser = read->second;
    if (has_all(brick, coarser)) return std::nullopt;
    return Job{brick, coarser, true};
}

/// Needs the lock. Whether a brick is in memory at a level, or at a finer one.
bool BrickLoader::Parts::has(const Index3& brick, int level) const {
    const auto held = held_.find(brick);
    return held != held_.end() && held->second.level <= level;
}

/// Needs the lock. Bricks that a caller waits for come first, whatever the hands need.
void BrickLoader::Parts::want(std::vector<Index3> bricks) {
    wanted_.clear();
    for (const Waiting& waiting : waiting_) {
        wanted_.insert(wanted_.end(), waiting.needed.begin(), waiting.needed.end());
    }
    wanted_.insert(wanted_.end(), bricks.begin(), bricks.end());
    begun_ = {};
}

/// Needs the lock. Older versions are released when the next one comes, so it never waits
/// long.
bool BrickLoader::Parts::is_behind() const {
    return waiting_.empty() && memory_->used() > held_.size() + most_left_bricks &&
           Clock::now() - newest_ < time_to_let_go;
}

Turn BrickLoader::Parts::next(bool urgent) {
    const std::scoped_lock lock(mutex_);
    if (is_behind()) return {.pause = pause_when_behind};
    const std::optional<Job> job = next_job(urgent);
    Turn turn{.for_eyes = for_eyes()};
    if (job && job->helps) {
        turn.job = [this, job = *job](const std::stop_token& stop) { help(job, stop); };
    } else if (job) {
        turn.job = [this, job = *job, waits = waits_](const std::stop_token& stop) {
            make(job, waits, stop);
        };
        in_flight_[job->brick] = job->coarser;
    }
    return turn;
}

/// `waits`: calls of wait_for() before this began.
void BrickLoader::Parts::make(const Job& job, std::uint64_t waits, const std::stop_token& stop) {
    const Clock::time_point begin = Clock::now();
    std::optional<Brick> brick;
    std::string problem;
    bool is_kept = false, failed = false;
    try {
        is_kept = has_all(job.brick, job.coarser);
        brick = read(job.brick, job.coarser, stop);
    } catch (const Cancelled&) {  // the loader ends
    } catch (const std::exception& e) {
        failed = true;
        problem = text_of(e);
    }
    const std::scoped_lock lock(mutex_);
    in_flight_.erase(job.brick);
    if (brick) {
        if (!is_kept) {
            const double took = std::chrono::duration<double>(Clock::now() - begin).count();
            brick_s_ += (brick_s_ > 0 ? newest_part : 1) * (took - brick_s_);
        }
        put(job, *brick);
    } else if (failed) {
        fail(job.brick, problem, waits);
    }
    wake();
}

/// Needs the lock. Tells those who waited for the brick when its read began, after `begun` calls of
/// wait_for(). For those who came later it is tried again at once.
void BrickLoader::Parts::fail(const Index3& brick, const std::string& problem,
                              std::uint64_t begun) {
    bool again = false;
    for (Waiting& waiting : waiting_) {
        if (std::ranges::count(waiting.needed, brick) == 0) continue;
        if (waiting.number <= begun) waiting.problem = problem;
        again |= waiting.number > begun;
    }
    if (again) return;
    failed_[brick] = Clock::now() + pause_after_failure;
    problem_ = problem;
}

/// Errors are ignored here, because the thread that makes the brick meets and reports them.
void BrickLoader::Parts::help(const Job& job, const std::stop_token& stop) {
    try {
        const SampleBox source = source_of(job.brick, job.coarser);
        (void)blocks_->load_one(settings_.level + job.coarser, source, stop);
    } catch (const Cancelled&) {
    } catch (const std::exception&) {
    }
}

/// Needs the lock.
void BrickLoader::Parts::put(const Job& job, const Brick& brick) {
    failed_.erase(job.brick);
    if (failed_.empty()) problem_.clear();
    held_[job.brick] = brick;
    newest_ = Clock::now();
    events_.push_back({job.brick, job.coarser});
    ++loaded_;
    make_room();
    most_bytes_ = std::max(most_bytes_, bytes());
}

/// Needs the lock. Drops bricks that no hand wants, the farthest from the most wanted one first.
void BrickLoader::Parts::make_room() {
    count_process();
    if (held_.size() <= most_bricks_) return;
    const std::set<Index3, ByPlace> wanted(wanted_.begin(), wanted_.end());
    const Index3 centre = wanted_.empty() ? Index3(Index3::Zero()) : wanted_.front();
    std::vector<std::pair<std::int64_t, Index3>> idle;
    for (const auto& [brick, held] : held_) {
        if (wanted.contains(brick)) continue;
        idle.emplace_back((brick - centre).cast<std::int64_t>().squaredNorm(), brick);
    }
    const auto farther = [](const auto& a, const auto& b) { return a.first > b.first; };
    std::ranges::sort(idle, farther);
    // An eighth at a time, so that this is rare.
    const std::size_t enough = most_bricks_ - most_bricks_ / 8;
    for (const auto& [distance, brick] : idle) {
        if (held_.size() <= enough) break;
        held_.erase(brick);
        events_.push_back({brick, -1});
        ++dropped_;
    }
}

/// Needs the lock.
std::uint64_t BrickLoader::Parts::bytes() const {
    return blocks_->bytes() + other_bytes_ + held_.size() * bytes_of_brick(overview_.type());
}

void BrickLoader::Parts::read(const SampleBox& box, std::span<std::byte> out,
                              const std::stop_token& stop) {
    for_each_piece(Index3::Constant(ResidentBricks::edge), box,
                   [&](const Index3& at, const SampleBox& part) {
                       Brick held;
                       {
                           const std::scoped_lock lock(mutex_);
                           if (has(at, 0)) held = held_.at(at);
                       }
                       if (held) {
                           copy_box(room_of(at), held.samples.get(), box, out.data(),
                                    size_of(overview_.type()));
                       } else {
                           blocks_->read(settings_.level, part, box, out, stop);
                       }
                   });
}

void BrickLoader::Parts::leave_room(std::uint64_t bytes) {
    const std::scoped_lock lock(mutex_);
    other_bytes_ = bytes;
    make_room();
}

/// Needs the lock. What else the process holds, and how many bricks that leaves room for.
void BrickLoader::Parts::count_process() {
    const Clock::time_point now = Clock::now();
    if (settings_.whole_process && now - counted_ > between_counts) {
        counted_ = now;
        const std::uint64_t all = io::resident_memory();
        const std::uint64_t ours = blocks_->bytes() + other_bytes_ + memory_->bytes();
        process_bytes_ = all > ours ? all - ours : 0;
    }
    const std::uint64_t spare = settings_.whole_process ? settings_.memory / spare_part : 0;
    const std::uint64_t others = other_bytes_ + process_bytes_ + spare;
    const auto less = static_cast<std::size_t>(others / bytes_of_brick(overview_.type()));
    const std::size_t all = most_bricks(*store_, settings_.memory);
    most_bricks_ = all - std::min(less, all - fewest_bricks);
}

BrickLoader::BrickLoader(std::shared_ptr<const Store> store, Volume overview,
                         const BrickLoaderSettings& settings)
    : parts_(std::make_unique<Parts>(std::move(store), std::move(overview), settings)) {}

BrickLoader::~BrickLoader() = default;

const std::shared_ptr<const Samples>& BrickLoader::empty() const {
    return parts_->empty_;
}
void BrickLoader::look(std::span<const Interest> hands, std::chrono::steady_clock::time_point now) {
    parts_->look(hands, now);
}
std::optional<BrickVersion> BrickLoader::take() {
    return parts_->take();
}
void BrickLoader::wait_for(const Vec3& centre, double radius, std::stop_token stop) {
    parts_->wait_for(centre, radius, stop);
}
BrickLoaderStatus BrickLoader::status() const {
    return parts_->status();
}
void BrickLoader::read(const SampleBox& box, std::span<std::byte> out, std::stop_token stop) {
    parts_->read(box, out, stop);
}
void BrickLoader::leave_room(std::uint64_t bytes) {
    parts_->leave_room(bytes);
}
Brick BrickLoader::read(const Index3& brick, int coarser, std::stop_token stop) {
    return parts_->read(brick, coarser, stop);
}

}  // namespace palpate::stream

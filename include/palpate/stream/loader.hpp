// Brings bricks of a store into memory round the hands that feel it, within a memory bound, with
// threads of its own. What is in memory is published as versions of samples (samples.hpp).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

class Loader;

/// The threads of one store and the pieces that they have decoded. Its readers for hands and for
/// eyes share them, so that each piece is fetched once, those for hands first.
std::shared_ptr<Loader> shared_loader(int threads);

inline constexpr std::int64_t overview_samples = std::int64_t{1} << 21;

/// A volume of few samples that shows all of a store: its coarsest level that is fine enough, or
/// single samples of a store without levels. At most `samples` of them, one at least. Blocks.
/// Throws as Store::read().
Volume overview_of(const Store& store, std::int64_t samples = overview_samples,
                   std::stop_token stop = {});

struct BrickLoaderSettings {
    int level = 0;                                  ///< of the store that is felt
    std::uint64_t memory = std::uint64_t{1} << 29;  ///< [bytes] most that bricks and pieces take
    int threads = 32;                               ///< that read at a time
    /// Feel a coarser level until the bricks of `level` are there, and while a hand is too fast for
    /// them (ProxyUpdate::level says so).
    bool coarse_first = false;
    /// `memory` bounds all that the process takes, the program itself included; but a hand always
    /// has 64 bricks.
    bool whole_process = false;
    std::shared_ptr<Loader> shared = {};  ///< of this store. Empty: its own, with `threads`
};

/// The samples of a level before any of it is in memory. Throws std::invalid_argument for a level
/// that the store does not have, io::InputError for one with so many samples that the table of its
/// bricks alone takes more than a sixteenth of `memory` [bytes].
std::shared_ptr<const Samples> empty_samples(const Store& store, const Volume& overview, int level,
                                             std::uint64_t memory = BrickLoaderSettings{}.memory);

/// A hand and where it goes. Points in mm, physical.
struct Interest {
    Vec3 proxy = Vec3::Zero();
    Vec3 hand = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();  ///< of the hand [mm/s]
};

/// How a hand moves, by the places where it was seen.
struct HandMotion {
    std::optional<double> time = {};  ///< [s] when it was seen last
    Vec3 at = Vec3::Zero();           ///< [mm, physical]
    Vec3 velocity = Vec3::Zero();     ///< [mm/s], smoothed over 50 ms

    void see(double now, const Vec3& place);
};

/// A brick that came, or with level -1 went.
struct BrickEvent {
    Index3 brick;
    int level = 0;
    bool operator==(const BrickEvent&) const = default;
};

/// Samples with what came and went since the version before.
struct BrickVersion {
    std::shared_ptr<const Samples> samples;
    std::vector<BrickEvent> events;
};

struct BrickLoaderStatus {
    std::size_t resident = 0;      ///< bricks in memory
    std::size_t wanted = 0;        ///< bricks that the hands may need soon
    std::size_t missing = 0;       ///< of those, not in memory
    std::size_t urgent = 0;        ///< of those, among the first that the hands need
    std::uint64_t bytes = 0;       ///< that bricks, decoded pieces and edits take
    std::uint64_t most_bytes = 0;  ///< that they have taken at a time
    std::uint64_t loaded = 0;      ///< bricks so far
    std::uint64_t dropped = 0;     ///< bricks so far, to make room
    Traffic traffic;               ///< of the store
    std::string problem = {};      ///< why bricks do not come; usually empty
};

/// Any thread may call any function.
class BrickLoader {
  public:
    /// Throws std::invalid_argument for a level that the store does not have, or memory for fewer
    /// than 64 bricks.
    BrickLoader(std::shared_ptr<const Store> store, Volume overview,
                const BrickLoaderSettings& settings = {});
    /// Cancels what is being read.
    ~BrickLoader();
    BrickLoader(const BrickLoader&) = delete;
    BrickLoader& operator=(const BrickLoader&) = delete;

    /// Samples without any brick, for a field to begin with.
    const std::shared_ptr<const Samples>& empty() const;
    /// What the hands need from `now` on; never waits for a read. Their speed is smoothed over
    /// time.
    void look(std::span<const Interest> hands,
              std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());
    /// What is in memory now; nothing if that did not change since the last call. Reading slows
    /// down while more than a few bricks that were dropped are still in use, by who has older
    /// versions.
    std::optional<BrickVersion> take();
    /// Waits until all samples within `radius` [mm] of a point are in memory at the level felt, and
    /// before that while others wait for so many that these do not fit beside them. Throws
    /// std::invalid_argument if they do not fit at all, io::InputError for the first that cannot be
    /// had, Cancelled as soon as `stop` is requested.
    void wait_for(const Vec3& centre, double radius, std::stop_token stop = {});
    BrickLoaderStatus status() const;

    /// Samples of the level felt, x fastest: from memory where one brick has them all, else from
    /// the store. The box lies inside the grid. Blocks; throws as Store::read().
    void read(const SampleBox& box, std::span<std::byte> out, std::stop_token stop = {});
    /// So many bytes of the memory are used otherwise, for edits: bricks get less, but at least
    /// those that a hand cannot do without.
    void leave_room(std::uint64_t bytes);

    /// One brick as it is loaded; of a coarser level interpolated. Throws as Store::read().
    Brick read(const Index3& brick, int coarser, std::stop_token stop = {});

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace palpate::stream

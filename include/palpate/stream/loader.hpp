// Loads bricks of a store around the hands that touch it, within a memory limit, with threads of
// its own. It publishes the bricks in memory as versions of samples (samples.hpp).
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

/// The threads of one store and the pieces that they have decoded. The readers for hands and for
/// pictures share them, so that each piece is fetched once, those for hands first.
std::shared_ptr<Loader> shared_loader(int threads);

inline constexpr std::int64_t overview_samples = std::int64_t{1} << 21;

/// A volume of few samples that shows all of a store: its coarsest level that is fine enough, or
/// single samples of a store without levels. At most `samples` of them, one at least. Blocks.
/// Throws as Store::read().
Volume overview_of(const Store& store, std::int64_t samples = overview_samples,
                   std::stop_token stop = {});

struct BrickLoaderSettings {
    int level = 0;                                  ///< the level of the store that is touched
    std::uint64_t memory = std::uint64_t{1} << 29;  ///< [bytes] most that bricks and pieces take
    int threads = 32;                               ///< that read at a time
    /// Use a coarser level until the bricks of `level` are loaded, and while a hand is too fast for
    /// them (ProxyUpdate::level reports it).
    bool coarse_first = false;
    /// `memory` limits the whole process, including the program itself. A hand always has 64
    /// bricks.
    bool whole_process = false;
    std::shared_ptr<Loader> shared = {};  ///< of this store. Empty: its own, with `threads`
};

/// The samples of a level before any of it is in memory. Throws std::invalid_argument for a level
/// that the store does not have, io::InputError for one with so many samples that the table of its
/// bricks alone takes more than a sixteenth of `memory` [bytes].
std::shared_ptr<const Samples> empty_samples(const Store& store, const Volume& overview, int level,
                                             std::uint64_t memory = BrickLoaderSettings{}.memory);

/// A hand and its predicted motion. Points in mm, physical.
struct Interest {
    Vec3 proxy = Vec3::Zero();
    Vec3 hand = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();  ///< of the hand [mm/s]
};

/// The motion of a hand, from its latest positions.
struct HandMotion {
    std::optional<double> time = {};  ///< [s] when it was seen last
    Vec3 at = Vec3::Zero();           ///< [mm, physical]
    Vec3 velocity = Vec3::Zero();     ///< [mm/s], smoothed over 50 ms

    void see(double now, const Vec3& place);
};

/// A brick that was loaded or, with level -1, dropped.
struct BrickEvent {
    Index3 brick;
    int level = 0;
    bool operator==(const BrickEvent&) const = default;
};

/// Samples, and the bricks that were loaded and dropped since the version before.
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
    std::string problem = {};      ///< the reason why bricks are missing; usually empty
};

/// Any thread may call any function.
class BrickLoader {
  public:
    /// Throws std::invalid_argument for a level that the store does not have, or memory for fewer
    /// than 64 bricks.
    BrickLoader(std::shared_ptr<const Store> store, Volume overview,
                const BrickLoaderSettings& settings = {});
    /// Cancels reads under way.
    ~BrickLoader();
    BrickLoader(const BrickLoader&) = delete;
    BrickLoader& operator=(const BrickLoader&) = delete;

    /// Samples without any brick, for a field to begin with.
    const std::shared_ptr<const Samples>& empty() const;
    /// Sets the positions of the hands at `now`. Never waits for a read. Their speed is smoothed
    /// over time.
    void look(std::span<const Interest> hands,
              std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());
    /// The bricks in memory now, or nothing if they are the same as in the last call. Reading slows
    /// down while readers of older versions still use more than a few dropped bricks.
    std::optional<BrickVersion> take();
    /// Waits until all samples within `radius` [mm] of a point are in memory at the level that is
    /// touched. First waits for other callers, if their samples and these do not fit together.
    /// Throws std::invalid_argument if these do not fit at all, io::InputError for the first that
    /// cannot be read, Cancelled as soon as `stop` is requested.
    void wait_for(const Vec3& centre, double radius, std::stop_token stop = {});
    BrickLoaderStatus status() const;

    /// Samples of the level that is touched, x fastest. Those in bricks come from memory, the
    /// others from the store. The box lies inside the grid. Blocks; throws as Store::read().
    void read(const SampleBox& box, std::span<std::byte> out, std::stop_token stop = {});
    /// Reserves this many bytes of the memory for edits. Bricks get less, but at least those that a
    /// hand needs.
    void leave_room(std::uint64_t bytes);

    /// One brick as it is loaded, or interpolated from a coarser level. Throws as Store::read()
    /// does.
    Brick read(const Index3& brick, int coarser, std::stop_token stop = {});

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace palpate::stream

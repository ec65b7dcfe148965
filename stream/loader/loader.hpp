// The decoded pieces and the threads of one store, for hands and eyes together. Private to
// stream/loader.
#pragma once

#include <unistd.h>

#include <array>
#include <condition_variable>
#include <functional>
#include <future>
#include <list>
#include <map>
#include <mutex>
#include <new>
#include <string>

#include "palpate/stream/loader.hpp"
#include "stream/small_threads.hpp"

namespace palpate::stream {

class Blocks;
class Loader;

/// The shared loader, or one of its own for a reader that has none or that a fork has made: a fork
/// has none of its parent's threads.
std::shared_ptr<Loader> loader_for(const std::shared_ptr<Loader>& shared, int threads);

/// Of an error that is told later. Empty where there is no memory for it.
inline std::string text_of(const std::exception& error) noexcept {
    try {
        return error.what();
    } catch (const std::bad_alloc&) {
        return {};
    }
}

/// Whom something is read for: hands come first.
enum class For { hands, eyes };

/// What a thread of the store does next for one of its readers.
struct Turn {
    std::function<void(const std::stop_token& stop)> job = {};  ///< empty: nothing
    /// Without a job: there may be one after this long, although nobody calls wake().
    std::chrono::milliseconds pause{500};
    int for_eyes = 6;  ///< most pieces that may be read for eyes at the same time, says a hand
};

/// A place among the readers of a store: its threads do the jobs that `next` gives. `urgent`: only
/// what a hand needs at once.
class Reading {
  public:
    /// Throws std::system_error if the system gives no threads.
    Reading(Loader& loader, For whom, std::function<Turn(bool urgent)> next);
    /// Stops the jobs and waits for their end.
    ~Reading();
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

  private:
    friend class Loader;
    Loader& loader_;
    const For whom_;
    const std::function<Turn(bool urgent)> next_;
    std::stop_source stop_;
    int running_ = 0;  // with the loader's mutex
};

/// Threads do first what a hand needs at once, then what eyes need, as far as the hand allows, then
/// what else hands need. They run while there are readers. Any thread may call any function.
class Loader {
  public:
    explicit Loader(int threads) : count_(std::max(1, threads)) {}

    /// There may be a job.
    void wake();

  private:
    friend class Blocks;
    friend class Reading;
    friend std::shared_ptr<Loader> loader_for(const std::shared_ptr<Loader>& shared, int threads);
    using Key = std::array<int, 4>;  // level and place
    using Bytes = std::shared_ptr<const std::vector<std::byte>>;
    struct Kept {
        std::shared_future<Bytes> bytes;  // null if the read failed
        std::list<Key>::iterator age;     // in the owner's ages_
        std::uint64_t size;
        Blocks* owner;
    };
    using Lock = std::unique_lock<std::mutex>;

    void run(const std::stop_token& stop);
    bool work(Lock& lock, Turn& all);
    bool work_for(For whom, bool urgent, Lock& lock, Turn& all);

    std::mutex pieces_mutex_;  // also for ages_ and bytes_ of each reader's Blocks
    std::map<Key, Kept> kept_;

    const int count_;
    const int process_ = getpid();
    std::mutex entering_;  // one reader at a time enters or leaves
    std::mutex mutex_;
    std::condition_variable_any changed_, ended_;
    std::vector<Reading*> readers_;
    std::uint64_t changes_ = 0;  // that may have made a job
    int for_eyes_ = 0;           // threads that work for eyes
    std::unique_ptr<SmallThreads> threads_;
};

}  // namespace palpate::stream

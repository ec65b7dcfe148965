// The decoded pieces and the threads of one store, for hands and eyes together. Private to
// stream/loader.
#pragma once

#include <array>
#include <condition_variable>
#include <functional>
#include <future>
#include <list>
#include <map>
#include <mutex>

#include "palpate/stream/loader.hpp"
#include "stream/loader/small_threads.hpp"

namespace palpate::stream {

class Blocks;

/// Whom something is read for: hands come first.
enum class For { hands, eyes };

/// What a thread of the store does next for one of its readers.
struct Turn {
    std::function<void(const std::stop_token& stop)> job = {};  ///< empty: nothing
    /// Without a job: there may be one after this long, although nobody calls wake().
    std::chrono::milliseconds pause{500};
    int for_eyes = 6;  ///< most pieces that may be read for eyes at the same time, says a hand
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
    using Clock = std::chrono::steady_clock;
    using Lock = std::unique_lock<std::mutex>;
    struct Reader {
        For whom;
        std::function<Turn(bool urgent)> next;
        std::stop_source stop = {};
        int running = 0;
        bool has_left = false;
    };
    using Key = std::array<int, 4>;  // level and place
    using Bytes = std::shared_ptr<const std::vector<std::byte>>;
    struct Kept {
        std::shared_future<Bytes> bytes;  // null if the read failed
        std::list<Key>::iterator age;     // in the owner's ages_
        std::uint64_t size;
        Blocks* owner;
    };

    void run(const std::stop_token& stop);
    bool work(Lock& lock, std::chrono::milliseconds& pause);
    Turn turn_of(Reader& reader, bool urgent, Lock& lock);

    std::mutex pieces_mutex_;  // also for ages_ and bytes_ of each reader's Blocks
    std::map<Key, Kept> kept_;

    const int count_;
    std::mutex entering_;  // one reader at a time enters or leaves
    std::mutex mutex_;
    std::condition_variable_any changed_, left_;
    std::vector<std::shared_ptr<Reader>> readers_;
    std::uint64_t changes_ = 0;                   // that may have made a job
    Clock::time_point due_ = Clock::time_point::max();  // when a thread looks without a change
    int for_eyes_ = 0;                            // threads that work for eyes
    std::unique_ptr<SmallThreads> threads_;
};

/// A place among the readers of a store: its threads do the jobs that `next` gives. With `urgent`,
/// a hand gives only what it needs at once.
class Reading {
  public:
    /// Throws std::system_error if the system gives no threads.
    Reading(std::shared_ptr<Loader> loader, For whom, std::function<Turn(bool urgent)> next);
    /// Stops the jobs and waits for their end.
    ~Reading();
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

    void wake() const { loader_->wake(); }

  private:
    const std::shared_ptr<Loader> loader_;
    const std::shared_ptr<Loader::Reader> reader_;
};

}  // namespace palpate::stream

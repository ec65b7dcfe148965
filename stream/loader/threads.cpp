// The threads of a store. See loader.hpp.
#include <algorithm>
#include <new>

#include "stream/loader/loader.hpp"

namespace palpate::stream {

std::shared_ptr<Loader> shared_loader(int threads) {
    return std::make_shared<Loader>(threads);
}

std::shared_ptr<Loader> loader_for(const std::shared_ptr<Loader>& shared, int threads) {
    return shared && shared->process_ == getpid() ? shared : shared_loader(threads);
}

Reading::Reading(Loader& loader, For whom, std::function<Turn(bool urgent)> next)
    : loader_(loader), whom_(whom), next_(std::move(next)) {
    const std::scoped_lock entering(loader_.entering_);
    if (!loader_.threads_) {
        loader_.threads_ = std::make_unique<SmallThreads>(
            loader_.count_, [&loader](const std::stop_token& stop) { loader.run(stop); });
    }
    {
        const std::scoped_lock lock(loader_.mutex_);
        loader_.readers_.push_back(this);
    }
    loader_.wake();
}

Reading::~Reading() {
    const std::scoped_lock entering(loader_.entering_);
    stop_.request_stop();
    std::unique_lock lock(loader_.mutex_);
    std::erase(loader_.readers_, this);
    loader_.ended_.wait(lock, [&] { return running_ == 0; });
    const bool is_last = loader_.readers_.empty();
    lock.unlock();
    if (is_last) loader_.threads_.reset();
}

void Loader::wake() {
    const std::scoped_lock lock(mutex_);
    ++changes_;
    changed_.notify_one();  // who finds a job wakes the next one
}

void Loader::run(const std::stop_token& stop) {
    Lock lock(mutex_);
    while (!stop.stop_requested()) {
        const std::uint64_t seen = changes_;
        Turn all{.for_eyes = std::clamp(count_ / 2, 1, Turn{}.for_eyes)};
        if (work(lock, all)) continue;
        changed_.wait_for(lock, stop, all.pause, [&] { return changes_ != seen; });
    }
}

/// Does one job, if there is one.
bool Loader::work(Lock& lock, Turn& all) {
    const bool has_eyes = std::ranges::count(readers_, For::eyes, &Reading::whom_) > 0;
    if (has_eyes && for_eyes_ < all.for_eyes) {
        if (work_for(For::hands, true, lock, all)) return true;
        if (for_eyes_ < all.for_eyes) {
            ++for_eyes_;
            const bool done = work_for(For::eyes, false, lock, all);
            --for_eyes_;
            if (done) return true;
        }
    }
    return work_for(For::hands, false, lock, all);
}

/// Asks readers until one has a job, and does it. Of those without, `all` gets the least numbers.
bool Loader::work_for(For whom, bool urgent, Lock& lock, Turn& all) {
    std::vector<Reading*> readers;
    try {
        readers = readers_;
    } catch (const std::bad_alloc&) {
        return false;  // tried again in a moment
    }
    for (Reading* const reader : readers) {
        // It may have left, and be no more, while the lock was not held.
        if (std::ranges::count(readers_, reader) == 0 || reader->whom_ != whom) continue;
        ++reader->running_;
        lock.unlock();
        Turn turn;
        try {
            turn = reader->next_(urgent);
            if (turn.job) {
                changed_.notify_one();
                turn.job(reader->stop_.get_token());
            }
        } catch (const std::exception&) {  // no memory: tried again in a moment
            turn.job = {};
        }
        const bool done = turn.job != nullptr;
        turn.job = {};  // what it holds may be large: not with the lock
        lock.lock();
        --reader->running_;
        ended_.notify_all();
        if (done) return true;
        all.pause = std::min(all.pause, turn.pause);
        all.for_eyes = std::min(all.for_eyes, turn.for_eyes);
    }
    return false;
}

}  // namespace palpate::stream

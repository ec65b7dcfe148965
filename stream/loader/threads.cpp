// The threads of a store. See loader.hpp.
#include <algorithm>

#include "stream/loader/loader.hpp"

namespace palpate::stream {

std::shared_ptr<Loader> shared_loader(int threads) {
    return std::make_shared<Loader>(threads);
}

Reading::Reading(std::shared_ptr<Loader> loader, For whom, std::function<Turn(bool urgent)> next)
    : loader_(std::move(loader)),
      reader_(std::make_shared<Loader::Reader>(Loader::Reader{whom, std::move(next)})) {
    const std::scoped_lock entering(loader_->entering_);
    if (!loader_->threads_) {
        auto threads = std::make_unique<SmallThreads>();
        for (int i = 0; i < loader_->count_; ++i) {
            threads->start([of = loader_.get()](const std::stop_token& stop) { of->run(stop); });
        }
        loader_->threads_ = std::move(threads);
    }
    {
        const std::scoped_lock lock(loader_->mutex_);
        loader_->readers_.push_back(reader_);
    }
    wake();
}

Reading::~Reading() {
    const std::scoped_lock entering(loader_->entering_);
    reader_->stop.request_stop();
    std::unique_lock lock(loader_->mutex_);
    reader_->has_left = true;
    std::erase(loader_->readers_, reader_);
    loader_->left_.wait(lock, [&] { return reader_->running == 0; });
    const bool is_last = loader_->readers_.empty();
    lock.unlock();
    if (is_last) loader_->threads_.reset();
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
        std::chrono::milliseconds pause = Turn{}.pause;
        if (work(lock, pause)) continue;
        const auto changed = [&] { return changes_ != seen; };
        // One thread looks at the clock for all.
        const Clock::time_point until = Clock::now() + pause;
        if (due_ <= until) {
            changed_.wait(lock, stop, [&] { return changed() || due_ == due_.max(); });
            continue;
        }
        due_ = until;
        changed_.wait_until(lock, stop, until, changed);
        if (due_ == until) due_ = due_.max();
    }
}

/// Does one job, if there is one.
bool Loader::work(Lock& lock, std::chrono::milliseconds& pause) {
    const auto readers = readers_;
    const auto do_one = [&](For whom, bool urgent, int& for_eyes) {
        for (const auto& reader : readers) {
            if (reader->whom != whom) continue;
            const Turn turn = turn_of(*reader, urgent, lock);
            if (turn.job) return true;
            pause = std::min(pause, turn.pause);
            for_eyes = std::min(for_eyes, turn.for_eyes);
        }
        return false;
    };
    const auto is_of_eyes = [](const auto& reader) { return reader->whom == For::eyes; };
    int most = std::clamp(count_ / 2, 1, Turn{}.for_eyes), ignored = 0;
    if (for_eyes_ < most && std::ranges::any_of(readers, is_of_eyes)) {
        if (do_one(For::hands, true, most)) return true;
        if (for_eyes_ < most) {
            ++for_eyes_;
            const bool done = do_one(For::eyes, false, ignored);
            --for_eyes_;
            if (done) return true;
        }
    }
    return do_one(For::hands, false, ignored);
}

/// Asks a reader and does its job.
Turn Loader::turn_of(Reader& reader, bool urgent, Lock& lock) {
    if (reader.has_left) return {};
    ++reader.running;
    lock.unlock();
    Turn turn;
    try {
        turn = reader.next(urgent);
        if (turn.job) {
            changed_.notify_one();
            turn.job(reader.stop.get_token());
        }
    } catch (const std::exception&) {  // no memory: tried again in a moment
        turn.job = {};
    }
    lock.lock();
    --reader.running;
    if (reader.has_left) left_.notify_all();
    return turn;
}

}  // namespace palpate::stream

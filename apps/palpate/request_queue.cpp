// Carries out requests one after the other.
#include "apps/palpate/request_queue.hpp"

#include <stdexcept>
#include <utility>

#include "apps/palpate/commands.hpp"
#include "palpate/io/error.hpp"

namespace palpate::app {

void RequestQueue::put(Work work, bool is_scripted) {
    {
        const std::scoped_lock lock(mutex_);
        waiting_.push_back({std::move(work), is_scripted});
    }
    changed_.notify_all();
}

std::vector<RequestQueue::Message> RequestQueue::messages() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(messages_, {});
}

void RequestQueue::finish() {
    constexpr std::chrono::milliseconds between{20};
    std::unique_lock lock(mutex_);
    const auto is_done = [&] { return waiting_.empty() && !busy_; };
    while (!interrupted() && !changed_.wait_for(lock, between, is_done)) {
    }
}

void RequestQueue::end() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
}

std::string RequestQueue::problem() const {
    const std::scoped_lock lock(mutex_);
    return problem_;
}

void RequestQueue::run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [&] { return !waiting_.empty(); })) {
        if (stop.stop_requested()) return;
        const Waiting next = std::move(waiting_.front());
        waiting_.pop_front();
        busy_ = true;
        lock.unlock();
        do_one(next, stop);
        lock.lock();
        busy_ = false;
        changed_.notify_all();
    }
}

void RequestQueue::do_one(const Waiting& one, const std::stop_token& stop) {
    try {
        say(one.work(stop), false);
    } catch (const io::Cancelled&) {  // the session ends
    } catch (const std::exception& e) {
        const bool is_unsaved = dynamic_cast<const io::OutputError*>(&e) != nullptr;
        say((is_unsaved ? "palpate: " : "") + std::string(e.what()), true);
        if (!is_unsaved && !one.is_scripted) return;
        const std::scoped_lock lock(mutex_);
        problem_ = e.what();
    }
}

void RequestQueue::say(const std::string& text, bool is_problem) {
    if (text.empty()) return;
    const std::scoped_lock lock(mutex_);
    messages_.push_back({text, is_problem});
}

}  // namespace palpate::app

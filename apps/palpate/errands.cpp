// One errand after the other.
#include "apps/palpate/errands.hpp"

#include <stdexcept>
#include <utility>

namespace palpate::app {

Errands::Errands(DataInHand& data) : data_(data), thread_([this] { run(); }) {}

Errands::~Errands() {
    {
        const std::scoped_lock lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void Errands::put(const DataRequest& request, const Snapshot& now) {
    {
        const std::scoped_lock lock(mutex_);
        waiting_.push_back({request, now});
    }
    changed_.notify_all();
}

std::vector<Errands::Word> Errands::words() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(words_, {});
}

void Errands::finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_.empty() && !busy_; });
}

std::string Errands::unsaved() const {
    const std::scoped_lock lock(mutex_);
    return unsaved_;
}

void Errands::run() {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [&] { return stop_ || !waiting_.empty(); });
        if (stop_) return;
        const Errand errand = std::move(waiting_.front());
        waiting_.pop_front();
        busy_ = true;
        lock.unlock();
        carry_out_one(errand);
        lock.lock();
        busy_ = false;
        changed_.notify_all();
    }
}

void Errands::carry_out_one(const Errand& errand) {
    try {
        say(carry_out(errand.request, data_, errand.now), false);
    } catch (const io::OutputError& e) {
        say(std::string("palpate: ") + e.what(), true);
        const std::scoped_lock lock(mutex_);
        unsaved_ = e.what();
    } catch (const std::exception& e) {
        say(e.what(), true);
    }
}

void Errands::say(const std::string& text, bool is_problem) {
    if (text.empty()) return;
    const std::scoped_lock lock(mutex_);
    words_.push_back({text, is_problem});
}

}  // namespace palpate::app

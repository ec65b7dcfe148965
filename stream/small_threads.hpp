// Threads with small stacks: a process that locks its memory, like that of a servo, holds all of
// each stack. Private to stream/.
#pragma once

#include <pthread.h>

#include <functional>
#include <stop_token>
#include <system_error>
#include <vector>

namespace palpate::stream {

/// Bytes of a stack. Decoding and a request's bookkeeping need less than 60 KiB of it.
inline constexpr std::size_t small_stack = std::size_t{256} << 10;

/// Like std::jthread, several at a time: the end requests the stop and joins.
class SmallThreads {
  public:
    /// Throws std::system_error if the system gives no thread.
    SmallThreads(int count, std::function<void(const std::stop_token& stop)> work)
        : work_(std::move(work)) {
        pthread_attr_t attributes;
        pthread_attr_init(&attributes);
        pthread_attr_setstacksize(&attributes, small_stack);
        int error = 0;
        for (threads_.reserve(std::size_t(count)); count > 0 && error == 0; --count) {
            pthread_t thread;
            error = pthread_create(&thread, &attributes, &run, this);
            if (error == 0) threads_.push_back(thread);
        }
        pthread_attr_destroy(&attributes);
        if (error == 0) return;
        end();
        throw std::system_error(error, std::generic_category());
    }
    ~SmallThreads() { end(); }
    SmallThreads(const SmallThreads&) = delete;
    SmallThreads& operator=(const SmallThreads&) = delete;

  private:
    static void* run(void* of) {
        const auto& own = *static_cast<const SmallThreads*>(of);
        own.work_(own.stop_.get_token());
        return nullptr;
    }
    void end() {
        stop_.request_stop();
        for (const pthread_t thread : threads_) pthread_join(thread, nullptr);
    }

    const std::function<void(const std::stop_token&)> work_;
    std::stop_source stop_;
    std::vector<pthread_t> threads_;
};

}  // namespace palpate::stream

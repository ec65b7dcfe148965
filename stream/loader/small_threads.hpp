// Threads with small stacks: a process that locks its memory, like that of a servo, holds all of
// each stack. Private to stream/.
#pragma once

#include <pthread.h>

#include <functional>
#include <memory>
#include <stop_token>
#include <system_error>
#include <vector>

namespace palpate::stream {

/// Bytes of a stack. Decoding and a request's bookkeeping need less than 60 KiB of it.
inline constexpr std::size_t small_stack = std::size_t{256} << 10;

/// Like std::jthread, several at a time: the end requests the stop and joins. One thread owns it.
class SmallThreads {
  public:
    SmallThreads() = default;
    ~SmallThreads() {
        stop_.request_stop();
        for (const pthread_t thread : threads_) pthread_join(thread, nullptr);
    }
    SmallThreads(const SmallThreads&) = delete;
    SmallThreads& operator=(const SmallThreads&) = delete;

    /// Throws std::system_error if the system gives no thread.
    void start(std::function<void(const std::stop_token& stop)> work) {
        auto given = std::make_unique<Given>(Given{std::move(work), stop_.get_token()});
        threads_.reserve(threads_.size() + 1);
        pthread_attr_t attributes;
        pthread_attr_init(&attributes);
        pthread_attr_setstacksize(&attributes, small_stack);
        pthread_t thread;
        const int error = pthread_create(&thread, &attributes, &run, given.get());
        pthread_attr_destroy(&attributes);
        if (error != 0) throw std::system_error(error, std::generic_category());
        static_cast<void>(given.release());
        threads_.push_back(thread);
    }

  private:
    struct Given {
        std::function<void(const std::stop_token&)> work;
        std::stop_token stop;
    };
    static void* run(void* given) {
        const std::unique_ptr<Given> own(static_cast<Given*>(given));
        own->work(own->stop);
        return nullptr;
    }

    std::stop_source stop_;
    std::vector<pthread_t> threads_;
};

}  // namespace palpate::stream

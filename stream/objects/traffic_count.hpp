// Counts the requests of a store to disk or network, from several threads. Private to stream/.
#pragma once

#include <atomic>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

struct TrafficCount {
    std::atomic<std::uint64_t> requests = 0, bytes = 0, retries = 0, cached = 0;

    void request(std::uint64_t bytes_of_it) {
        requests.fetch_add(1, std::memory_order_relaxed);
        bytes.fetch_add(bytes_of_it, std::memory_order_relaxed);
    }
    Traffic now() const { return {requests.load(), bytes.load(), retries.load(), cached.load()}; }
};

}  // namespace palpate::stream

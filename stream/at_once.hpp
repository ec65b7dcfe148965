// Pieces of work on several threads with small stacks. Private to stream/.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>

namespace palpate::stream {

/// Calls work(0, until) to work(count - 1, until) from so many threads. What one of them throws
/// stops the others and is thrown, as Cancelled is once `stop` is requested.
void for_all_at_once(std::size_t count, int threads, const std::stop_token& stop,
                     const std::function<void(std::size_t i, const std::stop_token& until)>& work);

}  // namespace palpate::stream

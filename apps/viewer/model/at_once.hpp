// Work on as many threads as there are processors.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace palpate::viewer {

/// work(item) for all of them, until one says no. Threads keep the caller's priority. False if one
/// said no. Throws what one of them throws.
bool for_each_at_once(const std::vector<std::size_t>& items,
                      const std::function<bool(std::size_t)>& work);

}  // namespace palpate::viewer

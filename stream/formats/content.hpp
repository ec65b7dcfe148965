// Recognises the content of stores, so that work on one is never continued or opened over another
// one that has its name and its size. Private to stream/.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

/// What `store` holds from a level on: type, channel, time, every level's grid, and samples. Of
/// each level all, if they are at most 64 MiB (1 MiB of a store behind HTTP). Else those of 64 (8)
/// pieces that are spread evenly over the grid, at most 64 samples long along each axis; of coarser
/// levels an eighth as many. All samples of a volume in memory. Hexadecimal. Throws what the store
/// throws, and Cancelled as soon as `stop` is requested.
std::string content_of(const Store& store, int level, const std::stop_token& stop = {});

/// Throws InputError: the source was written while it was converted.
[[noreturn]] void fail_changed(const Store& store);

/// Names, sizes and times of change of a file, or of all files of a folder and below, as one
/// number: which files they are, without reading them. 0 if there is no such file. Throws
/// Cancelled.
std::uint64_t files_at(const std::string& address, const std::stop_token& stop = {});

}  // namespace palpate::stream

// Objects on other machines, and a cache of them on this machine's disk. Private to stream/.
#pragma once

#include <memory>
#include <string>

#include "stream/objects/objects.hpp"

namespace palpate::stream {

/// Behind an http://, https:// or s3:// address. `stop`: of requests that have no token of their
/// own.
std::shared_ptr<const Objects> http_objects(const std::string& address, const StoreOptions& options,
                                            std::stop_token stop = {});

/// The same objects; those that last (Wanted::lasting) are kept in a folder of at most
/// `most_bytes`, which several processes may use at a time. Another Objects::version() makes new
/// entries. Trouble with the disk is no error: then nothing is kept. If it is there from the start,
/// a note says so. Creates the folder.
std::shared_ptr<const Objects> cached_objects(std::shared_ptr<const Objects> objects,
                                              const std::filesystem::path& folder,
                                              std::uint64_t most_bytes);

}  // namespace palpate::stream

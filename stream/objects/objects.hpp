// Named objects with bytes, as folders and object stores hold them. Private to stream/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "stream/objects/traffic_count.hpp"

namespace palpate::stream {

using Bytes = std::vector<std::byte>;

/// A part of an object.
struct ByteRange {
    std::uint64_t offset = 0;  ///< of the first byte; where `from_end`, of all bytes but the last
                               ///< `length`, and not used
    std::uint64_t length = 0;
    bool from_end = false;
};

struct Wanted {
    std::string key;  ///< a path with '/', without a beginning or ending one
    std::optional<ByteRange> range = std::nullopt;
    std::uint64_t most = UINT64_MAX;  ///< bytes that the object may have; more is an error
    bool lasting = false;             ///< may come from a disk cache
    bool again = false;               ///< what came before was damaged: not from the cache
    bool probe = false;  ///< one that may not be there; what must not be read counts as such
    /// Unless null, gets what changes when the object is written anew.
    std::string* identity = nullptr;
};

/// Throws io::InputError: it has more bytes than it may have, and what to do.
[[noreturn]] void fail_too_long(const std::string& name, const Wanted& wanted);

/// Safe to use from several threads at a time.
class Objects {
  public:
    virtual ~Objects() = default;
    /// An object as messages name it.
    virtual std::string name_of(const std::string& key) const = 0;
    /// Its bytes, or nothing if there is no such object. Throws io::InputError, which names the
    /// object, if it cannot be had, is longer than it may be or shorter than the range; Cancelled.
    virtual std::optional<Bytes> get(const Wanted& wanted, std::stop_token stop) const = 0;
    /// Several at once, in the same order. All together may have `most` bytes.
    virtual std::vector<std::optional<Bytes>> get_all(std::span<const Wanted> wanted,
                                                      std::uint64_t most,
                                                      std::stop_token stop) const;
    /// [bytes] of an object; nothing if there is none, or its size cannot be known. Throws as
    /// get().
    virtual std::optional<std::uint64_t> size_of(const std::string& key) const = 0;
    /// Shows `enough` the names in a folder, and whether each is one of a folder, until it returns
    /// true. False if they cannot be listed, as on a web server: then it was not called. Throws
    /// Cancelled.
    virtual bool list(const std::string& folder,
                      const std::function<bool(const std::string&, bool)>& enough) const;
    virtual Traffic traffic() const = 0;
    /// Of an object among all that have had its name; changes when what was read each time, not
    /// lasting, has changed: its bytes, or its version or time as a server tells them.
    virtual std::string version() const { return {}; }
    /// Whether a change of the bytes always changes version(), as far as a server can tell it.
    /// Otherwise only those of this session are known to be the same.
    virtual bool tells_changes() const { return true; }
    /// A sentence for people, about how the objects are had. Usually empty.
    virtual std::string note() const { return {}; }
};

/// `stop`: of requests that have no token of their own.
std::shared_ptr<const Objects> folder_objects(const std::filesystem::path& folder,
                                              std::stop_token stop = {});

/// The key of something below `folder`, which may be empty. Throws std::invalid_argument for a
/// name that leads out of it.
std::string key_below(const std::string& folder, const std::string& name);

}  // namespace palpate::stream

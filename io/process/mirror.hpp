// A file that lies elsewhere, for the helper process: pages of it in memory that both share. What
// the helper lacks it asks for, and is run again. Private to io/ and stream/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <stop_token>
#include <string>

#include "io/process/helper_process.hpp"

namespace palpate::io {

class Mirror {
  public:
    /// Reads a part of the file that lies within it. May throw.
    using Read = std::function<void(std::uint64_t offset, std::span<std::byte> to,
                                    const std::stop_token& stop)>;

    /// `name`: in messages; its extension tells the format. `size` [bytes] of the file. Throws
    /// std::system_error.
    Mirror(std::string name, std::uint64_t size, Read read);

    const std::string& name() const { return name_; }
    std::uint64_t size() const { return size_; }
    /// As long as the file, with holes where nothing was read.
    const Descriptor& memory() const { return memory_; }
    /// One job at a time: forget() would take pages from another.
    std::mutex& mutex() { return mutex_; }
    /// Reads the pages round a part of the file that are not here. Throws what `read` throws,
    /// std::invalid_argument for a part outside the file, and for more pages than metadata have.
    void fetch(std::uint64_t offset, std::uint64_t length, const std::stop_token& stop);
    /// Drops all pages if they have become many.
    void tidy();

  private:
    std::string name_;
    std::uint64_t size_;
    Read read_;
    Descriptor memory_;
    std::uint64_t held_ = 0;  // bytes
    std::mutex mutex_;
};

}  // namespace palpate::io

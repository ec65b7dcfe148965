// The text of a recording, line by line. RecordingWriter brings it to a file. The web module keeps
// it in memory. Private to io/ and bindings/web.
#pragma once

#include <atomic>
#include <string>

#include "io/recording/recording_head.hpp"

namespace palpate::io {

class RecordingText {
  public:
    /// Begins with the head.
    explicit RecordingText(const RecordingHead& head);

    void append(const SessionTick& tick);
    void append(const Command& command);
    /// The last line, see RecordingWriter::finish().
    void end(std::int64_t lost);

    /// Any thread.
    std::int64_t ticks() const { return ticks_.load(std::memory_order_relaxed); }

    std::string lines;  ///< those that the caller has not taken yet

  private:
    std::uint32_t checksum_ = 0;  // of all events so far
    Bodies bodies_;               // of its edits, by number
    std::atomic<std::int64_t> ticks_{0};
};

}  // namespace palpate::io

// The text of a recording, line by line. RecordingWriter brings it to a file. The web module keeps
// it in memory. Private to io/ and bindings/web.
#pragma once

#include <atomic>
#include <span>
#include <string>
#include <vector>

#include "io/recording/recording_head.hpp"

namespace palpate::io {

class RecordingText {
  public:
    /// Begins with the head.
    explicit RecordingText(const RecordingHead& head) : RecordingText(std::span(&head, 1)) {}
    /// Of a head for each hand.
    explicit RecordingText(std::span<const RecordingHead> heads);

    // Hands are numbered from 1.
    void append(const SessionTick& tick, int hand = 1);
    void append(const Command& command, int hand = 1);
    /// The last line, see RecordingWriter::finish().
    /// `begins` of the hands after the first one's [s], if they are known.
    void end(std::int64_t lost, std::span<const double> begins = {});

    /// Any thread.
    std::int64_t ticks(int hand = 1) const {
        return hands_[static_cast<std::size_t>(hand - 1)].ticks.load(std::memory_order_relaxed);
    }

    std::string lines;  ///< those that the caller has not taken yet

  private:
    struct Hand {
        Bodies bodies;  // of its edits, by number
        std::atomic<std::int64_t> ticks{0};
    };
    bool has_several() const { return hands_.size() > 1; }

    std::uint32_t checksum_ = 0;  // of all events so far
    std::vector<Hand> hands_;
};

}  // namespace palpate::io

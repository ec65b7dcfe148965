// The memory-mapped file through which another process pushes frames: its layout (described byte by
// byte in docs/sequences.md; little-endian), a writer and a reader. Frames go to several slots in
// turn. Each slot has a sequence number by which a reader recognises a torn frame (a seqlock).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/samples.hpp"

namespace palpate::io {

inline constexpr std::size_t live_header_bytes = 256;
inline constexpr std::size_t live_slot_header_bytes = 64;

/// The part of the header that does not change.
struct LiveHeader {
    Geometry geometry;
    SampleType type = SampleType::uint8;
    int slots = 4;                 ///< 2 to 1024
    double interval = 0;           ///< [s] nominal, from frame to frame. 0: unknown
    std::uint64_t first_slot = 0;  ///< [bytes] from the file's start, a multiple of 64
    std::uint64_t slot_bytes = 0;  ///< [bytes] from slot to slot, a multiple of 64

    std::uint64_t frame_bytes() const;
    std::uint64_t file_bytes() const { return first_slot + slot_bytes * std::uint64_t(slots); }
    /// The place of a frame's slot [bytes from the file's start].
    std::uint64_t slot_at(std::uint64_t frame) const {
        return first_slot + slot_bytes * (frame % std::uint64_t(slots));
    }
};

/// Reads a header and checks it against the size of its file, so that all slots lie in the file.
/// Throws InputError. Its message begins with `name`.
LiveHeader live_header_from(std::span<const std::byte> bytes, std::uint64_t file_bytes,
                            const std::string& name);
/// The header as `live_header_bytes` bytes.
std::vector<std::byte> bytes_of(const LiveHeader& header);

/// Writes frames into such a file. One process at a time. The file appears under its name when it
/// is complete, replaces an older one, and stays when the writer is destroyed.
class LiveWriter {
  public:
    /// Throws OutputError if the file cannot be made with all its bytes, std::invalid_argument for
    /// a geometry, slots or an interval out of range.
    LiveWriter(const std::filesystem::path& path, const Geometry& geometry, SampleType type,
               double interval = 0, int slots = 4);
    /// Marks the file as ended: no more frames come.
    ~LiveWriter();
    LiveWriter(const LiveWriter&) = delete;
    LiveWriter& operator=(const LiveWriter&) = delete;

    /// Writes the next frame: its samples, x fastest, and when it was taken [s]. A time that does
    /// not rise begins a new sequence. Never waits for a reader. Throws std::invalid_argument for
    /// samples of another size or a time that is not finite.
    void push(std::span<const std::byte> samples, double time);
    /// The same. The volume must be of the file's geometry and type.
    void push(const Volume& volume, double time);
    const LiveHeader& header() const { return header_; }

  private:
    LiveHeader header_;
    std::byte* file_ = nullptr;
    std::uint64_t frames_ = 0;
};

/// Reads such a file by copying, never by mapping it: a writer that truncates the file cannot crash
/// the reader. Checks everything it reads.
class LiveReader {
  public:
    /// Throws InputError if there is no such file or it is damaged, or if a frame takes more than
    /// `memory_bytes`.
    explicit LiveReader(const std::filesystem::path& path,
                        std::uint64_t memory_bytes = std::uint64_t{4} << 30);
    ~LiveReader();
    LiveReader(const LiveReader&) = delete;
    LiveReader& operator=(const LiveReader&) = delete;

    const LiveHeader& header() const { return header_; }
    /// The frames written since the last call, at most the last `most`, complete and in order of
    /// their numbers. Frames that were overwritten meanwhile are missed. Frame::number counts from
    /// the file's first. Throws InputError if the file has become shorter, or a frame's time or
    /// samples are not finite. The next call continues after that frame.
    std::vector<Frame> poll(int most = 4);
    std::uint64_t missed() const { return missed_; }
    /// The writer has marked the file as ended.
    bool ended() const { return ended_; }
    /// Another file has this name now: the writer was started again.
    bool replaced() const;

  private:
    void read_at(std::uint64_t at, std::span<std::byte> to) const;
    std::optional<Frame> frame(std::uint64_t number) const;

    std::string name_;
    int descriptor_ = -1;
    LiveHeader header_;
    std::uint64_t seen_ = 0;
    std::uint64_t missed_ = 0;
    bool ended_ = false;
};

}  // namespace palpate::io

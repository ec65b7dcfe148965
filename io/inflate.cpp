// Unpacks gzip and zlib streams. See the header.
#include "io/inflate.hpp"

#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <new>
#include <string>
#include <vector>

namespace palpate::io {
namespace {

constexpr std::size_t inflated_at_once = 1 << 18;

/// Takes compressed bytes and passes unpacked bytes on.
class Inflater {
  public:
    Inflater(const ByteSink& sink, std::uint64_t at_most)
        : sink_(sink), at_most_(at_most), out_(inflated_at_once) {
        // 32: gzip or zlib, told apart by the header; both carry a checksum, raw deflate does not.
        if (inflateInit2(&state_, 15 + 32) != Z_OK) throw std::bad_alloc();
    }
    ~Inflater() { inflateEnd(&state_); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    void feed(std::span<const std::byte> in) {
        // zlib's interface predates const; it does not write here.
        state_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(in.data()));
        state_.avail_in = static_cast<uInt>(in.size());
        // A full output buffer may hide more that zlib holds back, even with all input taken.
        while (state_.avail_in > 0 || (output_was_full_ && !ended_)) {
            if (ended_ && !begin_next_member()) return;
            step();
        }
    }

    std::uint64_t finish() const {
        if (!ended_) throw DamagedStream("the compressed data ends too early");
        return total_;
    }

  private:
    /// After the end of a member: another one, zero padding (skipped), or garbage (an error).
    bool begin_next_member() {
        while (state_.avail_in > 0 && *state_.next_in == 0) {
            ++state_.next_in;
            --state_.avail_in;
        }
        if (state_.avail_in == 0) return false;
        if (*state_.next_in != 0x1f) {
            throw DamagedStream("something else follows the compressed data");
        }
        inflateReset(&state_);
        ended_ = false;
        return true;
    }

    void step() {
        state_.next_out = reinterpret_cast<Bytef*>(out_.data());
        state_.avail_out = static_cast<uInt>(out_.size());
        const int status = ::inflate(&state_, Z_NO_FLUSH);
        if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) {
            throw DamagedStream(std::string("the compressed data is damaged (") +
                                (state_.msg ? state_.msg : "zlib") + ")");
        }
        const std::size_t made = out_.size() - state_.avail_out;
        total_ += made;
        if (total_ > at_most_) {
            throw OversizedStream("the compressed data unpacks to more than the header says");
        }
        if (sink_ && made > 0) sink_({out_.data(), made});
        ended_ = status == Z_STREAM_END;
        output_was_full_ = state_.avail_out == 0;
    }

    const ByteSink& sink_;
    std::uint64_t at_most_;
    std::vector<std::byte> out_;
    z_stream state_{};
    std::uint64_t total_ = 0;
    bool ended_ = false;
    bool output_was_full_ = false;
};

}  // namespace

std::uint64_t inflate_checked(const std::filesystem::path& file, const StreamPlace& place,
                              const ByteSink& sink) {
    std::ifstream in(file, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(place.offset));
    if (!in) throw DamagedStream("it cannot be opened or is too short");
    Inflater inflater(sink, place.at_most);
    std::vector<std::byte> chunk(inflated_at_once);
    std::uint64_t left = place.length;
    while (left > 0 && in) {
        in.read(reinterpret_cast<char*>(chunk.data()),
                static_cast<std::streamsize>(std::min<std::uint64_t>(left, chunk.size())));
        const auto got = static_cast<std::size_t>(in.gcount());
        inflater.feed({chunk.data(), got});
        left -= got;
    }
    return inflater.finish();
}

std::uint64_t inflate_checked(std::span<const std::byte> stream, std::uint64_t at_most,
                              const ByteSink& sink) {
    Inflater inflater(sink, at_most);
    for (std::size_t at = 0; at < stream.size(); at += inflated_at_once) {
        inflater.feed(stream.subspan(at, std::min(inflated_at_once, stream.size() - at)));
    }
    return inflater.finish();
}

}  // namespace palpate::io

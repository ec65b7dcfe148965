// The bytes of a DICOM file for our own checks: mapped, or unpacked as far as they are asked for
// where the data set is deflated.
#pragma once

#include <memory>

#include "io/byte_order.hpp"
#include "io/helper/decode.hpp"

namespace palpate::io {

class DicomBytes {
  public:
    /// Throws Failure if the file cannot be read.
    explicit DicomBytes(const std::filesystem::path& file);
    ~DicomBytes();
    DicomBytes(const DicomBytes&) = delete;
    DicomBytes& operator=(const DicomBytes&) = delete;

    /// From byte `at` on the file is deflated. Its compressed data have no checksum. No more than
    /// `most` bytes are unpacked from there, until allow() says more.
    void deflated_from(std::uint64_t at, std::uint64_t most);
    void allow(std::uint64_t more);
    /// From here on, numbers are big-endian.
    void set_swapped() { swapped_ = true; }
    bool swapped() const { return swapped_; }

    /// Whether there are bytes up to `end`. Throws DamagedStream, also where more than is allowed
    /// would have to be unpacked to know.
    bool reaches(std::uint64_t end);
    /// A number of a place that reaches() has found.
    template <class T>
    T number(std::uint64_t at) const {
        return number_in<T>(view(at, sizeof(T)), swapped_);
    }
    /// Bytes of a place that reaches() has found, valid until the next reaches().
    std::span<const std::byte> view(std::uint64_t at, std::uint64_t length) const {
        return {data() + at, length};
    }

  private:
    struct Inflating;
    const std::byte* data() const { return inflating_ ? unpacked_.data() : mapped_.data(); }

    std::span<const std::byte> mapped_;
    std::unique_ptr<Inflating> inflating_;
    std::vector<std::byte> unpacked_;
    bool swapped_ = false;
};

}  // namespace palpate::io

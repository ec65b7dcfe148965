// Maps a DICOM file, and unpacks a deflated one step by step. See the header.
#include "io/helper/dicom_bytes.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <new>

#include "io/inflate.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t step_bytes = 1 << 16;
constexpr std::uint64_t best_packing = 1032;  // : 1, of deflate

}  // namespace

struct DicomBytes::Inflating {
    z_stream state{};
    bool ended = false;
    std::uint64_t most = 0;     // that it can be, with what is before it in the file
    std::uint64_t allowed = 0;  // the same, of what may be unpacked

    explicit Inflating(std::span<const std::byte> in) {
        if (inflateInit2(&state, -15) != Z_OK) throw std::bad_alloc();
        // zlib's interface predates const; it does not write here.
        state.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(in.data()));
        state.avail_in = static_cast<uInt>(in.size());
    }
    ~Inflating() { inflateEnd(&state); }
    Inflating(const Inflating&) = delete;
    Inflating& operator=(const Inflating&) = delete;

    void step(std::vector<std::byte>& to) {
        const std::size_t before = to.size();
        to.resize(before + step_bytes);
        state.next_out = reinterpret_cast<Bytef*>(to.data() + before);
        state.avail_out = step_bytes;
        const int status = ::inflate(&state, Z_NO_FLUSH);
        to.resize(before + step_bytes - state.avail_out);
        if (status != Z_OK && status != Z_STREAM_END) {
            throw DamagedStream(status == Z_BUF_ERROR ? "its deflated data end too early"
                                                      : "its deflated data are damaged");
        }
        ended = status == Z_STREAM_END;
    }
};

DicomBytes::DicomBytes(const std::filesystem::path& file) {
    const auto size = std::filesystem::file_size(file);
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    void* const at = descriptor < 0 || size == 0
                         ? MAP_FAILED
                         : ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (descriptor >= 0) ::close(descriptor);
    if (at == MAP_FAILED) throw Failure(quoted(file) + " cannot be read; check its permissions");
    mapped_ = {static_cast<const std::byte*>(at), size};
}

DicomBytes::~DicomBytes() {
    ::munmap(const_cast<std::byte*>(mapped_.data()), mapped_.size());
}

void DicomBytes::deflated_from(std::uint64_t at, std::uint64_t most) {
    const auto packed = mapped_.subspan(at);
    if (packed.size() > UINT32_MAX) throw DamagedStream("its deflated data are larger than 4 GB");
    unpacked_.assign(mapped_.begin(), mapped_.begin() + static_cast<std::ptrdiff_t>(at));
    inflating_ = std::make_unique<Inflating>(packed);
    inflating_->most = at + best_packing * packed.size() + step_bytes;
    inflating_->allowed = at + most;
}

void DicomBytes::allow(std::uint64_t more) {
    if (inflating_) inflating_->allowed += more;
}

bool DicomBytes::reaches(std::uint64_t end) {
    if (!inflating_) return end <= mapped_.size();
    if (end <= unpacked_.size() || inflating_->ended) return end <= unpacked_.size();
    if (end > inflating_->allowed) {
        throw DamagedStream("its deflated data unpack to more than its header asks for");
    }
    if (end > inflating_->most) return false;
    while (unpacked_.size() < end && !inflating_->ended) inflating_->step(unpacked_);
    return end <= unpacked_.size();
}

}  // namespace palpate::io

// The live file. The writer maps the file and the reader copies from it with pread, both through
// the page cache. The slot's sequence number, read before and after, shows a torn frame.
#if defined(__GNUC__) && !defined(__clang__)
// The thread sanitizer does not support fences and warns about them; the samples that they order
// are in a file, which it does not watch either.
#pragma GCC diagnostic ignored "-Wtsan"
#endif
#include "palpate/io/live_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>

#include "io/file_grid.hpp"
#include "io/system/leftovers.hpp"
#include "io/system/system.hpp"

namespace palpate::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the live file is little-endian");

constexpr char magic[] = {'P', 'A', 'L', 'P', 'L', 'I', 'V', 'E'};
constexpr std::uint32_t version = 1;
constexpr int fewest_slots = 2, most_slots = 1024;

// Offsets in the header and in a slot [bytes].
constexpr std::size_t at_version = 8, at_header_bytes = 12, at_type = 16, at_slots = 20,
                      at_size = 24, at_spacing = 40, at_origin = 64, at_direction = 88,
                      at_interval = 160, at_first_slot = 168, at_slot_bytes = 176, at_frames = 184,
                      at_ended = 192;
constexpr std::size_t slot_sequence = 0, slot_time = 8;

template <class T>
T number_at(std::span<const std::byte> bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

template <class T>
void put(std::vector<std::byte>& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::uint64_t padded(std::uint64_t bytes) {
    return (bytes + 63) / 64 * 64;
}

/// A number in the mapped file that the other side may read at any time.
template <class T>
std::atomic_ref<T> shared_number(std::byte* at) {
    return std::atomic_ref<T>(*reinterpret_cast<T*>(at));
}

void check_layout(const LiveHeader& header, std::uint64_t file_bytes, const std::string& name) {
    const auto refuse = [&](const std::string& what) {
        throw InputError(name + ": " + what + "; its writer must be corrected");
    };
    if (header.slots < fewest_slots || header.slots > most_slots) {
        refuse("has " + std::to_string(header.slots) + " slots, 2 to 1024 are possible");
    }
    if (!(std::isfinite(header.interval) && header.interval >= 0)) {
        refuse("its interval between frames is not a number of seconds");
    }
    if (const std::string why = why_no_file_grid(header.geometry); !why.empty()) refuse(why);
    // An axis has at most 2^20 samples by now, so a frame's bytes fit in 64 bit.
    const std::uint64_t needed = live_slot_header_bytes + header.frame_bytes();
    if (header.first_slot % 64 != 0 || header.first_slot < live_header_bytes ||
        header.slot_bytes % 64 != 0 || header.slot_bytes < needed) {
        refuse("its slots begin at byte " + std::to_string(header.first_slot) + " and are " +
               std::to_string(header.slot_bytes) + " bytes each, which does not hold a frame of " +
               std::to_string(header.frame_bytes()) + " bytes behind its 64");
    }
    const auto slots = static_cast<std::uint64_t>(header.slots);
    if (header.first_slot > file_bytes ||
        header.slot_bytes > (file_bytes - header.first_slot) / slots) {
        refuse("is " + std::to_string(file_bytes) + " bytes, too short for its " +
               std::to_string(header.slots) + " slots of " + std::to_string(header.slot_bytes));
    }
}

}  // namespace

std::uint64_t LiveHeader::frame_bytes() const {
    return static_cast<std::uint64_t>(sample_count(geometry)) * size_of(type);
}

LiveHeader live_header_from(std::span<const std::byte> bytes, std::uint64_t file_bytes,
                            const std::string& name) {
    if (bytes.size() < live_header_bytes || std::memcmp(bytes.data(), magic, sizeof magic) != 0) {
        throw InputError(name +
                         ": is not a live source (it does not begin with PALPLIVE and a "
                         "header of 256 bytes); check the name");
    }
    if (number_at<std::uint32_t>(bytes, at_version) != version ||
        number_at<std::uint32_t>(bytes, at_header_bytes) != live_header_bytes) {
        throw InputError(name + ": its layout is of version " +
                         std::to_string(number_at<std::uint32_t>(bytes, at_version)) +
                         ", version 1 is read; let writer and Palpate be of one age");
    }
    LiveHeader header;
    const auto type = number_at<std::uint32_t>(bytes, at_type);
    if (type > static_cast<std::uint32_t>(SampleType::float32)) {
        throw InputError(name + ": its sample type " + std::to_string(type) +
                         " is none of 0 (uint8) to 3 (float32); its writer must be corrected");
    }
    header.type = static_cast<SampleType>(type);
    const auto slots = number_at<std::uint32_t>(bytes, at_slots);
    header.slots = slots > most_slots ? most_slots + 1 : static_cast<int>(slots);
    for (int a = 0; a < 3; ++a) {
        const auto i = static_cast<std::size_t>(a);
        header.geometry.size[a] = number_at<std::int32_t>(bytes, at_size + 4 * i);
        header.geometry.spacing[a] = number_at<double>(bytes, at_spacing + 8 * i);
        header.geometry.origin[a] = number_at<double>(bytes, at_origin + 8 * i);
        for (int r = 0; r < 3; ++r) {
            const auto at = at_direction + 8 * (3 * i + static_cast<std::size_t>(r));
            header.geometry.direction(r, a) = number_at<double>(bytes, at);
        }
    }
    header.interval = number_at<double>(bytes, at_interval);
    header.first_slot = number_at<std::uint64_t>(bytes, at_first_slot);
    header.slot_bytes = number_at<std::uint64_t>(bytes, at_slot_bytes);
    check_layout(header, file_bytes, name);
    return header;
}

std::vector<std::byte> bytes_of(const LiveHeader& header) {
    std::vector<std::byte> bytes(live_header_bytes);
    std::memcpy(bytes.data(), magic, sizeof magic);
    put(bytes, at_version, version);
    put(bytes, at_header_bytes, static_cast<std::uint32_t>(live_header_bytes));
    put(bytes, at_type, static_cast<std::uint32_t>(header.type));
    put(bytes, at_slots, static_cast<std::uint32_t>(header.slots));
    for (int a = 0; a < 3; ++a) {
        const auto i = static_cast<std::size_t>(a);
        put(bytes, at_size + 4 * i, static_cast<std::int32_t>(header.geometry.size[a]));
        put(bytes, at_spacing + 8 * i, header.geometry.spacing[a]);
        put(bytes, at_origin + 8 * i, header.geometry.origin[a]);
        for (int r = 0; r < 3; ++r) {
            put(bytes, at_direction + 8 * (3 * i + static_cast<std::size_t>(r)),
                header.geometry.direction(r, a));
        }
    }
    put(bytes, at_interval, header.interval);
    put(bytes, at_first_slot, header.first_slot);
    put(bytes, at_slot_bytes, header.slot_bytes);
    return bytes;
}

namespace {

/// Makes the file with all its blocks, because a page for which the disk has no room would end the
/// writer with SIGBUS; maps it; then renames it.
std::byte* make_file(const std::filesystem::path& path, const LiveHeader& header) {
    std::filesystem::path unfinished =
        temporary_in(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
    bool is_made = false;
    const auto fail = [&](int error) {
        if (is_made) unlink(unfinished.c_str());
        throw OutputError(path.string() + ": cannot be made (" + std::strerror(error) +
                          "); choose another place, /dev/shm is one in memory");
    };
    const int descriptor =
        open(unfinished.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (descriptor < 0) fail(errno);
    is_made = true;
    unfinished = signed_temporary(unfinished);
    const auto bytes = header.file_bytes();
    int error = posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
    void* mapped = MAP_FAILED;
    if (error == 0) {
        mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
        if (mapped == MAP_FAILED) error = errno;
    }
    close(descriptor);
    if (error != 0) fail(error);
    const std::vector<std::byte> head = bytes_of(header);
    std::memcpy(mapped, head.data(), head.size());
    if (!replace_synced(unfinished, path)) {
        error = errno;
        munmap(mapped, bytes);
        fail(error);
    }
    return static_cast<std::byte*>(mapped);
}

}  // namespace

LiveWriter::LiveWriter(const std::filesystem::path& path, const Geometry& geometry, SampleType type,
                       double interval, int slots) {
    if (const std::string why = why_no_file_grid(geometry); !why.empty()) {
        throw std::invalid_argument(why);
    }
    if (slots < fewest_slots || slots > most_slots) {
        throw std::invalid_argument("a live source has 2 to 1024 slots");
    }
    if (!(std::isfinite(interval) && interval >= 0)) {
        throw std::invalid_argument("the interval between frames is not a number of seconds");
    }
    header_ = {orthonormal(geometry), type, slots, interval, live_header_bytes, 0};
    header_.slot_bytes = padded(live_slot_header_bytes + header_.frame_bytes());
    if (header_.slot_bytes > (std::uint64_t{1} << 62) / static_cast<std::uint64_t>(slots)) {
        throw std::invalid_argument("frames of that size do not fit into a file");
    }
    file_ = make_file(path, header_);
}

LiveWriter::~LiveWriter() {
    shared_number<std::uint32_t>(file_ + at_ended).store(1, std::memory_order_release);
    munmap(file_, header_.file_bytes());
}

void LiveWriter::push(std::span<const std::byte> samples, double time) {
    if (samples.size() != header_.frame_bytes()) {
        throw std::invalid_argument("a frame of this live source has " +
                                    std::to_string(header_.frame_bytes()) + " bytes, not " +
                                    std::to_string(samples.size()));
    }
    if (!std::isfinite(time)) throw std::invalid_argument("the time of a frame is not finite");
    std::byte* const slot = file_ + header_.slot_at(frames_);
    const auto sequence = shared_number<std::uint64_t>(slot + slot_sequence);
    sequence.store(2 * frames_ + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_seq_cst);  // odd before the first new sample
    std::memcpy(slot + slot_time, &time, sizeof time);
    std::memcpy(slot + live_slot_header_bytes, samples.data(), samples.size());
    sequence.store(2 * frames_ + 2, std::memory_order_release);
    shared_number<std::uint64_t>(file_ + at_frames).store(++frames_, std::memory_order_release);
}

void LiveWriter::push(const Volume& volume, double time) {
    if (!(volume.geometry() == header_.geometry) || volume.type() != header_.type) {
        throw std::invalid_argument("a frame lies on another grid than the live source");
    }
    push({static_cast<const std::byte*>(volume.data()), volume.bytes()}, time);
}

LiveReader::LiveReader(const std::filesystem::path& path, std::uint64_t memory_bytes)
    : name_(path.string()) {
    // A pipe of that name must not block until it has a writer.
    descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0) {
        throw InputError(name_ + ": " + std::strerror(errno) +
                         "; start the program that writes it, or check the name");
    }
    try {
        struct stat status {};
        if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
            throw InputError(name_ + ": is not a file; give the file that a live source writes");
        }
        const auto size = static_cast<std::uint64_t>(status.st_size);
        std::vector<std::byte> bytes(live_header_bytes);
        if (size >= live_header_bytes) read_at(0, bytes);
        header_ = live_header_from(bytes, size, name_);
        if (header_.frame_bytes() > memory_bytes) {
            throw InputError(name_ + ": one frame takes " + std::to_string(header_.frame_bytes()) +
                             " bytes, more than is allowed; let its writer send a smaller volume");
        }
    } catch (...) {
        close(descriptor_);
        throw;
    }
}

LiveReader::~LiveReader() {
    close(descriptor_);
}

void LiveReader::read_at(std::uint64_t at, std::span<std::byte> to) const {
    std::size_t done = 0;
    while (done < to.size()) {
        const ssize_t got =
            pread(descriptor_, to.data() + done, to.size() - done, static_cast<off_t>(at + done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) {
            throw InputError(name_ +
                             ": is shorter than its header says; was it cut off? start "
                             "the program that writes it again");
        }
        done += static_cast<std::size_t>(got);
    }
}

/// Returns nothing if the writer changed the slot meanwhile.
std::optional<Frame> LiveReader::frame(std::uint64_t number) const {
    const std::uint64_t slot = header_.slot_at(number);
    const std::uint64_t whole = 2 * number + 2;
    std::array<std::byte, 16> head;
    read_at(slot, head);
    if (number_at<std::uint64_t>(head, slot_sequence) != whole) return std::nullopt;
    std::atomic_thread_fence(std::memory_order_seq_cst);
    const auto bytes = static_cast<std::size_t>(header_.frame_bytes());
    // Aligned for any sample type, and not set to zero first.
    const std::shared_ptr<std::byte[]> samples(new std::byte[bytes]);
    read_at(slot + live_slot_header_bytes, {samples.get(), bytes});
    std::atomic_thread_fence(std::memory_order_seq_cst);
    std::array<std::byte, 8> after;
    read_at(slot, after);
    if (number_at<std::uint64_t>(after, slot_sequence) != whole) return std::nullopt;
    const auto time = number_at<double>(head, slot_time);
    const std::string which = name_ + ": frame " + std::to_string(number);
    if (!std::isfinite(time)) throw InputError(which + " has a time that is not finite");
    try {
        const int shown = static_cast<int>(number & std::numeric_limits<int>::max());
        return Frame{time, Volume(header_.geometry, header_.type, samples, bytes), shown};
    } catch (const std::invalid_argument& error) {
        throw InputError(which + ": " + error.what());
    }
}

std::vector<Frame> LiveReader::poll(int most) {
    std::array<std::byte, 12> state;
    read_at(at_frames, state);
    const auto count = number_at<std::uint64_t>(state, 0);
    ended_ = number_at<std::uint32_t>(state, at_ended - at_frames) != 0;
    if (count < seen_) seen_ = 0;  // the writer has begun again in the same file
    // The oldest slot is the one that is written next.
    const auto lying = static_cast<std::uint64_t>(std::min(most, header_.slots - 1));
    const std::uint64_t first = std::max(seen_, count - std::min(count, lying));
    missed_ += first - seen_;
    seen_ = first;
    std::vector<Frame> frames;
    while (seen_ < count) {
        std::optional<Frame> next = frame(seen_++);
        if (next) {
            frames.push_back(std::move(*next));
        } else {
            ++missed_;
        }
    }
    return frames;
}

bool LiveReader::replaced() const {
    struct stat ours {
    }, named{};
    if (fstat(descriptor_, &ours) != 0 || stat(name_.c_str(), &named) != 0) return false;
    return ours.st_ino != named.st_ino || ours.st_dev != named.st_dev;
}

}  // namespace palpate::io

// Plain files of samples, read where they lie: opening costs a header, whatever the file's size.
#include <algorithm>
#include <cerrno>
#include <vector>

#include "io/plain_samples.hpp"
#include "io/process/helper_process.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "stream/box_bytes.hpp"
#include "stream/formats/finite_store.hpp"
#include "stream/formats/stores.hpp"
#include "stream/objects/traffic_count.hpp"
#include "stream/sample_bytes.hpp"

namespace palpate::stream {
namespace {

class PlainFile : public FiniteStore {
  public:
    PlainFile(const std::string& path, const StoreOptions& options)
        : PlainFile(path, options, io::locate_samples(path, read_options(options))) {}

    Traffic traffic() const override { return traffic_.now(); }

  private:
    static constexpr std::size_t piece_bytes = 1 << 20;  // converted at a time

    void put(int, const SampleBox& box, const Places& to,
             const std::stop_token& stop) const override {
        const Index3 size = box.high - box.low + Index3::Ones();
        const auto row = static_cast<std::size_t>(size[0]);
        // Rows that follow each other in the file are read in one go.
        const bool whole_rows = size[0] == grid().size[0];
        const std::size_t most = std::max<std::size_t>(1, piece_bytes / (row * bytes_.size()));
        const int together =
            whole_rows ? static_cast<int>(std::min<std::size_t>(most, std::size_t(size[1]))) : 1;
        std::vector<std::byte> raw;
        for (int z = box.low[2]; z <= box.high[2]; ++z) {
            for (int y = box.low[1]; y <= box.high[1]; y += together) {
                if (stop.stop_requested()) throw Cancelled{};
                const int rows = std::min(together, box.high[1] - y + 1);
                const std::size_t count = row * static_cast<std::size_t>(rows);
                raw.resize(count * bytes_.size());
                fetch({box.low[0], y, z}, raw);
                bytes_.unpack(raw, to({box.low[0], y, z}, count));
            }
        }
        if (io::identity_of(file_.number()) != identity_) {
            throw io::InputError(info_.address +
                                 ": was written anew since it was opened; open it again");
        }
    }

    static io::ReadOptions read_options(const StoreOptions& options) {
        io::ReadOptions read;
        read.raw = options.raw;
        read.spacing = options.spacing;
        read.orientation = options.orientation;
        return read;
    }

    PlainFile(const std::string& path, const StoreOptions& options, const io::PlainSamples& plain)
        : file_(io::open_to_read(plain.file)) {
        if (file_.number() < 0) {
            throw io::InputError(path + ": " + io::reason(errno) + "; check its permissions");
        }
        identity_ = io::identity_of(file_.number());
        bytes_ = {plain.stored, plain.swapped, plain.value_map, 0};
        info_.address = path;
        info_.format = plain.format;
        info_.type = bytes_.type();
        info_.times = plain.times;
        info_.frame_interval = plain.frame_interval;
        info_.notes = plain.notes;
        // A row is the least that costs one access to a disk.
        info_.levels = {{plain.geometry, Index3(plain.geometry.size[0], 1, 1)}};
        io::note_conversion(plain.stored, plain.value_map, info_.notes);
        note_finite(bytes_, info_.notes);
        check_choice(info_, options);
        info_.channel = options.channel;
        info_.time = options.time;
        first_ = plain.offset + static_cast<std::uint64_t>(options.time) *
                                    static_cast<std::uint64_t>(sample_count(grid())) *
                                    bytes_.size();
    }

    const Geometry& grid() const { return info_.levels.front().geometry; }

    /// The stored bytes from a sample on.
    void fetch(const Index3& from, std::span<std::byte> raw) const {
        const std::uint64_t before = place_in(whole_box(grid()), from) * bytes_.size();
        const std::ptrdiff_t got =
            io::read_at(file_.number(), raw.data(), raw.size(), first_ + before);
        if (got != std::ssize(raw)) {
            throw io::InputError(info_.address + ": " +
                                 (got < 0 ? io::reason(errno) : "is shorter than when opened") +
                                 "; check the disk, and that nothing writes to the file");
        }
        traffic_.request(raw.size());
    }

    io::Descriptor file_;
    std::string identity_;  ///< of the file when it was opened: samples of two files never mix
    SampleBytes bytes_;
    std::uint64_t first_ = 0;  ///< [bytes] of the first sample of the chosen time
    mutable TrafficCount traffic_;
};

void check_number(const std::string& address, const std::string& what, int wanted, int count) {
    if (wanted >= 0 && wanted < count) return;
    throw io::InputError(address + ": there is no " + what + " " + std::to_string(wanted) +
                         ": it has " + std::to_string(count) +
                         (count == 1 ? ", number 0" : ", numbered from 0; choose one of them"));
}

}  // namespace

void check_choice(const StoreInfo& info, const StoreOptions& options) {
    check_number(info.address, "time", options.time, info.times);
    check_number(info.address, "channel", options.channel,
                 info.channels.empty() ? 1 : static_cast<int>(info.channels.size()));
}

std::shared_ptr<const Store> open_plain_file(const std::string& path, const StoreOptions& options) {
    return std::make_shared<PlainFile>(path, options);
}

}  // namespace palpate::stream

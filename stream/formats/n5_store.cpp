// Opens N5: single datasets, multiscale groups (s0, s1, ...), and the channels and times of
// BigDataViewer (setup0/timepoint0/s0) and N5 Viewer (c0/s0).
#include <algorithm>

#include "io/chunked_image.hpp"
#include "stream/formats/metadata_files.hpp"
#include "stream/formats/n5_metadata.hpp"
#include "stream/formats/stores.hpp"

namespace palpate::stream {
namespace {

using Json = nlohmann::json;
constexpr std::size_t most_n5_levels = 16;

bool is_dataset(const Json& attributes) {
    return attributes.is_object() && attributes.contains("dimensions");
}

class N5Opening {
  public:
    N5Opening(const Objects& objects, const StoreOptions& options)
        : objects_(objects), options_(options), room_(room_for_metadata(options)) {}

    /// Returns nothing if there is no N5.
    std::optional<ChunkedVolume> volume(const std::string& address) {
        volume_.info.address = address;
        volume_.info.format = "N5";
        std::vector<Json> first = attributes_of({"", "s0", "c0/s0", "setup0", "timepoint0/s0"});
        const bool is_n5 =
            std::ranges::any_of(first, [](const Json& one) { return !one.is_null(); });
        const bool has_levels = is_dataset(first[1]), has_channels = is_dataset(first[2]);
        if (is_dataset(first[0])) {
            take_levels({first.data(), 1}, {""});
            return std::move(volume_);
        }
        groups_.push_back(std::move(first[0]));
        first.clear();
        if (has_levels) {
            take_group("");
        } else if (has_channels) {
            take_group(entered(chosen_channel("c", numbers_of("c", "/s0"), "channel ")));
        } else if (!is_n5) {
            return std::nullopt;
        } else if (const auto setups = numbers_of("setup", ""); !setups.empty()) {
            take_moment(entered(chosen_channel("setup", setups, "setup ")));
        } else if (!numbers_of("timepoint", "/s0").empty()) {
            take_moment("");
        } else {
            throw BadMetadata(
                "is a group of N5 without samples of its own; give the folder of a dataset or of "
                "levels s0, s1, ... below it");
        }
        return std::move(volume_);
    }

  private:
    /// Attributes of several folders at once. Null if a folder has none.
    std::vector<Json> attributes_of(const std::vector<std::string>& folders) {
        return metadata_in(objects_, folders, "attributes.json", room_);
    }

    /// A folder within the groups so far, which becomes the innermost of them.
    std::string entered(const std::string& group) {
        groups_.insert(groups_.begin(), std::move(attributes_of({group})[0]));
        return group;
    }

    /// The numbers N of the folders PREFIXN that have attributes in PREFIXNSUFFIX: asks for a few,
    /// then for more and more at once, while there are some near the end of those. They may begin
    /// above 0 (below 80) and have gaps.
    std::vector<int> numbers_of(const std::string& prefix, const std::string& suffix) const {
        constexpr int most = 1 << 16;
        std::vector<int> numbers;
        int asked = 0;
        for (int batch = 16; asked < most; batch *= 4) {
            std::vector<Wanted> wanted;
            for (int i = 0; i < batch; ++i) {
                const std::string folder = prefix + std::to_string(asked + i) + suffix;
                wanted.push_back(metadata_file(folder, "attributes.json"));
            }
            const auto all = objects_.get_all(wanted, room_, {});
            for (int i = 0; i < batch; ++i) {
                if (all[static_cast<std::size_t>(i)]) numbers.push_back(asked + i);
            }
            asked += batch;
            if (numbers.empty() ? asked > 16 : numbers.back() < asked - batch / 4) break;
        }
        return numbers;
    }

    /// The folder of the channel that is asked for.
    std::string chosen_channel(const std::string& prefix, const std::vector<int>& numbers,
                               const std::string& name) {
        for (std::size_t i = 0; numbers.size() > 1 && i < numbers.size(); ++i) {
            volume_.info.channels.push_back(name + std::to_string(numbers[i]));
        }
        StoreOptions chosen;  // the times are not known yet
        chosen.channel = options_.channel;
        check_choice(volume_.info, chosen);
        return prefix + std::to_string(numbers.at(static_cast<std::size_t>(options_.channel)));
    }

    /// The time that is asked for, of a setup of BigDataViewer.
    void take_moment(const std::string& setup) {
        const std::string prefix = key_below(setup, "timepoint");
        const std::vector<int> numbers = numbers_of(prefix, "/s0");
        if (numbers.empty()) {
            throw BadMetadata("its '" + prefix +
                              "' of times, with a level s0, is not there; copy "
                              "it again");
        }
        volume_.info.times = static_cast<int>(numbers.size());
        check_choice(volume_.info, options_);
        const int number = io::number_of_time(options_.time, numbers, volume_.info.notes);
        take_group(entered(prefix + std::to_string(number)));
    }

    void take_group(const std::string& group) {
        std::vector<std::string> folders;
        for (std::size_t i = 0; i < most_n5_levels; ++i) {
            folders.push_back(key_below(group, "s" + std::to_string(i)));
        }
        std::vector<Json> levels = attributes_of(folders);
        const auto missing = std::ranges::find_if_not(levels, is_dataset);
        levels.erase(missing, levels.end());
        if (levels.empty()) {
            throw BadMetadata("its level '" + folders[0] + "' is not there; copy it again");
        }
        folders.resize(levels.size());
        take_levels(levels, folders);
    }

    void take_levels(std::span<const Json> levels, const std::vector<std::string>& folders) {
        for (std::size_t i = 0; i < levels.size(); ++i) {
            volume_.arrays.push_back(n5_array(levels[i], folders[i]));
        }
        const Image image = n5_image(groups_, levels, volume_.arrays, volume_.info.notes);
        volume_ = volume_of(image, std::move(volume_), options_);
    }

    const Objects& objects_;
    const StoreOptions& options_;
    std::size_t room_;          ///< [bytes] for more metadata
    std::vector<Json> groups_;  ///< around the levels, the innermost first
    ChunkedVolume volume_;
};

}  // namespace

std::shared_ptr<const Store> open_n5(std::shared_ptr<const Objects> objects,
                                     const std::string& address, const StoreOptions& options) {
    return about(address, [&]() -> std::shared_ptr<const Store> {
        auto volume = N5Opening(*objects, options).volume(address);
        return volume ? chunked_store(objects, *std::move(volume), options.unpacking) : nullptr;
    });
}

}  // namespace palpate::stream

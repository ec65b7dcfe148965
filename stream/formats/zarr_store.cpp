// Opens OME-Zarr images of versions 0.4 (Zarr 2) and 0.5 (Zarr 3), single Zarr arrays, and the
// first series of the output of bioformats2raw.
#include <algorithm>
#include <array>
#include <numeric>

#include "palpate/io/error.hpp"
#include "stream/formats/metadata_files.hpp"
#include "stream/formats/stores.hpp"
#include "stream/formats/zarr_metadata.hpp"

namespace palpate::stream {
namespace {

using Json = nlohmann::json;
constexpr std::size_t most_series = 16;  // that are looked for

/// Metadata of a folder, of either version.
struct Node {
    Json metadata;    ///< of an array, or of a group of Zarr 3
    Json attributes;  ///< null if there are none
    int version = 0;  ///< of Zarr; 0: there is nothing
    bool is_array = false;
};

/// Looks into several folders at once.
std::vector<Node> nodes_in(const Objects& objects, std::span<const std::string> folders,
                           std::size_t& room) {
    std::vector<Wanted> wanted;
    constexpr std::array names = {"zarr.json", ".zattrs", ".zarray", ".zgroup"};
    for (const std::string& folder : folders) {
        for (const char* name : names) wanted.push_back(metadata_file(folder, name));
    }
    auto all = objects.get_all(wanted, room, {});
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < folders.size(); ++i) {
        const auto json = [&](std::size_t n) {
            const std::size_t at = i * names.size() + n;
            return parsed(std::move(all[at]), objects.name_of(wanted[at].key), room);
        };
        Node node;
        if (Json zarr = json(0); zarr.is_object()) {
            node.version = 3;
            if (zarr.contains("attributes")) node.attributes = std::move(zarr["attributes"]);
            node.is_array = member(zarr, "node_type") == "array";
            node.metadata = std::move(zarr);
        } else if (Json attributes = json(1), array = json(2);
                   !attributes.is_null() || !array.is_null() || all[i * names.size() + 3]) {
            const bool is_array = !array.is_null();
            node = {std::move(array), std::move(attributes), 2, is_array};
        }
        nodes.push_back(std::move(node));
    }
    return nodes;
}

ChunkedArray array_from(const Json& array, int version, const std::string& folder) {
    return version == 3 ? zarr3_array(array, folder) : zarr2_array(array, folder);
}

/// ", such as ..." for the plates and the lists of labels of OME-Zarr, which have images below
/// them.
std::string folder_below(const Json& given) {
    const Json& own = member(given, "ome");
    const Json& attributes = own.is_null() ? given : own;
    const Json &wells = member(member(attributes, "plate"), "wells"),
               &labels = member(attributes, "labels");
    const Json* name = nullptr;
    if (wells.is_array() && !wells.empty()) name = &member(wells[0], "path");
    if (labels.is_array() && !labels.empty()) name = &labels[0];
    if (!name || !name->is_string()) return "";
    return ", such as " + io::one_line(name->get<std::string>().substr(0, 80));
}

class Opening {
  public:
    Opening(const Objects& objects, std::string folder, const StoreOptions& options)
        : objects_(objects),
          folder_(std::move(folder)),
          options_(options),
          room_(room_for_metadata(options)) {}

    /// Returns nothing if there is no Zarr.
    std::optional<ChunkedVolume> volume(const std::string& address) {
        volume_.info.address = address;
        Node root = std::move(nodes_in(objects_, std::array{folder_}, room_)[0]);
        if (root.version == 0) return std::nullopt;
        if (root.is_array) return of_array(root);
        auto image = ome_image(root.attributes);
        if (!image) {
            const std::string below = folder_below(root.attributes);
            root = first_series();
            image = ome_image(root.attributes);
            if (!image) {
                throw BadMetadata(
                    "has neither an image nor an array of its own; give one in a folder below it" +
                    below);
            }
        }
        if (root.version == 3) check_members(root.metadata);
        take_levels(*image, root.version);
        return volume_of(*image, std::move(volume_), options_);
    }

  private:
    ChunkedVolume of_array(const Node& root) {
        ChunkedArray array = array_from(root.metadata, root.version, folder_);
        volume_.info.format = "Zarr " + std::to_string(root.version);
        volume_.info.notes.push_back("it is an array without a place in space: 1 mm was taken");
        Image image;
        image.measured = false;
        image.axes = usual_axes(array.axes());
        if (!take_names(root, image.axes) && array.axes() > 3) {
            volume_.info.notes.push_back(
                std::string("its axes have no names: they were taken as ") +
                (array.axes() > 4 ? "times, channels, z, y, x" : "channels, z, y, x"));
        }
        for (ImageAxis& axis : image.axes) axis.unit = "millimeter";
        for (const char* name : {"scale_factor", "add_offset"}) {
            if (!root.attributes.contains(name)) continue;
            volume_.info.notes.push_back("its attribute '" + std::string(name) +
                                         "' was not applied: the samples are as they are stored");
        }
        image.levels = {
            {"", std::vector<double>(array.axes(), 1), std::vector<double>(array.axes(), 0)}};
        take_stored_layout(objects_, array, volume_.info.notes);
        volume_.arrays = {array};
        return volume_of(image, std::move(volume_), options_);
    }

    /// The names of its dimensions: Zarr 3 has a place for them, xarray an attribute. False if
    /// there are none.
    bool take_names(const Node& root, std::vector<ImageAxis>& axes) {
        const Json& own = member(root.metadata, "dimension_names");
        const Json& names = own.is_array() ? own : member(root.attributes, "_ARRAY_DIMENSIONS");
        if (!names.is_array() || names.size() != axes.size()) return false;
        if (std::ranges::all_of(names, &Json::is_null)) return false;
        std::vector<ImageAxis> named;
        std::string text;
        for (const Json& name : names) {
            named.push_back({name.is_null() ? "an unnamed axis" : axis_name(name), ""});
            text += (text.empty() ? "" : ", ") + named.back().name.substr(0, 20);
        }
        try {
            check_axes(named);
            axes = std::move(named);
        } catch (const BadMetadata&) {
            volume_.info.notes.push_back("its dimensions have the names " + text +
                                         ": the last were taken as z, y, x");
        }
        return true;
    }

    /// The series of a bioformats2raw folder are those that OME/ lists, or else images named 0, 1,
    /// ...
    Node first_series() {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < most_series; ++i) names.push_back(std::to_string(i));
        names.emplace_back("OME");
        auto nodes = nodes_below(names);
        const std::vector<std::string> listed = listed_series(nodes.back().attributes);
        names.pop_back();
        nodes.pop_back();
        if (!listed.empty() && !std::equal(listed.begin(), listed.end(), names.begin())) {
            names = listed;
            nodes = nodes_below(names);
        }
        if (!ome_image(nodes[0].attributes)) return {};
        std::string others;
        for (std::size_t i = 1; i < nodes.size(); ++i) {
            if (nodes[i].version > 0) others += (others.empty() ? "" : ", ") + names[i];
        }
        if (!others.empty()) {
            volume_.info.notes.push_back("series " + names[0] + " was taken; others are " + others +
                                         ": give the folder of one to choose it");
        }
        folder_ = key_below(folder_, names[0]);
        return std::move(nodes[0]);
    }

    std::vector<Node> nodes_below(const std::vector<std::string>& names) {
        std::vector<std::string> folders;
        for (const std::string& name : names) folders.push_back(key_below(folder_, name));
        return nodes_in(objects_, folders, room_);
    }

    /// At most as many as are looked for. Empty if a path is none.
    static std::vector<std::string> listed_series(const Json& attributes) {
        const Json ome = member(attributes, "ome");
        const Json series = member(ome.is_object() ? ome : attributes, "series");
        std::vector<std::string> all;
        for (const Json& path : series.is_array() ? series : Json::array()) {
            if (all.size() == most_series) break;
            const std::string name = path.is_string() ? path.get<std::string>() : "";
            const bool is_path = !name.empty() && name.size() <= 200 && name[0] != '/' &&
                                 ("/" + name + "/").find("/../") == std::string::npos;
            if (!is_path) return {};
            all.push_back(name);
        }
        return all;
    }

    void take_levels(Image& image, int version) {
        volume_.info.format = version == 3 ? "OME-Zarr 0.5" : "OME-Zarr 0.4";
        // Over a network each file that is asked for in vain costs as much as one that is there.
        std::vector<std::string> folders;
        for (const ImageLevel& level : image.levels) {
            folders.push_back(key_below(folder_, level.path));
        }
        const auto all =
            metadata_in(objects_, folders, version == 3 ? "zarr.json" : ".zarray", room_);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const bool is_array =
                all[i].is_object() && (version == 2 || member(all[i], "node_type") == "array");
            if (!is_array)
                throw BadMetadata("its level '" + folders[i] + "' is not there; copy it again");
            volume_.arrays.push_back(array_from(all[i], version, folders[i]));
            take_stored_layout(objects_, volume_.arrays.back(), volume_.info.notes);
        }
        sort_levels(image);
        if (!image.scaled && image.levels.size() > 1) compare_sizes(image);
    }

    void sort_levels(Image& image) {
        const auto finer = [&](std::size_t one, std::size_t other) {
            return rough_product(volume_.arrays[one].shape) >
                   rough_product(volume_.arrays[other].shape);
        };
        std::vector<std::size_t> order(image.levels.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        if (std::ranges::is_sorted(order, finer)) return;
        std::ranges::stable_sort(order, finer);
        std::vector<ImageLevel> levels;
        std::vector<ChunkedArray> arrays;
        for (const std::size_t i : order) {
            levels.push_back(image.levels[i]);
            arrays.push_back(volume_.arrays[i]);
        }
        image.levels = std::move(levels);
        volume_.arrays = std::move(arrays);
        volume_.info.notes.emplace_back(
            "its levels were not listed from fine to coarse: they were sorted");
    }

    /// For images of versions before 0.4, whose levels tell no scales.
    void compare_sizes(Image& image) {
        for (const ChunkedArray& array : volume_.arrays) {
            if (array.axes() != image.axes.size()) return;  // which is refused
        }
        const ImageLevel finest = image.levels[0];
        for (std::size_t i = 1; i < image.levels.size(); ++i) {
            const std::vector<double> factors = factors_by_size(volume_.arrays, i);
            for (std::size_t a = 0; a < factors.size(); ++a) {
                image.levels[i].scale[a] *= factors[a];
                image.levels[i].translation[a] += finest.scale[a] * (factors[a] - 1) / 2;
            }
        }
        volume_.info.notes.emplace_back(
            "it does not tell the scales of its levels: their sizes were compared");
    }

    const Objects& objects_;
    std::string folder_;
    const StoreOptions& options_;
    std::size_t room_;  ///< [bytes] for more metadata
    ChunkedVolume volume_;
};

}  // namespace

std::shared_ptr<const Store> open_zarr(std::shared_ptr<const Objects> objects,
                                       const std::string& address, const StoreOptions& options) {
    return about(address, [&]() -> std::shared_ptr<const Store> {
        auto volume = Opening(*objects, "", options).volume(address);
        return volume ? chunked_store(objects, *std::move(volume), options.unpacking) : nullptr;
    });
}

}  // namespace palpate::stream

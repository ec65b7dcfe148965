// Opens OME-Zarr images of versions 0.4 (Zarr 2) and 0.5 (Zarr 3), single Zarr arrays, and the
// first series of what bioformats2raw writes.
#include <algorithm>
#include <cmath>

#include "palpate/io/error.hpp"
#include "stream/chunked_store.hpp"
#include "stream/stores.hpp"
#include "stream/zarr_metadata.hpp"

namespace palpate::stream {
namespace {

using Json = nlohmann::json;
constexpr std::uint64_t most_metadata = 8 << 20;  // [bytes] of one file
constexpr std::size_t most_series = 16;           // that are looked for
constexpr double longest_grid = 1 << 30;          // [samples] along an axis

Wanted metadata(const std::string& folder, const char* name) {
    return {key_below(folder, name), std::nullopt, most_metadata, false, false, true};
}

Json parsed(const std::optional<Bytes>& bytes, const std::string& name) {
    if (!bytes) return nullptr;
    try {
        return Json::parse(reinterpret_cast<const char*>(bytes->data()),
                           reinterpret_cast<const char*>(bytes->data() + bytes->size()));
    } catch (const Json::exception&) {
        throw io::InputError(name + ": is not JSON; the metadata are damaged: copy them again");
    }
}

/// What the metadata of a folder say, of either version.
struct Node {
    Json array;       ///< null unless it is one
    Json attributes;  ///< null if there are none
    int version = 0;  ///< of Zarr; 0: there is nothing
};

/// Looks into several folders at once.
std::vector<Node> nodes_in(const Objects& objects, std::span<const std::string> folders) {
    std::vector<Wanted> wanted;
    constexpr std::array names = {"zarr.json", ".zattrs", ".zarray", ".zgroup"};
    for (const std::string& folder : folders) {
        for (const char* name : names) wanted.push_back(metadata(folder, name));
    }
    const auto all = objects.get_all(wanted, {});
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < folders.size(); ++i) {
        const auto json = [&](std::size_t n) {
            const std::size_t at = i * names.size() + n;
            return parsed(all[at], objects.name_of(wanted[at].key));
        };
        Node node;
        if (Json zarr = json(0); zarr.is_object()) {
            node.version = 3;
            node.attributes = zarr.value("attributes", Json());
            if (zarr.value("node_type", Json()) == "array") node.array = std::move(zarr);
        } else if (Json attributes = json(1), array = json(2);
                   !attributes.is_null() || !array.is_null() || all[i * names.size() + 3]) {
            node = {std::move(array), std::move(attributes), 2};
        }
        nodes.push_back(std::move(node));
    }
    return nodes;
}

ChunkedArray array_from(const Node& node, const std::string& folder) {
    if (node.array.is_null())
        throw BadMetadata("its level '" + folder + "' is not there; copy it again");
    return node.version == 3 ? zarr3_array(node.array, folder) : zarr2_array(node.array, folder);
}

/// Which axis is which. Throws BadMetadata for one that is neither space, time nor channel.
struct Roles {
    std::array<int, 3> space = {-1, -1, -1};
    int time = -1, channel = -1;
};

Roles roles_of(const std::vector<OmeAxis>& axes) {
    Roles roles;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const std::string& name = axes[a].name;
        int* const role = name == "x"   ? &roles.space[0]
                          : name == "y" ? &roles.space[1]
                          : name == "z" ? &roles.space[2]
                          : name == "t" ? &roles.time
                          : name == "c" ? &roles.channel
                                        : nullptr;
        if (!role || *role >= 0) {
            throw BadMetadata("its axis '" + name + "' is not one of t, c, z, y, x, once each");
        }
        *role = static_cast<int>(a);
    }
    if (roles.space[0] < 0 || roles.space[1] < 0) throw BadMetadata("it has no axes x and y");
    return roles;
}

/// An array without OME metadata: its last three axes are z, y, x, those before have to be single.
OmeImage image_of_array(const ChunkedArray& array) {
    static constexpr std::array names = {"t", "c", "z", "y", "x"};
    const std::size_t axes = array.axes();
    if (axes < 2 || axes > names.size()) {
        throw BadMetadata("it has " + std::to_string(axes) + " axes; 2 to 5 can be read");
    }
    OmeImage image;
    for (std::size_t a = 0; a < axes; ++a)
        image.axes.push_back({names[names.size() - axes + a], ""});
    const std::vector<double> one(axes, 1), zero(axes, 0);
    image.datasets = {{"", one, zero}};
    return image;
}

double millimetres_of(const OmeAxis& axis, std::vector<std::string>& notes) {
    const double millimetres = millimetres_in(axis.unit);
    if (millimetres > 0) return millimetres;
    const std::string note = axis.unit.empty()
                                 ? "its metadata give no unit of length: mm were taken"
                                 : "its unit of length '" + io::one_line(axis.unit.substr(0, 40)) +
                                       "' is not known: mm were taken";
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
    return 1;
}

class Opening {
  public:
    Opening(const Objects& objects, std::string folder, const StoreOptions& options)
        : objects_(objects), folder_(std::move(folder)), options_(options) {}

    ChunkedVolume volume(const std::string& address) {
        volume_.info.address = address;
        Node root = nodes_in(objects_, std::array{folder_})[0];
        if (root.version == 0) {
            throw BadMetadata(
                "has no zarr.json, .zgroup or .zarray: it is no Zarr folder; check the name");
        }
        if (!root.array.is_null()) return of_array(root);
        auto image = ome_image(root.attributes);
        if (!image) {
            root = first_series();
            image = ome_image(root.attributes);
        }
        if (!image) {
            throw BadMetadata(
                "has neither an image nor an array of its own; give one in a folder below it");
        }
        take_levels(*image, root.version);
        return std::move(volume_);
    }

  private:
    ChunkedVolume of_array(const Node& root) {
        const ChunkedArray array = array_from(root, folder_);
        volume_.info.format = "Zarr " + std::to_string(root.version);
        volume_.info.notes.push_back("it is an array without a place in space: 1 mm was taken");
        OmeImage image = image_of_array(array);
        for (OmeAxis& axis : image.axes) axis.unit = "millimeter";
        volume_.arrays = {array};
        take_image(image);
        return std::move(volume_);
    }

    /// The series of a bioformats2raw folder are images named 0, 1, ...
    Node first_series() {
        std::vector<std::string> folders;
        for (std::size_t i = 0; i < most_series; ++i)
            folders.push_back(key_below(folder_, std::to_string(i)));
        const auto nodes = nodes_in(objects_, folders);
        if (!ome_image(nodes[0].attributes)) return {};
        std::string others;
        for (std::size_t i = 1; i < nodes.size(); ++i) {
            if (nodes[i].version > 0) others += (others.empty() ? "" : ", ") + std::to_string(i);
        }
        if (!others.empty()) {
            volume_.info.notes.push_back("series 0 was taken; others are " + others +
                                         ": give the folder of one to choose it");
        }
        folder_ = folders[0];
        return nodes[0];
    }

    void take_levels(const OmeImage& image, int version) {
        volume_.info.format = version == 3 ? "OME-Zarr 0.5" : "OME-Zarr 0.4";
        std::vector<std::string> folders;
        for (const OmeDataset& dataset : image.datasets)
            folders.push_back(key_below(folder_, dataset.path));
        const auto nodes = nodes_in(objects_, folders);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            volume_.arrays.push_back(array_from(nodes[i], folders[i]));
        }
        take_image(image);
    }

    void take_image(const OmeImage& image) {
        const Roles roles = roles_of(image.axes);
        StoreInfo& info = volume_.info;
        const ChunkedArray& finest = volume_.arrays[0];
        for (const ChunkedArray& array : volume_.arrays) {
            if (array.axes() != image.axes.size() || array.bytes.stored != finest.bytes.stored) {
                throw BadMetadata(
                    "its levels have different types, or other axes than its metadata say");
            }
        }
        info.type = finest.bytes.type();
        info.fill = finest.bytes.fill;
        info.range = image.range;
        io::note_conversion(finest.bytes.stored, info.notes);
        take_choice(image, roles);
        volume_.space = roles.space;
        for (std::size_t i = 0; i < volume_.arrays.size(); ++i) {
            info.levels.push_back(level_of(volume_.arrays[i], image, image.datasets[i], roles));
        }
        use_spacing();
    }

    void take_choice(const OmeImage& image, const Roles& roles) {
        StoreInfo& info = volume_.info;
        const ChunkedArray& finest = volume_.arrays[0];
        volume_.fixed.assign(finest.axes(), 0);
        if (roles.time >= 0) {
            const auto t = static_cast<std::size_t>(roles.time);
            info.times = static_cast<int>(std::min<std::int64_t>(finest.shape[t], 1 << 30));
            const double unit = seconds_in(image.axes[t].unit);
            const double interval = unit * image.datasets[0].scale[t];
            if (info.times > 1 && interval > 0) info.frame_interval = interval;
            volume_.fixed[t] = options_.time;
        }
        if (roles.channel >= 0) {
            const auto c = static_cast<std::size_t>(roles.channel);
            constexpr std::int64_t most = 1024;
            const auto count = static_cast<std::size_t>(std::min(finest.shape[c], most));
            for (std::size_t i = 0; count > 1 && i < count; ++i) {
                const bool named = i < image.channels.size() && !image.channels[i].empty();
                info.channels.push_back(named ? image.channels[i] : "channel " + std::to_string(i));
            }
            volume_.fixed[c] = options_.channel;
        }
        check_choice(info, options_);
        for (const ChunkedArray& array : volume_.arrays) {
            for (std::size_t a = 0; a < array.axes(); ++a) {
                if (volume_.fixed[a] >= array.shape[a]) {
                    throw BadMetadata("its levels have different numbers of channels or times");
                }
            }
        }
    }

    Level level_of(const ChunkedArray& array, const OmeImage& image, const OmeDataset& dataset,
                   const Roles& roles) {
        Level level;
        level.chunk = Index3::Ones();
        level.geometry.size = Index3::Ones();
        for (Eigen::Index i = 0; i < 3; ++i) {
            if (roles.space[static_cast<std::size_t>(i)] < 0) continue;
            const auto a = static_cast<std::size_t>(roles.space[static_cast<std::size_t>(i)]);
            if (static_cast<double>(array.shape[a]) > longest_grid) {
                throw BadMetadata("it has more than 2^30 samples along an axis");
            }
            level.geometry.size[i] = static_cast<int>(array.shape[a]);
            level.chunk[i] = static_cast<int>(array.chunk[a]);
            const double unit = millimetres_of(image.axes[a], volume_.info.notes);
            level.geometry.spacing[i] = dataset.scale[a] * unit;
            level.geometry.origin[i] = dataset.translation[a] * unit;
        }
        if (image.direction) level.geometry.direction = *image.direction;
        try {
            check(level.geometry);
        } catch (const std::invalid_argument& e) {
            throw BadMetadata(std::string("its place in space is not possible (") + e.what() + ")");
        }
        return level;
    }

    /// The spacing that the caller gives is that of the finest level.
    void use_spacing() {
        if (!options_.spacing) return;
        const Geometry finest = volume_.info.levels[0].geometry;
        const Vec3 factor = options_.spacing->cwiseQuotient(finest.spacing);
        for (Level& level : volume_.info.levels) {
            Geometry& grid = level.geometry;
            grid.spacing = grid.spacing.cwiseProduct(factor);
            const Vec3 apart = grid_axes_from_physical(finest, grid.origin - finest.origin);
            grid.origin = finest.origin + finest.direction * apart.cwiseProduct(factor);
        }
    }

    const Objects& objects_;
    std::string folder_;
    const StoreOptions& options_;
    ChunkedVolume volume_;
};

}  // namespace

std::shared_ptr<const Store> open_zarr(std::shared_ptr<const Objects> objects,
                                       const std::string& address, const StoreOptions& options) {
    try {
        ChunkedVolume volume = Opening(*objects, "", options).volume(address);
        return chunked_store(std::move(objects), std::move(volume));
    } catch (const BadMetadata& e) {
        throw io::InputError(address + ": " + e.what());
    } catch (const std::invalid_argument& e) {
        throw io::InputError(address + ": " + e.what() + "; its metadata are damaged");
    } catch (const Json::exception&) {
        throw io::InputError(
            address + ": its metadata lack what they need; they are damaged: copy them again");
    }
}

}  // namespace palpate::stream

// Attributes of N5 datasets and groups. Formats: https://github.com/saalfeldlab/n5 and n5-viewer,
// https://github.com/bigdataviewer/bigdataviewer-core (BDV N5 format), Neuroglancer's n5 data
// source.
#include "stream/formats/n5_metadata.hpp"

#include <algorithm>
#include <bit>

#include "io/chunked_image.hpp"
#include "io/words.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/metadata_files.hpp"
#include "stream/formats/zarr_metadata.hpp"

namespace palpate::stream {
namespace {

using Json = nlohmann::json;
using Numbers = std::vector<double>;

/// Sizes of N5, the fastest axis first, turned round.
std::vector<std::int64_t> n5_sizes(const Json& list, const char* what) {
    std::vector<std::int64_t> sizes = sizes_of(list, what);
    std::ranges::reverse(sizes);
    return sizes;
}

std::string compression_of(const Json& attributes) {
    if (attributes.contains("compression")) {
        return attributes["compression"].at("type").get<std::string>();
    }
    return attributes.at("compressionType").get<std::string>();  // N5 1.0
}

std::vector<Codec> n5_codecs(const std::string& compression) {
    if (compression == "raw") return {};
    if (compression == "gzip" || compression == "zlib") return {Codec::gzip};
    if (compression == "lz4") return {Codec::lz4_blocks};
    if (compression == "blosc") return {Codec::blosc};
    if (compression == "zstd") return {Codec::zstd};
    throw BadMetadata("its compression '" + compression +
                      "' is not read; store it with gzip, zstd, lz4 or blosc");
}

/// The innermost attribute of a name; null if there is none.
const Json& attribute(std::span<const Json> groups, const char* name) {
    for (const Json& group : groups) {
        if (group.contains(name)) return group[name];
    }
    return member({}, name);
}

/// A number for each axis, the slowest first. Lists of three numbers are of x, y and z, whatever
/// other axes there are, which have `otherwise`. Nothing if it is no such list.
std::optional<Numbers> along_axes(const Json& list, std::size_t axes, double otherwise) {
    if (!list.is_array() || (list.size() != axes && (list.size() != 3 || axes < 3))) {
        return std::nullopt;
    }
    Numbers numbers(axes, otherwise);
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (!list[i].is_number()) return std::nullopt;
        numbers[axes - 1 - i] = list[i].get<double>();
    }
    return numbers;
}

struct Resolution {
    Numbers spacing;
    std::vector<std::string> units;  ///< of each axis
};

/// {"pixelResolution": {"dimensions": [..], "unit": ".."}}, or lists with units beside them.
std::optional<Resolution> resolution_of(std::span<const Json> groups, std::size_t axes) {
    for (const char* name : {"pixelResolution", "resolution"}) {
        const Json& given = attribute(groups, name);
        const auto spacing =
            along_axes(given.is_object() ? member(given, "dimensions") : given, axes, 1);
        if (!spacing) continue;
        const Json& unit = given.is_object() ? member(given, "unit") : attribute(groups, "unit");
        std::vector<std::string> units(axes, unit.is_string() ? unit.get<std::string>() : "");
        const Json& all = attribute(groups, "units");
        for (std::size_t i = 0; !unit.is_string() && all.is_array() && i < axes; ++i) {
            const Json& one = i < all.size() ? all[i] : all.empty() ? unit : all.back();
            if (one.is_string()) units[axes - 1 - i] = one.get<std::string>();
        }
        return Resolution{*spacing, units};
    }
    return std::nullopt;
}

/// How many samples of the finest level one of level `at` has along each axis.
std::optional<Numbers> factors_of(std::span<const Json> groups, const Json& level, std::size_t at,
                                  std::size_t axes) {
    if (level.contains("downsamplingFactors")) {
        if (auto own = along_axes(level["downsamplingFactors"], axes, 1)) return own;
    }
    for (const char* name : {"downsamplingFactors", "scales"}) {
        const Json& all = attribute(groups, name);
        if (!all.is_array() || at >= all.size()) continue;
        if (auto factors = along_axes(all[at], axes, 1)) return factors;
    }
    return at == 0 ? std::optional(Numbers(axes, 1)) : std::nullopt;
}

/// Place of a level along axes that have names.
struct NamedPlace {
    std::vector<ImageAxis> axes;
    Numbers scale, translation;
};

/// Janelia's: {"axes": ["z", "y", "x"], "scale": [..], "translate": [..], "units": [..]}, in any
/// order of the axes.
std::optional<NamedPlace> transform_of(const Json& object) {
    const Json& transform = member(object, "transform");
    if (!transform.contains("axes")) return std::nullopt;
    const Json &translate = member(transform, "translate"), &units = member(transform, "units");
    NamedPlace place;
    for (const Json& name : transform["axes"]) {
        const std::size_t i = place.axes.size();
        const bool has_unit = units.is_array() && i < units.size() && units[i].is_string();
        place.axes.push_back({axis_name(name), has_unit ? units[i].get<std::string>() : ""});
        place.scale.push_back(transform.at("scale").at(i).get<double>());
        place.translation.push_back(translate.empty() ? 0 : translate.at(i).get<double>());
    }
    return place;
}

/// What the `multiscales` of a group say of a level in this folder: Janelia's transform, or the
/// transformations of OME-NGFF.
std::optional<NamedPlace> multiscale_of(std::span<const Json> groups, const std::string& folder) {
    const auto group =
        std::ranges::find_if(groups, [](const Json& one) { return one.contains("multiscales"); });
    if (group == groups.end()) return std::nullopt;
    const Json& all = (*group)["multiscales"];
    if (!all.is_array() || all.empty()) return std::nullopt;
    const Json& datasets = member(all[0], "datasets");
    const auto last_name = [](const std::string& path) {
        return path.substr(path.find_last_of('/') + 1);
    };
    for (std::size_t i = 0; datasets.is_array() && i < datasets.size(); ++i) {
        const Json& path = member(datasets[i], "path");
        if (!path.is_string() || last_name(path.get<std::string>()) != last_name(folder)) continue;
        if (auto place = transform_of(datasets[i])) return place;
        if (!all[0].contains("axes") || group->contains("ome")) return std::nullopt;
        const auto image = ome_image(*group);
        return NamedPlace{image->axes, image->levels[i].scale, image->levels[i].translation};
    }
    return std::nullopt;
}

/// True if it names every axis of space.
bool take_place(const std::optional<NamedPlace>& place, Image& image, ImageLevel& level) {
    if (!place) return false;
    std::size_t open = 0;
    for (std::size_t a = 0; a < image.axes.size(); ++a) {
        const std::string& name = image.axes[a].name;
        const auto found = std::ranges::find(place->axes, name, &ImageAxis::name);
        if (found == place->axes.end()) {
            open += name == "z" || name == "y" || name == "x";
            continue;
        }
        const auto i = static_cast<std::size_t>(found - place->axes.begin());
        level.scale[a] = place->scale[i];
        level.translation[a] = place->translation[i];
        image.axes[a].unit = found->unit;
    }
    return open == 0;
}

/// The names in `axes`, the fastest first, or the usual ones.
std::vector<ImageAxis> n5_axes(std::span<const Json> groups, const Json& finest,
                               std::size_t count) {
    std::vector<ImageAxis> axes = usual_axes(count);
    const Json& names = finest.contains("axes") ? finest["axes"] : attribute(groups, "axes");
    if (!names.is_array() || names.size() != count) return axes;
    for (std::size_t i = 0; i < count; ++i) {
        axes[count - 1 - i].name = axis_name(names[i]);
    }
    return axes;
}

}  // namespace

ChunkedArray n5_array(const Json& attributes, const std::string& folder) {
    ChunkedArray array;
    array.folder = folder;
    array.separator = '/';
    array.n5_blocks = true;
    array.shape = n5_sizes(attributes.at("dimensions"), "dimensions");
    array.chunk = n5_sizes(attributes.at("blockSize"), "blockSize");
    const std::string type = attributes.at("dataType").get<std::string>();
    const auto stored = io::stored_named(type);
    if (!stored) {
        throw BadMetadata("its samples are of type '" + io::one_line(type.substr(0, 40)) +
                          "', which is not read; store it as integers, float32 or float64");
    }
    array.bytes.stored = *stored;
    array.bytes.swapped = std::endian::native == std::endian::little && array.bytes.size() > 1;
    array.stored_axes = axes_in_order(array);
    array.codecs = n5_codecs(compression_of(attributes));
    check_array(array);
    return array;
}

Image n5_image(std::span<const Json> groups, std::span<const Json> levels,
               std::span<const ChunkedArray> arrays, std::vector<std::string>& notes) {
    const std::size_t axes = arrays[0].axes();
    Image image;
    image.axes = n5_axes(groups, levels[0], axes);
    auto resolution = resolution_of(groups, axes);
    if (!resolution) resolution = resolution_of(levels.first(1), axes);
    auto offset = along_axes(attribute(groups, "offset"), axes, 0);  // Paintera's, in the same unit
    if (!offset) offset = along_axes(attribute(levels.first(1), "offset"), axes, 0);
    if (!attribute(groups, "affineTransform").is_null()) {
        io::add_note(notes, "its affineTransform is not applied");
    }
    for (const ChunkedArray& array : arrays) {
        if (array.axes() != axes) throw BadMetadata("its levels have different axes");
    }
    bool placed = false;  // the finest level, by the names of its axes
    for (std::size_t i = 0; i < levels.size(); ++i) {
        ImageLevel level{"", Numbers(axes, 1), Numbers(axes, 0)};
        if (take_place(transform_of(levels[i]), image, level) ||
            take_place(multiscale_of(groups, arrays[i].folder), image, level)) {
            placed |= i == 0;
            image.levels.push_back(level);
            continue;
        }
        auto factors = factors_of(groups, levels[i], i, axes);
        if (!factors) {
            factors = factors_by_size(arrays, i);
            io::add_note(notes,
                         "it does not tell the scales of its levels: their sizes were compared");
        }
        for (std::size_t a = 0; a < axes; ++a) {
            const double spacing = placed       ? image.levels[0].scale[a]
                                   : resolution ? resolution->spacing[a]
                                                : 1;
            const double first = placed                 ? image.levels[0].translation[a]
                                 : resolution && offset ? (*offset)[a]
                                                        : 0;
            level.scale[a] = spacing * (*factors)[a];
            level.translation[a] = first + spacing * ((*factors)[a] - 1) / 2;
            if (!placed) image.axes[a].unit = resolution ? resolution->units[a] : "millimeter";
        }
        image.measured = placed || resolution;
        if (!image.measured) io::add_note(notes, "it does not tell its spacing: 1 mm was taken");
        image.levels.push_back(level);
    }
    return image;
}

}  // namespace palpate::stream

// Metadata of OME-Zarr images, versions 0.1 to 0.6: https://ngff.openmicroscopy.org.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "io/words.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/metadata_files.hpp"
#include "stream/formats/zarr_metadata.hpp"

namespace palpate::stream {
namespace {

using Json = nlohmann::json;
constexpr std::size_t most_levels = 64;
constexpr std::size_t most_channels = 1024;

struct Placement {
    std::vector<double> scale, translation;
    bool scaled = false;
};

std::vector<double> numbers_of(const Json& list, std::size_t axes, const char* what) {
    if (!list.is_array() || list.size() != axes) {
        throw BadMetadata(std::string("a ") + what + " of its image has " +
                          std::to_string(list.size()) + " numbers for " + std::to_string(axes) +
                          " axes (t, c, z, y and x if none are named); correct its metadata");
    }
    std::vector<double> numbers;
    for (const Json& number : list) {
        numbers.push_back(number.is_number() ? number.get<double>() : std::nan(""));
        if (!std::isfinite(numbers.back())) {
            throw BadMetadata(std::string("a ") + what + " of its image is no list of numbers");
        }
    }
    return numbers;
}

/// At most one scale, then at most one translation.
Placement placement_of(const Json& object, std::size_t axes) {
    Placement place{std::vector<double>(axes, 1), std::vector<double>(axes, 0)};
    const Json& list = member(object, "coordinateTransformations");
    if (list.is_null()) return place;
    if (!list.is_array() || list.size() > 8)
        throw BadMetadata("its transformations are not sensible");
    bool translated = false;
    // Version 0.6 puts several into one.
    const bool is_sequence = list.size() == 1 && member(list[0], "type") == "sequence";
    const Json& steps = is_sequence ? list[0].at("transformations") : list;
    if (!steps.is_array() || steps.size() > 8)
        throw BadMetadata("its transformations are not sensible");
    for (const Json& one : steps) {
        const std::string type = one.at("type").get<std::string>();
        if (type == "identity") continue;
        const bool is_scale = type == "scale";
        if ((!is_scale && type != "translation") || !one.contains(type)) {
            throw BadMetadata("its transformation '" + type +
                              "' is not read; use scale and translation");
        }
        if (translated || (is_scale && place.scaled)) {
            throw BadMetadata(
                "its transformations are not one scale and then one translation; write them so");
        }
        (is_scale ? place.scale : place.translation) =
            numbers_of(one[type], axes, is_scale ? "scale" : "translation");
        (is_scale ? place.scaled : translated) = true;
    }
    return place;
}

/// From version 0.6 on, a coordinate system has the axes: the one that the levels lie in, which
/// their transformations name as their output. Earlier versions have no systems.
const Json& system_of(const Json& image) {
    static const Json none;
    const Json& systems = member(image, "coordinateSystems");
    if (!systems.is_array() || systems.empty()) return none;
    const Json& levels = member(image, "datasets");
    const Json& steps = levels.is_array() && !levels.empty()
                            ? member(levels[0], "coordinateTransformations")
                            : levels;
    const Json& output = steps.is_array() && !steps.empty() ? member(steps[0], "output") : steps;
    const Json& name = output.is_object() ? member(output, "name") : output;
    const auto named =
        std::ranges::find_if(systems, [&](const Json& one) { return member(one, "name") == name; });
    return named == systems.end() ? systems[0] : *named;
}

/// "L" for right-to-left: RFC-4 of OME-NGFF, https://ngff.openmicroscopy.org/rfc/4.
std::string side_of(const Json& axis) {
    static constexpr std::pair<std::string_view, std::string_view> sides[] = {
        {"right-to-left", "L"},         {"left-to-right", "R"},
        {"anterior-to-posterior", "P"}, {"posterior-to-anterior", "A"},
        {"inferior-to-superior", "S"},  {"superior-to-inferior", "I"}};
    const Json& orientation = member(axis, "orientation");
    if (orientation.is_null()) return {};
    const Json& value = orientation.is_object() ? member(orientation, "value") : orientation;
    for (const auto& [name, side] : sides) {
        if (value == name) return std::string(side);
    }
    return "?";
}

/// Version 0.4 and 0.5 give objects, earlier ones names or nothing (then t, c, z, y, x).
std::vector<ImageAxis> axes_of(const Json& image) {
    std::vector<ImageAxis> axes;
    static const Json usual = {"t", "c", "z", "y", "x"};
    const Json& system = system_of(image);
    const Json& given = member(system.is_null() ? image : system, "axes");
    const Json& list = given.is_null() ? usual : given;
    if (!list.is_array() || list.empty() || list.size() > 8) {
        throw BadMetadata("its axes are not sensible");
    }
    for (const Json& axis : list) {
        if (axis.is_string()) {
            axes.push_back({axis_name(axis), ""});
            continue;
        }
        // Some labels of the IDR have "units".
        const Json& unit = member(axis, axis.contains("unit") ? "unit" : "units");
        std::string name = axis_name(axis.at("name"));
        if (member(axis, "type") == "time") name = "t";
        if (member(axis, "type") == "channel") name = "c";
        axes.push_back({name, unit.is_string() ? unit.get<std::string>() : "", side_of(axis)});
    }
    return axes;
}

std::vector<std::string> channel_names(const Json& attributes) {
    std::vector<std::string> names;
    const Json& channels = member(member(attributes, "omero"), "channels");
    if (!channels.is_array()) return names;
    for (const Json& channel : channels) {
        if (names.size() == most_channels) break;
        const Json& label = member(channel, "label");
        names.push_back(label.is_string() ? io::one_line(label.get<std::string>().substr(0, 64))
                                          : "");
    }
    return names;
}

/// Versions after 0.5, and images that are not read.
std::vector<std::string> notes_on(const Json& attributes, const Json& images) {
    std::vector<std::string> notes;
    const Json& own = member(attributes, "version");
    const Json& version = own.is_null() ? member(images[0], "version") : own;
    const std::string text = version.is_string() ? version.get<std::string>() : version.dump();
    const char* const end = text.data() + text.size();
    int major = 0, minor = 0;
    const char* const dot = std::from_chars(text.data(), end, major).ptr;
    if (dot != end) std::from_chars(dot + 1, end, minor);
    if (major > 0 || minor > 6) {
        notes.push_back("its version of OME-Zarr is " + io::one_line(text.substr(0, 20)) +
                        ": it was read as 0.6");
    }
    if (images.size() > 1) {
        notes.push_back("it has " + std::to_string(images.size()) +
                        " images (multiscales): the first was taken");
    }
    return notes;
}

std::optional<Range> range_of(const Json& attributes) {
    const Json& given = member(member(attributes, "palpate"), "range");
    if (given.is_null()) return std::nullopt;
    const std::vector<double> range = numbers_of(given, 2, "range");
    if (range[0] > range[1]) return std::nullopt;
    return Range{range[0], range[1]};
}

/// Reads values for which OME-Zarr has no place.
void take_direction(const Json& attributes, Image& image) {
    const Json& ours = member(attributes, "palpate");
    const auto holds = [&](const char* name) {
        return member(ours, name).is_null() || member(ours, name) == true;
    };
    image.measured = holds("measured");
    if (member(ours, "direction").is_null()) return;
    const std::vector<double> columns = numbers_of(ours["direction"], 9, "direction");
    image.direction = Mat3(Eigen::Map<const Mat3>(columns.data()));
    image.oriented = holds("oriented");
}

}  // namespace

std::string axis_name(const Json& name) {
    const std::string text = name.is_string() ? io::lower(name.get<std::string>()) : "";
    if (text == "time" || text == "channel") return text.substr(0, 1);
    return io::one_line(text.substr(0, 40));
}

std::optional<Image> ome_image(const Json& given) {
    if (!given.is_object()) return std::nullopt;
    const Json& attributes =
        given.contains("ome") && given["ome"].is_object() ? given["ome"] : given;
    if (!attributes.contains("multiscales")) return std::nullopt;
    const Json& all = attributes["multiscales"];
    if (!all.is_array() || all.empty()) throw BadMetadata("its list of images is empty");
    const Json& image = all[0];
    Image found;
    found.axes = axes_of(image);
    const std::size_t axes = found.axes.size();
    // From version 0.6 on, these lead from the space of the levels to others.
    const bool leads_on = !system_of(image).is_null();
    const Placement whole = placement_of(leads_on ? Json() : image, axes);
    const Json& datasets = image.at("datasets");
    if (!datasets.is_array() || datasets.empty() || datasets.size() > most_levels) {
        throw BadMetadata("it has no levels, or more than 64");
    }
    found.scaled = false;
    for (const Json& dataset : datasets) {
        Placement place = placement_of(dataset, axes);
        found.scaled |= place.scaled;
        for (std::size_t a = 0; a < axes; ++a) {
            place.translation[a] = whole.scale[a] * place.translation[a] + whole.translation[a];
            place.scale[a] *= whole.scale[a];
        }
        found.levels.push_back(
            {dataset.at("path").get<std::string>(), place.scale, place.translation});
    }
    found.channels = channel_names(attributes);
    found.range = range_of(given);
    found.notes = notes_on(attributes, all);
    if (leads_on && !member(image, "coordinateTransformations").empty()) {
        found.notes.emplace_back(
            "it has further transformations, from the space of its levels to others: they were "
            "not applied");
    }
    take_direction(given, found);
    if (!found.scaled) {
        found.measured = false;
        found.notes.emplace_back("its metadata give no scale: 1 was taken");
    }
    return found;
}

}  // namespace palpate::stream

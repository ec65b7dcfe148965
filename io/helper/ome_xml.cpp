// OME-XML in the description of a TIFF file. See the header.
#include "io/helper/ome_xml.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "io/helper/decode.hpp"
#include "io/helper/xml.hpp"
#include "io/system/number.hpp"
#include "io/units.hpp"

namespace palpate::io {
namespace {

constexpr std::int64_t most_planes = 1 << 20;
constexpr std::uint32_t no_page = UINT32_MAX;

std::int64_t whole(const XmlElement& element, const char* name, std::int64_t otherwise,
                   std::int64_t least = 1) {
    const std::string text = trimmed(element.attribute(name).value());
    if (text.empty()) return otherwise;
    const auto number = number_from<std::int64_t>(text);
    if (!number || *number < least || *number > 1 << 30) {
        throw Failure("its OME-XML has the " + std::string(name) + " '" + text.substr(0, 40) +
                      "', which is not possible; write it again");
    }
    return *number;
}

void take_spacing(const XmlElement& pixels, OmeImage& image) {
    Vec3 spacings;
    std::array<std::string, 3> units;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string name = std::string("PhysicalSize") + "XYZ"[a];
        spacings[static_cast<Eigen::Index>(a)] =
            number_from<double>(trimmed(pixels.attribute(name.c_str()).value()))
                .value_or(std::nan(""));
        units[a] = pixels.attribute((name + "Unit").c_str()).value();
        if (units[a].empty()) units[a] = "um";
    }
    set_spacing(image, spacings, units, "its OME-XML");
}

/// Which plane has which number, along z, channels and times, in an order such as "XYZCT".
struct PlaneOrder {
    std::array<std::size_t, 3> axes{};  ///< of OmeImage::sizes, the fastest first
    explicit PlaneOrder(const std::string& name) {
        static const std::string letters = "ZCT";
        if (name.size() != 5 || name.substr(0, 2) != "XY") wrong(name);
        for (std::size_t i = 0; i < 3; ++i) {
            axes[i] = letters.find(name[2 + i]);
            if (axes[i] == std::string::npos ||
                std::count(name.begin(), name.end(), name[2 + i]) != 1)
                wrong(name);
        }
    }
    [[noreturn]] static void wrong(const std::string& name) {
        throw Failure("its OME-XML has the DimensionOrder '" + name.substr(0, 40) +
                      "', which is not possible; write it again");
    }
};

/// Gives the planes from `at` (z, channel, time) on the pages from `page` on.
void put_pages(OmeImage& image, const PlaneOrder& order, std::array<std::int64_t, 3> at,
               std::int64_t page, std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
            if (at[a] >= image.sizes[a]) {
                throw Failure("its OME-XML tells of more planes than it has; write it again");
            }
        }
        image.pages[image.plane(at[0], at[1], at[2])] = static_cast<std::uint32_t>(page + i);
        for (std::size_t i_axis = 0; i_axis < 3; ++i_axis) {
            const std::size_t a = order.axes[i_axis];
            if (++at[a] < image.sizes[a] || i_axis == 2) break;
            at[a] = 0;
        }
    }
}

/// The type of its samples in our words; empty for those that have none (bit, complex).
std::string type_in(const XmlElement& pixels) {
    const std::string type = pixels.attribute("Type").value();
    if (type == "float") return "float32";
    if (type == "double") return "float64";
    return stored_named(type) ? type : "";
}

/// Files that planes lie in, by their UUID and perhaps their name. One of another name is this one,
/// renamed.
class FilesOfPlanes {
  public:
    explicit FilesOfPlanes(std::string own) : own_(std::move(own)) {}

    void take(const XmlElement& data) {
        for (const XmlElement& in : elements_at(data, "UUID")) {
            const std::string uuid = trimmed(in.text().get()),
                              name = in.attribute("FileName").value();
            names_[uuid.empty() ? name : uuid] = name;
        }
        names_.erase("");
        if (names_.size() < 2) return;
        const auto named = [](const auto& file) {
            return quoted(std::filesystem::path(file.second.empty() ? file.first : file.second));
        };
        throw Failure("has planes in " + named(*names_.begin()) + ", others in " +
                      named(*names_.rbegin()) + "; images over several files are not read");
    }

    void note(std::vector<std::string>& notes) const {
        if (own_.empty() || names_.empty() || names_.contains(own_)) return;
        const auto& [uuid, name] = *names_.begin();
        if (uuid == name) return;
        notes.push_back("its OME-XML says that its planes are those of another file (" +
                        (name.empty() ? uuid : name).substr(0, 60) +
                        "): those of this one were taken");
    }

  private:
    std::string own_;
    std::map<std::string, std::string> names_;  ///< by UUID, or by name
};

void take_pages(const XmlElement& pixels, const std::string& own, OmeImage& image,
                std::vector<std::string>& notes) {
    const PlaneOrder order(pixels.attribute("DimensionOrder").value());
    const std::int64_t planes = image.sizes[0] * image.sizes[1] * image.sizes[2];
    image.pages.assign(static_cast<std::size_t>(planes), no_page);
    const auto all = elements_at(pixels, "TiffData");
    if (all.empty()) put_pages(image, order, {0, 0, 0}, 0, planes);
    FilesOfPlanes files(own);
    for (const XmlElement& data : all) {
        files.take(data);
        const std::int64_t page = whole(data, "IFD", 0, 0);
        const bool alone = *data.attribute("IFD").value() != '\0';
        // Before 2008 it was NumPlanes.
        const std::int64_t told = whole(data, "NumPlanes", alone ? 1 : planes, 0);
        const std::int64_t count = whole(data, "PlaneCount", told, 0);
        if (count > planes) throw Failure("its OME-XML tells of more planes than it has");
        put_pages(
            image, order,
            {whole(data, "FirstZ", 0, 0), whole(data, "FirstC", 0, 0), whole(data, "FirstT", 0, 0)},
            page, count);
    }
    files.note(notes);
    if (std::ranges::find(image.pages, no_page) != image.pages.end()) {
        throw Failure("its OME-XML does not tell where all its planes are; write it again");
    }
}

}  // namespace

void set_spacing(OmeImage& image, const Vec3& spacings, const std::array<std::string, 3>& units,
                 const std::string& source) {
    const auto x = millimetres_in(units[0]), y = millimetres_in(units[1]),
               z = millimetres_in(units[2]);
    const auto is_length = [](double length) { return std::isfinite(length) && length > 0; };
    const bool has_distance = is_length(spacings[2]);
    image.spacing_note.clear();
    image.distance_note.clear();
    const bool measured = x && y && (z || !has_distance);
    const bool alike = units[0] == units[1] && (units[0] == units[2] || !has_distance);
    if (!is_length(spacings[0]) || !is_length(spacings[1]) || (!measured && (x || !alike))) {
        image.spacing_note = source + " does not tell its spacing: 1 mm was taken along every axis";
        return;
    }
    Vec3 taken = spacings / spacings[0];
    if (measured) taken = spacings.cwiseProduct(Vec3(*x, *y, z.value_or(1)));
    if (!has_distance) taken[2] = taken[0];
    image.spacing = {taken[2], taken[1], taken[0]};
    if (!measured) {
        image.spacing_note = source +
                             (units[0].empty() ? " gives no unit of length"
                                               : " has the unit '" + units[0].substr(0, 40) +
                                                     "', which is no length") +
                             ": 1 mm was taken along x, and along the other axes in proportion";
    } else if (!has_distance) {
        image.distance_note =
            source + " does not tell the distance between slices: that of pixels was taken";
    }
}

void take_counts(OmeImage& image, const CountedPages& counted) {
    std::vector<std::uint32_t> in_file;
    for (const std::size_t plane : counted.planes) in_file.push_back(image.pages.at(plane));
    if (in_file.empty()) in_file = image.pages;
    image.format = counted.format;
    image.sizes = counted.sizes;
    put_pages(image, PlaneOrder(counted.order), {0, 0, 0}, 0, std::ssize(in_file));
    for (std::uint32_t& page : image.pages) page = in_file[page];
    for (std::int64_t c = 0; image.sizes[1] > 1 && c < image.sizes[1]; ++c) {
        image.channels.push_back("channel " + std::to_string(c));
    }
    if (counted.metres != Vec3::Zero()) set_spacing(image, counted.metres, {"m", "m", "m"}, "it");
    if (image.sizes[2] > 1) image.frame_interval = std::max(counted.seconds, 0.0);
}

bool is_ome_xml(const std::string& description) {
    constexpr std::size_t byte_order_mark = 3;
    const bool is_xml = trimmed(description).find('<') <= byte_order_mark;
    // Its end may be cut off, which is refused as no XML.
    return is_xml && (description.find("<OME") != std::string::npos ||
                      description.find(":OME ") != std::string::npos ||  // with a prefix
                      description.find(":OME>") != std::string::npos);
}

OmeImage ome_image(const std::string& xml, std::vector<std::string>& notes) {
    const pugi::xml_document document = parse_xml(xml, "its OME-XML");
    const XmlElement root = document.document_element();
    if (!elements_at(root, "BinaryOnly").empty()) {
        throw Failure("keeps its OME-XML in another file; images over several files are not read");
    }
    const auto images = elements_at(root, "Image");
    const auto all = images.empty() ? images : elements_at(images[0], "Pixels");
    if (all.empty()) throw Failure("its OME-XML tells of no image; write it again");
    const XmlElement& pixels = all[0];
    if (images.size() > 1) {
        notes.push_back("the first of its " + std::to_string(images.size()) + " images was taken");
    }
    OmeImage image;
    image.format = "OME-TIFF";
    image.sizes = {whole(pixels, "SizeZ", 1), whole(pixels, "SizeC", 1), whole(pixels, "SizeT", 1)};
    image.plane_size = {whole(pixels, "SizeX", 0), whole(pixels, "SizeY", 0)};
    image.type = type_in(pixels);
    const double planes = static_cast<double>(image.sizes[0]) *
                          static_cast<double>(image.sizes[1]) * static_cast<double>(image.sizes[2]);
    if (planes > static_cast<double>(most_planes)) throw Failure("it has more than 2^20 planes");
    take_spacing(pixels, image);
    const auto interval = number_from<double>(trimmed(pixels.attribute("TimeIncrement").value()));
    if (interval && image.sizes[2] > 1) {
        const std::string unit = pixels.attribute("TimeIncrementUnit").value();
        image.frame_interval = frame_times(*interval, 0, unit.empty() ? "s" : unit, notes).interval;
    }
    const auto channels = elements_at(pixels, "Channel");
    for (std::size_t c = 0; image.sizes[1] > 1 && c < static_cast<std::size_t>(image.sizes[1]);
         ++c) {
        const std::string name = c < channels.size() ? channels[c].attribute("Name").value() : "";
        image.channels.push_back(name.empty() ? "channel " + std::to_string(c) : name);
    }
    take_pages(pixels, trimmed(root.attribute("UUID").value()), image, notes);
    return image;
}

}  // namespace palpate::io

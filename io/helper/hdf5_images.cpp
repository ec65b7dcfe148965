// The two layouts of images in HDF5 that are read: Imaris 5.5
// (https://imaris.oxinst.com/support/imaris-file-format) and BigDataViewer
// (https://imagej.net/plugins/bdv, "XML/HDF5 File Format").
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numeric>

#include "io/helper/decode.hpp"
#include "io/helper/hdf5_file.hpp"
#include "io/helper/headers.hpp"
#include "io/helper/images.hpp"
#include "io/helper/xml.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

constexpr int most_resolutions = 64;

std::string with_number(const char* format, int number) {
    char text[64];
    std::snprintf(text, sizeof text, format, number);
    return text;
}

/// "2008-02-19 11:42:05.000" as seconds since some day.
std::optional<double> seconds_of(const std::string& text) {
    int year = 0, hour = 0, minute = 0;
    unsigned month = 0, day = 0;
    double second = 0;
    if (std::sscanf(text.c_str(), "%d-%u-%u %d:%d:%lf", &year, &month, &day, &hour, &minute,
                    &second) != 6) {
        return std::nullopt;
    }
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                           std::chrono::day(day)};
    if (!date.ok()) return std::nullopt;
    const auto days = std::chrono::sys_days(date).time_since_epoch().count();
    return 86400.0 * static_cast<double>(days) + 3600.0 * hour + 60.0 * minute + second;
}

double imaris_interval(const Hdf5File& file, int times) {
    if (times < 2) return 0;
    const auto at = [&](int time) {
        return seconds_of(
            file.text("/DataSetInfo/TimeInfo", with_number("TimePoint%d", time + 1).c_str()));
    };
    const auto first = at(0), last = at(times - 1);
    return first && last && *last > *first ? (*last - *first) / (times - 1) : 0;
}

/// The values between the first and the last filled class of Imaris's histogram, if that counts
/// every sample. Its classes lie between HistogramMin and HistogramMax, whether these are their
/// outer borders or the middles of the outermost.
std::optional<std::array<double, 2>> imaris_range(const Hdf5File& file, const std::string& channel,
                                                  const ImageArray& finest) {
    const auto low = file.number(channel, "HistogramMin"),
               high = file.number(channel, "HistogramMax");
    const std::string histogram = channel + "/Histogram";
    if (!low || !high || !(*low < *high) || !file.has(histogram)) return std::nullopt;
    const std::vector<double> counts = file.numbers(histogram);
    const double samples = static_cast<double>(finest.shape[0]) *
                           static_cast<double>(finest.shape[1]) *
                           static_cast<double>(finest.shape[2]);
    if (counts.size() < 2 || std::accumulate(counts.begin(), counts.end(), 0.0) != samples) {
        return std::nullopt;
    }
    const auto filled = [](double count) { return count > 0; };
    const auto first = std::ranges::find_if(counts, filled) - counts.begin();
    const auto last = std::ssize(counts) - 1 -
                      (std::find_if(counts.rbegin(), counts.rend(), filled) - counts.rbegin());
    const double wide = (*high - *low) / static_cast<double>(counts.size() - 1);
    const double narrow = (*high - *low) / static_cast<double>(counts.size());
    const double least = std::min(*low + (static_cast<double>(first) - 0.5) * wide,
                                  *low + static_cast<double>(first) * narrow);
    const double most = std::max(*low + (static_cast<double>(last) + 0.5) * wide,
                                 *low + static_cast<double>(last + 1) * narrow);
    return std::array{std::max(least, *low), std::min(most, *high)};
}

std::string imaris_channel(int level, int time, int channel) {
    return "/DataSet/ResolutionLevel " + std::to_string(level) + "/TimePoint " +
           std::to_string(time) + "/Channel " + std::to_string(channel);
}

/// A level of Imaris: its dataset is longer than the image, up to a whole number of chunks.
ImageArray imaris_level(const Hdf5File& file, const std::string& channel) {
    ImageArray array = file.array(channel + "/Data");
    static constexpr const char* names[3] = {"ImageSizeZ", "ImageSizeY", "ImageSizeX"};
    for (std::size_t a = 0; a < 3; ++a) {
        const auto size = file.number(channel, names[a]);
        if (!size) continue;
        if (*size < 1 || *size > static_cast<double>(array.shape[a])) {
            throw Failure("its " + std::string(names[a]) +
                          " is not that of its samples: the file is damaged; copy it again");
        }
        array.shape[a] = static_cast<std::int64_t>(*size);
    }
    return array;
}

ChunkedImage imaris_image(const Hdf5File& file, int channel, int time) {
    ChunkedImage image;
    image.format = "Imaris";
    image.times = file.count(
        [](int t) { return "/DataSet/ResolutionLevel 0/TimePoint " + std::to_string(t); });
    const int channels = file.count([](int c) { return imaris_channel(0, 0, c); });
    for (int c = 0; channels > 1 && c < channels; ++c) {
        const std::string name = file.text("/DataSetInfo/Channel " + std::to_string(c), "Name");
        image.channels.push_back(name.empty() ? "channel " + std::to_string(c) : name);
    }
    image.frame_interval = imaris_interval(file, image.times);
    if (channel >= channels || time >= image.times) return image;
    image.unit = in_utf8_or_latin_1(file.text("/DataSetInfo/Image", "Unit"));
    if (image.unit.empty()) {
        image.unit = "micrometer";
        image.notes.emplace_back(
            "it gives no unit of length: micrometres were taken, as Imaris does");
    }
    const int levels = file.count([&](int l) { return imaris_channel(l, time, channel); });
    if (levels > most_resolutions) throw Failure("it has more than 64 levels");
    std::array<double, 3> spacing = {1, 1, 1}, origin = {0, 0, 0}, factor = {1, 1, 1};
    for (int l = 0; l < levels; ++l) {
        ImageArray level = imaris_level(file, imaris_channel(l, time, channel));
        for (std::size_t a = 0; a < 3; ++a) {
            if (l > 0) {
                factor[a] *= factor_between(image.levels.back().shape[a], level.shape[a]);
                continue;
            }
            const std::string axis = std::to_string(2 - a);
            const auto low = file.number("/DataSetInfo/Image", ("ExtMin" + axis).c_str());
            const auto high = file.number("/DataSetInfo/Image", ("ExtMax" + axis).c_str());
            if (!low || !high || !(*low < *high)) {
                throw Failure(
                    "its extent (ExtMin, ExtMax) is missing or not possible; save it again");
            }
            spacing[a] = (*high - *low) / static_cast<double>(level.shape[a]);
            origin[a] = *low + spacing[a] / 2;
        }
        place(level, spacing, origin, factor);
        image.levels.push_back(level);
    }
    image.range = imaris_range(file, imaris_channel(0, time, channel), image.levels.at(0));
    return image;
}

std::string bdv_moment(int time, int setup) {
    return with_number("/t%05d", time) + with_number("/s%02d", setup);
}

/// Voxel size, unit and name of a setup, from the XML file beside the HDF5 file.
struct BdvSetup {
    std::array<double, 3> spacing = {1, 1, 1};
    std::string unit, name;
    bool has_spacing = false;
    bool is_stretched = false;  ///< the spacing is that of its registration
};

/// The setup's attribute `dataType`, which newer files have, says what HDF5's numbers are. Without
/// it, BigDataViewer keeps its 16 bits without a sign in HDF5's with one.
Stored bdv_type(const Hdf5File& file, int setup, Stored stored) {
    const auto told = stored_named(file.text(with_number("/s%02d", setup), "dataType"));
    if (told && size_of(*told) == size_of(stored) && is_real(*told) == is_real(stored)) {
        return *told;
    }
    return stored == Stored::int16 ? Stored::uint16 : stored;
}

/// A fill value of HDF5's type, as the other type of whole numbers means its bits.
double fill_as(Stored stored, double fill) {
    if (is_real(stored)) return fill;
    const double count = std::ldexp(1.0, 8 * static_cast<int>(size_of(stored)));
    const bool has_sign = !name_of(stored).starts_with('u');
    if (!has_sign && fill < 0) return fill + count;
    return has_sign && fill >= count / 2 ? fill - count : fill;
}

std::string resolutions_of(int setup) {
    return with_number("/s%02d/resolutions", setup);
}

/// The numbers N of the groups sN or tN in the file, which may begin anywhere and have gaps.
std::vector<int> numbers_of(const Hdf5File& file, char letter) {
    std::vector<int> numbers;
    for (const std::string& name : file.names()) {
        if (name[0] != letter) continue;
        const auto number = number_from<int>(name.substr(1));
        if (number && *number >= 0) numbers.push_back(*number);
    }
    std::ranges::sort(numbers);
    return numbers;
}

std::vector<int> setups_of(const Hdf5File& file) {
    std::vector<int> setups = numbers_of(file, 's');
    std::erase_if(setups, [&](int s) { return !file.has(resolutions_of(s)); });
    return setups;
}

using Affine = Eigen::Matrix4d;

/// The transformation from a view's voxels to the world: its transforms, of which the last one is
/// applied first.
Affine registration_in(const XmlElement& view) {
    Affine all = Affine::Identity();
    for (const XmlElement& one : elements_at(view, "ViewTransform")) {
        const std::vector<double> rows = numbers_in(text_at(one, "affine"), "affine");
        if (rows.size() != 12) continue;
        Affine affine = Affine::Identity();
        for (Eigen::Index i = 0; i < 12; ++i) {
            affine(i / 4, i % 4) = rows[static_cast<std::size_t>(i)];
        }
        all *= affine;
    }
    return all;
}

/// Whether registrations only stretch the axes, as the voxel size does.
bool only_stretches(const XmlElement& root) {
    return std::ranges::all_of(elements_at(root, "ViewRegistrations/ViewRegistration"),
                               [](const XmlElement& view) {
                                   const Affine affine = registration_in(view);
                                   return affine.isDiagonal(0) && affine.diagonal().minCoeff() > 0;
                               });
}

/// Takes the spacing from a registration that stretches the axes, as BigDataViewer does, where the
/// voxel size only counts voxels. Otherwise the voxel size counts.
void take_stretch(const XmlElement& root, int time, int id, BdvSetup& setup,
                  std::vector<std::string>& notes) {
    for (const XmlElement& view : elements_at(root, "ViewRegistrations/ViewRegistration")) {
        if (view.attribute("timepoint").as_int(-1) != time) continue;
        if (view.attribute("setup").as_int(-1) != id) continue;
        const Affine affine = registration_in(view);
        if (!affine.isDiagonal(0) || !(affine.diagonal().minCoeff() > 0)) return;  // noted
        const Vec3 stretch = affine.diagonal().head<3>();
        const Vec3 size(setup.spacing[2], setup.spacing[1], setup.spacing[0]);
        const Vec3 ratio = stretch.cwiseQuotient(size);
        if (ratio.maxCoeff() <= (1 + 1e-4) * ratio.minCoeff()) return;
        const auto words = [](const Vec3& v) {
            return text_of(v[0]) + " x " + text_of(v[1]) + " x " + text_of(v[2]);
        };
        const bool is_count = size == Vec3::Ones();
        notes.push_back(
            "the ViewRegistrations in its XML file stretch its voxels by " + words(stretch) +
            (is_count
                 ? ", which was taken as their size"
                 : ", which does not fit their size of " + words(size) + ": the size was taken"));
        if (!is_count) return;
        setup.spacing = {stretch[2], stretch[1], stretch[0]};
        setup.is_stretched = true;
        return;
    }
}

std::map<int, BdvSetup> setups_in(const XmlElement& root) {
    std::map<int, BdvSetup> all;
    for (const XmlElement& setup : elements_at(root, "SequenceDescription/ViewSetups/ViewSetup")) {
        const auto id = number_from<int>(trimmed(text_at(setup, "id")));
        if (!id) continue;
        BdvSetup& one = all[*id];
        one.unit = trimmed(text_at(setup, "voxelSize/unit"));
        one.name = trimmed(text_at(setup, "name"));
        const std::vector<double> size = numbers_in(text_at(setup, "voxelSize/size"), "voxelSize");
        one.has_spacing = size.size() == 3;
        for (std::size_t i = 0; i < 3 && one.has_spacing; ++i) one.spacing[2 - i] = size[i];
    }
    return all;
}

/// Rows of x, y, z for each level.
std::vector<std::array<double, 3>> rows_of(const Hdf5File& file, const std::string& dataset) {
    const std::vector<double> numbers = file.numbers(dataset);
    if (numbers.empty() || numbers.size() % 3 != 0 || numbers.size() > 3 * most_resolutions) {
        throw Failure("its list of resolutions is damaged; copy it again");
    }
    std::vector<std::array<double, 3>> rows;
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
        rows.push_back({numbers[i + 2], numbers[i + 1], numbers[i]});
    }
    return rows;
}

ChunkedImage bdv_image(const Hdf5File& file, const std::filesystem::path& path, int channel,
                       int time) {
    ChunkedImage image;
    image.format = "BigDataViewer HDF5";
    const std::vector<int> setups = setups_of(file);
    const std::vector<int> times = numbers_of(file, 't');
    image.times = static_cast<int>(times.size());
    auto xml = path;
    xml.replace_extension(".xml");
    std::map<int, BdvSetup> all;
    pugi::xml_document document;
    if (std::filesystem::exists(xml)) {
        document = read_xml(xml);
        const XmlElement root = document.document_element();
        all = setups_in(root);
        if (!only_stretches(root)) {
            image.notes.emplace_back(
                "the ViewRegistrations in its XML file move, turn or mirror its images: they "
                "are not applied");
        }
    }
    for (const int s : setups) {
        if (setups.size() == 1) break;
        const std::string& name = all[s].name;
        image.channels.push_back(name.empty() ? "setup " + std::to_string(s) : name);
    }
    if (channel >= static_cast<int>(setups.size()) || time >= image.times) return image;
    const int id = setups[static_cast<std::size_t>(channel)];
    const bool has_spacing = all.contains(id) && all[id].has_spacing;
    const int timepoint = number_of_time(time, times, image.notes);
    BdvSetup& setup = all[id];
    take_stretch(document.document_element(), timepoint, id, setup, image.notes);
    image.unit = setup.unit;
    image.measured = has_spacing && !setup.unit.empty();
    if (!image.measured) image.unit = "millimeter";
    if (!has_spacing && !setup.is_stretched) {
        image.notes.emplace_back("no XML file beside it gives its voxel size: 1 mm was taken");
    } else if (setup.unit.empty()) {
        image.notes.emplace_back("its XML file gives no unit of length: millimetres were taken");
    }
    const std::string moment = bdv_moment(timepoint, id);
    if (!file.has(moment)) {
        throw Failure("has no setup " + std::to_string(id) + " at time " + std::to_string(time) +
                      "; choose another");
    }
    const auto factors = rows_of(file, resolutions_of(id));
    for (std::size_t l = 0; l < factors.size(); ++l) {
        ImageArray level = file.array(moment + "/" + std::to_string(l) + "/cells");
        level.stored = bdv_type(file, id, level.stored);
        level.fill = fill_as(level.stored, level.fill);
        place(level, setup.spacing, {0, 0, 0}, factors[l]);
        image.levels.push_back(level);
    }
    return image;
}

}  // namespace

ChunkedImage hdf5_image(const std::filesystem::path& path, int channel, int time) {
    const Hdf5File file(path);
    if (file.has("/DataSet/ResolutionLevel 0/TimePoint 0/Channel 0/Data")) {
        return imaris_image(file, channel, time);
    }
    if (!setups_of(file).empty()) return bdv_image(file, path, channel, time);
    throw Failure(
        "is an HDF5 file of another program; those of Imaris (5.5 and later) and BigDataViewer are "
        "read: save its volume as one of them, or as OME-Zarr, TIFF or NRRD");
}

void hdf5_places(const std::filesystem::path& path, const ChunkBox& box,
                 std::span<ChunkPlace> places) {
    Hdf5File(path).places(box.array, box.first, box.count, places);
}

}  // namespace palpate::io

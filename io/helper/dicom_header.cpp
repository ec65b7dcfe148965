// Reads headers with GDCM, those of files with several frames through their functional groups.
#include "io/helper/dicom_header.hpp"

#include <gdcmReader.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <sstream>
#include <utility>

#include "io/helper/dicom_check.hpp"
#include "io/helper/dicom_group.hpp"
#include "io/helper/dicom_kinds.hpp"
#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr DicomTag groups_of_frames{0x5200, 0x9230}, value_mapping{0x0040, 0x9096};
constexpr DicomTag position_tag{0x0020, 0x0032}, orientation_tag{0x0020, 0x0037},
    pixel_tag{0x0028, 0x0030}, thickness_tag{0x0018, 0x0050}, between_tag{0x0018, 0x0088},
    intercept_tag{0x0028, 0x1052}, slope_tag{0x0028, 0x1053}, dose_tag{0x3004, 0x000e};

/// The number of a tag that has one, or one again and again; nothing if it is not there.
std::vector<double> one_number(const DicomGroup& group, DicomTag tag, const std::string& name) {
    const auto numbers = group.numbers(tag);
    if (std::ranges::adjacent_find(numbers, std::ranges::not_equal_to()) == numbers.end()) {
        return numbers;
    }
    throw Failure("its DICOM tag " + name + " has " + std::to_string(numbers.size()) +
                  " numbers instead of 1; correct it");
}

void set_place(DicomSlice& s, const std::vector<double>& p, const std::vector<double>& axes) {
    if (p.size() == 3) {
        for (const double c : p) check_coordinate(c, "DICOM tag ImagePositionPatient");
        s.position = Vec3(p[0], p[1], p[2]);
    }
    if (axes.size() != 6) return;
    s.row = Vec3(axes[0], axes[1], axes[2]);
    s.column = Vec3(axes[3], axes[4], axes[5]);
    for (const auto& direction : {s.row, s.column}) {
        if (direction->norm() > 0.5 && direction->norm() < 2) continue;
        throw Failure("its DICOM tag ImageOrientationPatient has no unit vectors; correct it");
    }
}

void set_place(DicomSlice& s, const DicomGroup& group) {
    set_place(s, group.numbers(position_tag), group.numbers(orientation_tag));
}

/// Ultrasound has the size of pixels with each region of the image (PS3.3 C.8.5.5), in cm.
void set_pixel_of_region(DicomSlice& s, const DicomGroup& data) {
    constexpr std::uint32_t centimetres = 3;
    std::optional<Vec3> pixel;
    for (const DicomGroup& region : data.items({0x0018, 0x6011})) {
        const auto along_x = region.counts({0x0018, 0x6024}),
                   along_y = region.counts({0x0018, 0x6026});
        if (along_x != std::vector{centimetres} || along_y != along_x) continue;  // no lengths
        const Vec3 size(10 * std::abs(region.real({0x0018, 0x602c})),
                        10 * std::abs(region.real({0x0018, 0x602e})), 0);
        if (!(size.head<2>().minCoeff() >= least_length && size.maxCoeff() <= greatest_length)) {
            continue;
        }
        if (pixel && *pixel != size) {
            add_note(s.notes, "its regions have pixels of different sizes, which were not used");
            return;
        }
        pixel = size;
    }
    if (!pixel) return;
    s.pixel = pixel;
    add_note(s.notes, "its pixel spacing is that of its ultrasound regions");
}

void set_pixel(DicomSlice& s, const DicomGroup& measures) {
    static constexpr std::array<std::pair<DicomTag, const char*>, 3> tags = {
        {{pixel_tag, ""},
         {{0x0018, 0x1164}, "at the detector (ImagerPixelSpacing)"},
         {{0x0018, 0x2010}, "of a scanned image (NominalScannedPixelSpacing)"}}};
    for (const auto& [tag, where] : tags) {
        auto pixel = measures.numbers(tag);
        if (pixel.empty()) continue;
        if (pixel.size() == 1 && tag == pixel_tag) {
            pixel.push_back(pixel[0]);
            add_note(s.notes,
                     "its PixelSpacing has one number, which was taken for rows and columns");
        }
        if (pixel.size() != 2) {
            if (tag != pixel_tag) continue;
            throw Failure("its DICOM tag PixelSpacing has " + std::to_string(pixel.size()) +
                          " numbers instead of 2; correct it");
        }
        check_spacing(pixel[0], "DICOM tag PixelSpacing");
        check_spacing(pixel[1], "DICOM tag PixelSpacing");
        s.pixel = Vec3(pixel[1], pixel[0], 0);  // DICOM gives the distance between rows first
        if (tag != pixel_tag) add_note(s.notes, std::string("its pixel spacing is that ") + where);
        break;
    }
    if (!s.pixel && !measures.has(groups_of_frames)) set_pixel_of_region(s, measures);
    if (const auto shape = measures.numbers({0x0028, 0x0034}); shape.size() == 2) {
        s.aspect = shape[0] / shape[1];
        check_spacing(s.aspect, "DICOM tag PixelAspectRatio");
    }
    const double between = measures.number(between_tag, 0);
    if (between > 0) s.between = s.thickness = between;
    if (!(s.thickness > 0)) s.thickness = measures.number(thickness_tag, 0);
}

/// Puts `with` in place of a number that makes no sense.
void check_number(DicomSlice& s, double& number, bool is_good, const char* name, double with) {
    if (is_good) return;
    add_note(s.notes, "its " + std::string(name) + " is " + text_of(number) +
                          ", which makes no sense: " + text_of(with) + " was taken");
    number = with;
}

void set_rescale(DicomSlice& s, const DicomGroup& transformation) {
    const auto slope = one_number(transformation, slope_tag, "RescaleSlope"),
               intercept = one_number(transformation, intercept_tag, "RescaleIntercept");
    s.has_rescale = s.has_rescale || !(slope.empty() || intercept.empty());
    if (!slope.empty()) s.slope = slope[0];
    if (!intercept.empty()) s.intercept = intercept[0];
    check_number(s, s.slope, s.slope != 0 && std::isfinite(s.slope), "RescaleSlope", 1);
    check_number(s, s.intercept, std::isfinite(s.intercept), "RescaleIntercept", 0);
    const std::string units = transformation.text({0x0028, 0x1054});
    if (!units.empty() && units != "US") s.values.units = units;  // "US": unspecified
}

/// In the place of slope and intercept: of a dose, and of segmentations that have fractions of a
/// greatest value (PS3.3 C.8.20.2.3).
void set_scaling(DicomSlice& s, const DicomGroup& data) {
    const auto most = data.counts({0x0062, 0x000e});
    if (data.text({0x0062, 0x0001}) == "FRACTIONAL" && most.size() == 1 && most[0] > 0) {
        s.slope = 1.0 / most[0];
    }
    if (!data.has(dose_tag)) return;
    if (s.slope != 1 || s.intercept != 0) {
        add_note(s.notes, "its slope and intercept are not those of a dose: they were ignored");
    }
    const auto told = one_number(data, dose_tag, "DoseGridScaling");
    s.slope = told.empty() ? std::nan("") : told[0];
    s.intercept = 0;
    check_number(s, s.slope, s.slope > 0 && std::isfinite(s.slope), "DoseGridScaling", 1);
    s.has_rescale = true;
    s.values.units = data.text({0x3004, 0x0002});  // GY
}

void set_window(DicomSlice& s, const DicomGroup& group) {
    const double centre = group.number({0x0028, 0x1050}, 0);
    const double width = group.number({0x0028, 0x1051}, 0);
    if (width > 0) s.values.window = ValueWindow{centre, width};
}

/// The table that stands in place of slope and intercept (PS3.3 C.11.1).
void set_table(DicomSlice& s, const DicomGroup& data) {
    const auto items = data.items({0x0028, 0x3000});
    if (items.empty()) return;
    const auto told = items.front().counts({0x0028, 0x3002});
    const auto values = items.front().counts({0x0028, 0x3006});
    const std::size_t count = told.size() == 3 && told[0] == 0 ? 65536 : told.empty() ? 0 : told[0];
    if (told.size() != 3 || count == 0 || values.size() < count) {
        throw Failure("its Modality LUT is damaged or has entries of 8 bits; export it again");
    }
    ValueTable table;
    const bool is_signed = data.counts({0x0028, 0x0103}) == std::vector<std::uint32_t>{1};
    table.first =
        is_signed ? static_cast<std::int16_t>(told[1]) : static_cast<std::int32_t>(told[1]);
    table.values.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
    s.table = std::make_shared<const ValueTable>(std::move(table));
    s.has_rescale = true;
    const std::string units = items.front().text({0x0028, 0x3004});
    s.values.units = units == "US" ? "" : units;
    s.notes.emplace_back("the table of values in its header (Modality LUT) was applied");
}

/// PixelPaddingValue, in units.
void set_padding(DicomSlice& s, const DicomGroup& data) {
    const auto stored = data.counts({0x0028, 0x0120});
    if (stored.size() != 1 || data.has({0x0028, 0x3000})) return;
    const bool is_signed = data.counts({0x0028, 0x0103}) == std::vector<std::uint32_t>{1};
    const double value = is_signed ? static_cast<std::int16_t>(stored[0]) : double(stored[0]);
    s.values.padding = s.slope * value + s.intercept;
}

void note_value_mapping(DicomSlice& s) {
    add_note(s.notes,
             "its Real World Value Mapping was not applied: values are by RescaleSlope and "
             "RescaleIntercept");
}

DicomSlice enhanced_frame(const DicomSlice& file, int number, const FunctionalGroups& groups,
                          const Segments& segments) {
    DicomSlice s = file;
    s.frame = s.order = number;
    s.keys[frame_number] = number;
    groups.with({0x0028, 0x9110}, [&](const DicomGroup& g) { set_pixel(s, g); });
    groups.with({0x0020, 0x9113}, [&](const DicomGroup& g) { set_place(s, g); });
    groups.with({0x0020, 0x9116}, [&](const DicomGroup& g) { set_place(s, g); });
    groups.with({0x0028, 0x9145}, [&](const DicomGroup& g) { set_rescale(s, g); });
    groups.with({0x0028, 0x9132}, [&](const DicomGroup& g) { set_window(s, g); });
    groups.with(value_mapping, [&](const DicomGroup&) { note_value_mapping(s); });
    groups.with({0x0020, 0x930e}, [&](const DicomGroup& g) {
        set_place(s, g.binary<double>({0x0020, 0x9301}), {});
        s.in_patient = false;
    });
    groups.with({0x0020, 0x930f}, [&](const DicomGroup& g) {
        set_place(s, {}, g.binary<double>({0x0020, 0x9302}));
    });
    set_kind(s, groups, segments);
    set_moment(s, groups);
    return s;
}

/// Classes whose frames are moments of one picture if they have no place: ultrasound and X-rays
/// from one side.
bool is_film(const DicomGroup& data) {
    const std::string kind = data.text({0x0008, 0x0016}), images = "1.2.840.10008.5.1.4.1.1.";
    return kind == images + "3" || kind == images + "3.1" || kind.starts_with(images + "12.");
}

void set_film(std::vector<DicomSlice>& slices, const DicomGroup& data) {
    const double rate = data.number({0x0018, 0x0040}, data.number({0x0008, 0x2144}, 0));
    for (DicomSlice& s : slices) {
        s.is_moment = true;
        s.seconds = data.number({0x0018, 0x1063}, rate > 0 ? 1000 / rate : 0) / 1000;
        add_note(s.notes, "its " + std::to_string(s.frames) +
                              " frames are moments of one slice, not slices");
    }
}

std::vector<DicomSlice> enhanced_frames(const DicomSlice& file, const DicomGroup& data) {
    const auto frames = data.items(groups_of_frames);
    if (frames.size() != static_cast<std::size_t>(file.frames)) {
        throw Failure(quoted(file.file) + " has " + std::to_string(file.frames) +
                      " frames, and describes " + std::to_string(frames.size()) +
                      "; copy or export it again");
    }
    const auto shared = data.items({0x5200, 0x9229});
    const Segments segments = segments_in(data);
    std::vector<DicomSlice> slices;
    std::set<std::pair<double, double>> directions;  // [degrees] of X-rays
    for (int i = 0; i < file.frames; ++i) {
        const FunctionalGroups groups(frames[static_cast<std::size_t>(i)],
                                      shared.empty() ? nullptr : &shared.front());
        slices.push_back(enhanced_frame(file, i, groups, segments));
        groups.with({0x0018, 0x9405}, [&](const DicomGroup& g) {
            directions.emplace(g.number({0x0018, 0x1510}, 0), g.number({0x0018, 0x1511}, 0));
        });
    }
    if (directions.size() > 1) {
        throw Failure(quoted(file.file) +
                      " has projections from several directions; export a reconstructed volume");
    }
    const auto has_place = [](const DicomSlice& s) { return s.position.has_value(); };
    if (is_film(data) && std::ranges::none_of(slices, has_place)) set_film(slices, data);
    return slices;
}

/// The quantity by which FrameIncrementPointer counts the frames.
enum class Counted { by_nothing, by_time, by_slice, by_offset, by_location, otherwise };

constexpr DicomTag grid_offsets{0x3004, 0x000c}, locations{0x0018, 0x2005}, pages{0x0018, 0x2001};

Counted counted(const DicomGroup& data) {
    const auto pointers = data.tags({0x0028, 0x0009});
    if (pointers.empty()) {
        const bool has_time = data.has({0x0018, 0x1063}) || data.has({0x0018, 0x1065});
        return has_time                 ? Counted::by_time
               : data.has(grid_offsets) ? Counted::by_offset
                                        : Counted::by_nothing;
    }
    if (pointers.size() > 1) return Counted::otherwise;
    if (pointers[0] == DicomTag{0x0018, 0x1063} || pointers[0] == DicomTag{0x0018, 0x1065}) {
        return Counted::by_time;
    }
    if (pointers[0] == DicomTag{0x0054, 0x0080}) return Counted::by_slice;
    if (pointers[0] == grid_offsets) return Counted::by_offset;
    if (pointers[0] == locations) return Counted::by_location;
    if (pointers[0] == pages) return Counted::by_nothing;
    return Counted::otherwise;
}

/// The place of each frame among the slices, from 0, according to SliceVector.
std::vector<int> order_of(const DicomSlice& file, const DicomGroup& data) {
    const auto told = data.counts({0x0054, 0x0080});
    std::vector<int> order;
    for (int i = 0; i < file.frames; ++i) {
        const auto at = static_cast<std::size_t>(i);
        order.push_back(told.empty() ? i : at < told.size() ? static_cast<int>(told[at]) - 1 : -1);
    }
    std::vector<int> sorted = order;
    std::ranges::sort(sorted);
    for (int i = 0; i < file.frames; ++i) {
        if (sorted[static_cast<std::size_t>(i)] == i) continue;
        throw Failure(quoted(file.file) + " has a SliceVector that does not name each of its " +
                      std::to_string(file.frames) + " slices once; export it again");
    }
    return order;
}

/// One behind the other from the first one's position, by the distances given [mm].
void place_behind(std::vector<DicomSlice>& slices, const std::vector<double>& distances) {
    const DicomSlice first = slices.front();
    if (!first.position || !first.row || !first.column) return;
    const Vec3 normal = first.row->cross(*first.column).normalized();
    for (std::size_t i = 0; i < slices.size(); ++i) {
        slices[i].position = *first.position + normal * (distances[i] - distances[0]);
    }
}

/// Offsets of a dose grid count along the normal, or are z of the patient (PS3.3 C.8.8.3.2): then
/// the first one is that of the position.
std::vector<double> along_normal(std::vector<double> offsets, const DicomSlice& first) {
    constexpr double rounding = 0.01;  // [mm]
    if (!first.position || !first.row || !first.column || offsets[0] == 0) return offsets;
    const bool is_z = std::abs(offsets[0] - first.position->z()) <= rounding;
    const double z = first.row->cross(*first.column).normalized().z();
    if (is_z && z < -0.99) {
        for (double& offset : offsets) offset = -offset;
    }
    return offsets;
}

std::vector<double> even_distances(const std::vector<int>& order, double step) {
    std::vector<double> distances;
    for (const int place : order) distances.push_back(place * step);
    return distances;
}

/// Frames without functional groups.
std::vector<DicomSlice> plain_frames(DicomSlice file, const DicomGroup& data) {
    // Nuclear medicine keeps the place of its slices with the detector.
    const auto detectors = data.items({0x0054, 0x0022});
    if (!detectors.empty() && !file.position) {
        set_place(file, detectors.front());
    }
    std::vector<DicomSlice> slices(static_cast<std::size_t>(file.frames), file);
    for (std::size_t i = 0; i < slices.size(); ++i) {
        slices[i].frame = slices[i].order = static_cast<int>(i);
        slices[i].keys[frame_number] = static_cast<double>(i);
    }
    const auto note = [&](const std::string& text) {
        for (DicomSlice& s : slices) s.notes.push_back(text);
    };
    const std::string all = "its " + std::to_string(file.frames) + " frames ";
    const Counted by = counted(data);
    if (by == Counted::otherwise) {
        throw Failure(quoted(file.file) +
                      " counts its frames by more than their place or time (projections, phases); "
                      "export a reconstructed volume");
    }
    const bool has_place = file.position || data.has(between_tag);
    if (by == Counted::by_time || (by == Counted::by_nothing && !has_place && is_film(data))) {
        set_film(slices, data);
        return slices;
    }
    if (by == Counted::by_offset || by == Counted::by_location) {
        const bool is_grid = by == Counted::by_offset;
        const auto offsets = data.numbers(is_grid ? grid_offsets : locations);
        for (const double offset : offsets) {
            check_coordinate(offset, is_grid ? "GridFrameOffsetVector" : "SliceLocationVector");
        }
        if (offsets.size() == slices.size()) {
            place_behind(slices, is_grid ? along_normal(offsets, file) : offsets);
            return slices;
        }
    }
    const std::vector<int> order = order_of(file, data);
    for (std::size_t i = 0; i < slices.size(); ++i) slices[i].order = order[i];
    const double between = data.number(between_tag, 0);  // negative: against the normal
    check_coordinate(between, "DICOM tag SpacingBetweenSlices");
    if (between != 0) {
        place_behind(slices, even_distances(order, between));
        return slices;
    }
    const double step = file.thickness > 0 ? file.thickness : 1;
    place_behind(slices, even_distances(order, step));
    note(all + "do not say where they lie: taken as slices " + text_of(step) + " mm apart");
    return slices;
}

/// Overlays without data of their own lie in bits that the samples do not use.
void note_overlays(DicomSlice& s, const DicomGroup& data) {
    for (std::uint16_t group = 0x6000; group < 0x6020; group += 2) {
        if (!data.has({group, 0x0010}) || data.has({group, 0x3000})) continue;
        add_note(s.notes, overlays_note);
    }
}

DicomSlice file_as_slice(const fs::path& file, const DicomExtent& extent, const DicomGroup& data) {
    DicomSlice s;
    s.file = file;
    s.compression = extent.compression;
    s.notes = extent.notes;
    if (extent.shift() > 0) {
        add_note(s.notes, "its samples lie " + std::to_string(extent.shift()) +
                              " bits above the lowest (HighBit): they were shifted down");
    }
    s.rows = static_cast<int>(extent.rows);
    s.columns = static_cast<int>(extent.columns);
    s.frames = static_cast<int>(extent.frames);
    s.instance_uid = data.text({0x0008, 0x0018});
    s.series_uid = data.text({0x0020, 0x000e});
    s.description = data.text({0x0008, 0x103e});
    set_kind(s, data);
    set_moment(s, data);
    s.patient = data.text({0x0010, 0x0010});
    s.study = data.text({0x0008, 0x1030});
    s.values.modality = data.text({0x0008, 0x0060});
    set_place(s, data);
    set_pixel(s, data);
    if (s.values.modality == "CT") s.values.units = "HU";
    set_rescale(s, data);
    if (s.values.units.empty()) s.values.units = data.text({0x0054, 0x1001});  // of PET
    set_scaling(s, data);
    set_window(s, data);
    set_padding(s, data);
    set_table(s, data);
    if (data.has(value_mapping)) note_value_mapping(s);
    const std::string colours = data.text({0x0028, 0x0004});
    if (colours == "MONOCHROME1") {
        add_note(s.notes,
                 "its MONOCHROME1 shows greater values darker: values were taken as stored");
    }
    note_overlays(s, data);
    // Segmentations of labels may bring colours for them.
    const bool are_labels = s.values.modality == "SEG" && colours == "PALETTE COLOR";
    s.has_colours = !colours.empty() && lower(colours).find("monochrome") != 0 && !are_labels;
    constexpr DicomTag location_tag{0x0020, 0x1041};
    if (!s.position || !s.row || !s.column) {
        for (const double at : data.numbers(location_tag)) {
            check_coordinate(at, "DICOM tag SliceLocation");
        }
    }
    const double location = data.optional_number(location_tag);
    if (std::isfinite(location)) s.location = location;
    return s;
}

std::vector<DicomSlice> slices_of(const fs::path& file) {
    const DicomExtent extent = check_dicom(file);
    // Reports, plans and the folder's index have no rows; an image that has none is cut off.
    if (extent.rows < 1 && has_no_image(extent.sop_class)) return {};
    if (extent.sop_class == "1.2.840.10008.5.1.4.1.1.4.2") return {};  // spectra in rows
    if (extent.rows < 1 || extent.columns < 1) {
        throw Failure(quoted(file) +
                      " gives no size of its image; it is cut off or damaged: copy "
                      "or export it again");
    }
    if (!extent.has_image) {
        throw Failure(quoted(file) +
                      " has no samples (pixel data), but says how large its image is; copy or "
                      "export it again, or remove it from the folder");
    }
    const MemoryBound bound(8 * extent.header.size());
    std::istringstream header(extent.header);
    gdcm::Reader reader;
    reader.SetStream(header);
    if (!reader.ReadUpToTag(gdcm::Tag(0x7fe0, 0x0008), {})) {
        throw Failure(quoted(file) +
                      " is no DICOM file or is damaged in its header; copy it again");
    }
    const DicomGroup data(reader.GetFile().GetDataSet());
    const DicomSlice slice = file_as_slice(file, extent, data);
    // Siemens packs a whole volume into one flat image, side by side.
    if (data.text({0x0008, 0x0008}).find("MOSAIC") != std::string::npos) {
        throw Failure(quoted(file) +
                      " is a mosaic of slices; convert it to NIfTI (dcm2niix) and give that file");
    }
    const auto wide = data.counts({0x0048, 0x0006}), high = data.counts({0x0048, 0x0007});
    if ((!wide.empty() && wide[0] > extent.columns) || (!high.empty() && high[0] > extent.rows)) {
        throw Failure(quoted(file) +
                      " has the tiles of a microscope's slide, which are no slices of a volume; "
                      "convert it to OME-TIFF");
    }
    if (data.has(groups_of_frames)) return enhanced_frames(slice, data);
    return slice.frames == 1 ? std::vector{slice} : plain_frames(slice, data);
}

}  // namespace

std::vector<DicomSlice> slices_from(const fs::path& file) {
    try {
        return slices_of(file);
    } catch (const Failure& e) {
        const std::string what = e.what();
        if (what.find(quoted(file)) != std::string::npos) throw;
        throw Failure(quoted(file) + ": " + what);
    }
}

}  // namespace palpate::io

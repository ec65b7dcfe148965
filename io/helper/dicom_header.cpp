// Reads headers with GDCM. See the header.
#include "io/helper/dicom_header.hpp"

#include <gdcmReader.h>

#include <cmath>
#include <sstream>

#include "io/helper/dicom_attributes.hpp"
#include "io/helper/dicom_check.hpp"
#include "io/helper/dicom_frames.hpp"
#include "io/helper/dicom_group.hpp"
#include "io/helper/headers.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;
/// Overlays without data of their own lie in bits that the samples do not use.
void note_overlays(DicomSlice& s, const DicomGroup& data) {
    for (std::uint16_t group = 0x6000; group < 0x6020; group += 2) {
        if (!data.has({group, 0x0010}) || data.has({group, 0x3000})) continue;
        add_note(s.notes, overlays_note);
    }
}

/// The numbers that its samples may have.
void set_stored(DicomSlice& s, const DicomExtent& extent) {
    const bool is_given = extent.stored_bits > 0 && extent.stored_bits <= extent.bits;
    const auto bits = static_cast<int>(is_given ? extent.stored_bits : extent.bits);
    const bool is_signed = extent.representation == 1;
    s.bits = static_cast<int>(extent.bits);
    s.is_real = extent.is_real;
    s.least = is_signed ? -std::ldexp(1.0, bits - 1) : 0;
    s.most = std::ldexp(1.0, is_signed ? bits - 1 : bits) - 1;
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
    const std::string set = data.text({0x0008, 0x0005});
    s.description = data.words({0x0008, 0x103e}, set);
    set_stored(s, extent);
    set_kind(s, data);
    set_moment(s, data);
    s.patient = data.words({0x0010, 0x0010}, set);
    s.study = data.words({0x0008, 0x1030}, set);
    s.patient_id = data.words({0x0010, 0x0020}, set);
    s.study_uid = data.text({0x0020, 0x000d});
    s.frame_of_reference = data.text({0x0020, 0x0052});
    set_place(s, data);
    set_pixel(s, data);
    set_values(s, data);
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

/// Siemens and United Imaging pack a whole volume into one flat image, side by side. An enhanced
/// file of Siemens keeps the mark of a mosaic, although each slice is a frame of its own.
bool is_mosaic(const DicomGroup& data, int frames) {
    if (frames > 1) return false;
    const std::string type = data.text({0x0008, 0x0008});
    if (type.find("MOSAIC") != type.npos || type.find("VFRAME") != type.npos) return true;
    if (data.text({0x0019, 0x0010}) == "SIEMENS MR HEADER") {
        const auto slices = data.counts({0x0019, 0x100a});
        if (!slices.empty() && slices[0] > 1) return true;
    }
    return data.text({0x0065, 0x0010}) == "Image Private Header" &&
           number_from<double>(data.text({0x0065, 0x1050})).value_or(0) > 1;
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
    // Of short elements, GDCM's tree takes many times their bytes. Each frame becomes a slice.
    constexpr std::uint64_t in_tree = 64, in_slice = 8192;
    const MemoryBound bound(in_tree * extent.header.size() +
                            in_slice * static_cast<std::uint64_t>(extent.frames));
    std::istringstream header(extent.header);
    gdcm::Reader reader;
    reader.SetStream(header);
    if (!reader.ReadUpToTag(gdcm::Tag(0x7fe0, 0x0008), {})) {
        throw Failure(quoted(file) +
                      " is no DICOM file or is damaged in its header; copy it again");
    }
    const DicomGroup data(reader.GetFile().GetDataSet());
    const DicomSlice slice = file_as_slice(file, extent, data);
    if (is_mosaic(data, slice.frames)) {
        throw Failure(quoted(file) +
                      " is a mosaic of slices; convert it to NIfTI (dcm2niix) and give that file");
    }
    const auto wide = data.counts({0x0048, 0x0006}), high = data.counts({0x0048, 0x0007});
    if ((!wide.empty() && wide[0] > extent.columns) || (!high.empty() && high[0] > extent.rows)) {
        throw Failure(quoted(file) +
                      " has the tiles of a microscope's slide, which are no slices of a volume; "
                      "convert it to OME-TIFF");
    }
    std::vector<DicomSlice> slices = frames_in(slice, data);
    for (DicomSlice& s : slices) finish_values(s, data);
    return slices;
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

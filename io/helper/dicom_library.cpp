// Reads headers with GDCM, and samples through ITK, which applies slope and intercept; see the
// header.
#include <fcntl.h>
#include <gdcmReader.h>
#include <gdcmStringFilter.h>
#include <itkGDCMImageIO.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>
#include <optional>

#include "io/helper/dicom_check.hpp"
#include "io/helper/dicom_library.hpp"
#include "io/helper/headers.hpp"
#include "io/helper/library_words.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// The strings of one header.
class Tags {
  public:
    Tags(const fs::path& file, const std::string& readable) {
        reader_.SetFileName(readable.c_str());
        if (!reader_.ReadUpToTag(gdcm::Tag(0x7fe0, 0x0010), {})) {
            throw Failure(quoted(file) +
                          " is no DICOM file or is damaged in its header; copy it again");
        }
        strings_.SetFile(reader_.GetFile());
    }
    std::string text(std::uint16_t group, std::uint16_t element) {
        std::string value = strings_.ToString(gdcm::Tag(group, element));
        value.resize(strnlen(value.c_str(), value.size()));  // values are padded with 0
        return trimmed(value);
    }
    std::vector<double> numbers(std::uint16_t group, std::uint16_t element) {
        std::string value = text(group, element);
        std::replace(value.begin(), value.end(), '\\', ' ');
        return numbers_in(value, "DICOM tag");
    }
    double number(std::uint16_t group, std::uint16_t element, double otherwise) {
        const auto all = numbers(group, element);
        return all.empty() || !(std::abs(all[0]) < 1e9) ? otherwise : all[0];
    }

  private:
    gdcm::Reader reader_;
    gdcm::StringFilter strings_;
};

/// What GDCM is given: the file itself, or a deflated one unpacked in memory.
class LibraryFile {
  public:
    LibraryFile(const fs::path& file, bool deflated) : path_(file) {
        if (!deflated) return;
        const auto bytes = inflated_dicom(file);
        memory_ = memfd_create("palpate-dicom", MFD_CLOEXEC);
        for (std::size_t at = 0; at < bytes.size();) {
            const ssize_t written = write(memory_, bytes.data() + at, bytes.size() - at);
            if (written <= 0) throw std::bad_alloc();
            at += static_cast<std::size_t>(written);
        }
        path_ = "/proc/self/fd/" + std::to_string(memory_);
    }
    ~LibraryFile() {
        if (memory_ >= 0) close(memory_);
    }
    LibraryFile(const LibraryFile&) = delete;
    LibraryFile& operator=(const LibraryFile&) = delete;
    std::string name() const { return path_.string(); }

  private:
    fs::path path_;
    int memory_ = -1;
};

/// What a decoder prints while this lives: some go on after damage and only warn.
class DecoderWords {
  public:
    DecoderWords() : memory_(memfd_create("palpate-words", MFD_CLOEXEC)) {
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
            before_[stream - 1] = fcntl(stream, F_DUPFD_CLOEXEC, 16);
            dup2(memory_, stream);
        }
    }
    ~DecoderWords() {
        put_back();
        close(memory_);
    }
    DecoderWords(const DecoderWords&) = delete;
    DecoderWords& operator=(const DecoderWords&) = delete;

    std::string said() {
        put_back();
        char text[512];
        const ssize_t size = pread(memory_, text, sizeof text, 0);
        return library_words({text, static_cast<std::size_t>(std::max<ssize_t>(size, 0))}, 120);
    }

  private:
    void put_back() {
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
            if (before_[stream - 1] < 0) continue;
            std::fflush(stream == STDOUT_FILENO ? stdout : stderr);
            dup2(before_[stream - 1], stream);
            close(before_[stream - 1]);
            before_[stream - 1] = -1;
        }
    }
    int memory_;
    int before_[2];
};

Stored stored_from(itk::IOComponentEnum type) {
    switch (type) {
        case itk::IOComponentEnum::UCHAR:
            return Stored::uint8;
        case itk::IOComponentEnum::CHAR:
            return Stored::int8;
        case itk::IOComponentEnum::USHORT:
            return Stored::uint16;
        case itk::IOComponentEnum::SHORT:
            return Stored::int16;
        case itk::IOComponentEnum::UINT:
            return Stored::uint32;
        case itk::IOComponentEnum::INT:
            return Stored::int32;
        case itk::IOComponentEnum::FLOAT:
            return Stored::float32;
        case itk::IOComponentEnum::DOUBLE:
            return Stored::float64;
        default:
            throw Failure("its sample type is not read; export it again");
    }
}

}  // namespace

DicomSlice slice_from(const fs::path& file) {
    const DicomExtent extent = check_dicom(file);
    const LibraryFile readable(file, extent.deflated);
    const MemoryBound bound(8 * fs::file_size(file) + 2 * extent.bytes());
    Tags tags(file, readable.name());
    DicomSlice s;
    s.file = file;
    s.deflated = extent.deflated;
    s.compression = extent.compression;
    s.notes = extent.notes;
    s.instance_uid = tags.text(0x0008, 0x0018);
    s.series_uid = tags.text(0x0020, 0x000e);
    s.description = tags.text(0x0008, 0x103e);
    s.modality = tags.text(0x0008, 0x0060);
    s.rows = static_cast<int>(extent.rows);
    s.columns = static_cast<int>(extent.columns);
    s.frames = static_cast<int>(extent.frames);
    s.instance = static_cast<int>(tags.number(0x0020, 0x0013, 0));
    s.acquisition = static_cast<int>(tags.number(0x0020, 0x0012, 0));
    const auto position = tags.numbers(0x0020, 0x0032);
    if (position.size() == 3) s.position = Vec3(position[0], position[1], position[2]);
    const auto axes = tags.numbers(0x0020, 0x0037);
    for (const double coordinate : position) {
        check_coordinate(coordinate, "DICOM tag ImagePositionPatient");
    }
    if (axes.size() == 6) {
        s.row = Vec3(axes[0], axes[1], axes[2]);
        s.column = Vec3(axes[3], axes[4], axes[5]);
        for (const auto& direction : {s.row, s.column}) {
            if (direction->norm() > 0.5 && direction->norm() < 2) continue;
            throw Failure("its DICOM tag ImageOrientationPatient has no unit vectors; correct it");
        }
    }
    auto pixel = tags.numbers(0x0028, 0x0030);
    if (pixel.size() != 2) pixel = tags.numbers(0x0018, 0x1164);
    if (pixel.size() == 2) {
        check_spacing(pixel[0], "DICOM tag PixelSpacing");
        check_spacing(pixel[1], "DICOM tag PixelSpacing");
        s.pixel = Vec3(pixel[1], pixel[0], 0);  // DICOM gives the distance between rows first
    }
    s.thickness = tags.number(0x0018, 0x0088, 0);
    if (!(s.thickness > 0)) s.thickness = tags.number(0x0018, 0x0050, 0);
    if (s.rows < 1 || s.columns < 1) {
        // Reports, plans and the folder's index have no rows; an image that has none is cut off.
        if (has_no_image(extent.sop_class)) return s;
        throw Failure(quoted(file) +
                      " gives no size of its image; it is cut off or damaged: copy "
                      "or export it again");
    }
    // Siemens packs a whole volume into one flat image, side by side.
    if (tags.text(0x0008, 0x0008).find("MOSAIC") != std::string::npos) {
        throw Failure(quoted(file) +
                      " is a mosaic of slices; convert it to NIfTI (dcm2niix) and give that file");
    }
    return s;
}

Decoded decode(const DicomSlice& slice, const Request& request) {
    say_doing(slice.file.filename().string());
    const LibraryFile readable(slice.file, slice.deflated);
    const auto io = itk::GDCMImageIO::New();
    io->SetFileName(readable.name());
    io->ReadImageInformation();
    if (io->GetNumberOfComponents() != 1) {
        throw Failure(quoted(slice.file) + " has colours; give a series with one value a sample");
    }
    Decoded decoded;
    decoded.stored = stored_from(io->GetComponentType());
    Geometry& g = decoded.geometry;
    g.size = Index3::Ones();
    itk::ImageIORegion region(io->GetNumberOfDimensions());
    std::vector<std::int64_t> sizes;
    for (unsigned a = 0; a < io->GetNumberOfDimensions(); ++a) {
        region.SetSize(a, io->GetDimensions(a));
        sizes.push_back(static_cast<std::int64_t>(io->GetDimensions(a)));
        if (a > 2) continue;
        const auto i = static_cast<Eigen::Index>(a);
        g.size[i] = static_cast<int>(io->GetDimensions(a));
        g.spacing[i] = io->GetSpacing(a);
        g.origin[i] = io->GetOrigin(a);
        const auto axis = io->GetDirection(a);
        for (unsigned r = 0; r < std::min<std::size_t>(3, axis.size()); ++r) {
            g.direction(static_cast<Eigen::Index>(r), i) = axis[r];
        }
    }
    const std::int64_t frames = sizes.size() > 2 ? sizes[2] : 1;
    if (g.size[0] != slice.columns || g.size[1] != slice.rows || frames != slice.frames ||
        sizes.size() > 3) {
        throw Failure(quoted(slice.file) + " contradicts itself about its size; copy it again");
    }
    decoded.samples.resize(
        checked_bytes(sizes, size_of(decoded.stored), fs::file_size(slice.file), request));
    io->SetIORegion(region);
    std::optional<DecoderWords> words;
    if (!slice.compression.empty()) words.emplace();
    const MemoryBound bound(4 * fs::file_size(slice.file) + 4 * decoded.samples.size());
    try {
        io->Read(decoded.samples.data());
    } catch (const std::bad_alloc&) {
        throw Failure(
            quoted(slice.file) +
            " needs far more memory to unpack than its samples do; it is damaged: copy or "
            "export it again");
    }
    if (words) decoded.decoder_said = words->said();
    return decoded;
}

}  // namespace palpate::io

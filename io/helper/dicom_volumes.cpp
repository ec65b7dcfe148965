// Reads DICOM with GDCM, and samples through ITK, which applies slope and intercept: headers, then
// the slices of one series, then the grid that dicom_stack.hpp has planned.
#include <gdcmReader.h>
#include <gdcmStringFilter.h>
#include <itkGDCMImageIO.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>

#include "io/helper/dicom_check.hpp"
#include "io/helper/dicom_stack.hpp"
#include "io/helper/headers.hpp"
#include "io/helper/readers.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// The strings of one header.
class Tags {
  public:
    explicit Tags(const fs::path& file) {
        reader_.SetFileName(file.c_str());
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

/// As many bytes as rows, columns and bits ask for?
void check_pixels(const DicomSlice& s, const DicomExtent& extent, Tags& tags) {
    if (!extent.pixel_data) return;  // compressed: the decoder counts
    const double needed = static_cast<double>(s.rows) * s.columns * s.frames *
                          tags.number(0x0028, 0x0002, 1) * tags.number(0x0028, 0x0100, 16) / 8;
    if (static_cast<double>(*extent.pixel_data) >= needed) return;
    throw Failure(quoted(s.file) + " has " + std::to_string(*extent.pixel_data) +
                  " bytes of samples, its header asks for " + text_of(needed) +
                  "; it is damaged: copy or export it again");
}

DicomSlice slice_from(const fs::path& file) {
    const DicomExtent extent = check_dicom(file);
    Tags tags(file);
    DicomSlice s;
    s.file = file;
    s.series_uid = tags.text(0x0020, 0x000e);
    s.description = tags.text(0x0008, 0x103e);
    s.modality = tags.text(0x0008, 0x0060);
    s.rows = static_cast<int>(tags.number(0x0028, 0x0010, 0));
    s.columns = static_cast<int>(tags.number(0x0028, 0x0011, 0));
    s.frames = static_cast<int>(tags.number(0x0028, 0x0008, 1));
    s.instance = static_cast<int>(tags.number(0x0020, 0x0013, 0));
    s.acquisition = static_cast<int>(tags.number(0x0020, 0x0012, 0));
    const auto position = tags.numbers(0x0020, 0x0032);
    if (position.size() == 3) s.position = Vec3(position[0], position[1], position[2]);
    const auto axes = tags.numbers(0x0020, 0x0037);
    if (axes.size() == 6) {
        s.row = Vec3(axes[0], axes[1], axes[2]);
        s.column = Vec3(axes[3], axes[4], axes[5]);
    }
    auto pixel = tags.numbers(0x0028, 0x0030);
    if (pixel.size() != 2) pixel = tags.numbers(0x0018, 0x1164);
    if (pixel.size() == 2) {
        check_spacing(pixel[0], "PixelSpacing");
        check_spacing(pixel[1], "PixelSpacing");
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
    check_pixels(s, extent, tags);
    return s;
}

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

struct Decoded {
    Stored stored = Stored::uint8;
    std::vector<std::byte> samples;
    Geometry geometry;  ///< as ITK sees it; used for a file with several frames only
};

Decoded decode(const DicomSlice& slice, const Request& request) {
    say_doing(slice.file.filename().string());
    const auto io = itk::GDCMImageIO::New();
    io->SetFileName(slice.file.string());
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
    if (g.size[0] != slice.columns || g.size[1] != slice.rows || sizes.size() > 3) {
        throw Failure(quoted(slice.file) + " contradicts itself about its size; copy it again");
    }
    decoded.samples.resize(
        checked_bytes(sizes, size_of(decoded.stored), fs::file_size(slice.file), request));
    io->SetIORegion(region);
    io->Read(decoded.samples.data());
    return decoded;
}

/// The type for all slices together: Hounsfield units and the like come as 32-bit integers.
SampleType common_type(const std::vector<Decoded>& slices, std::vector<std::string>& notes) {
    const Stored first = slices.front().stored;
    bool same = true, floats = false;
    double low = 0, high = 0;
    for (const Decoded& d : slices) {
        same = same && d.stored == first;
        floats = floats || d.stored == Stored::float32 || d.stored == Stored::float64;
        const auto range = range_of(d.stored, d.samples);
        low = std::min(low, range.first);
        high = std::max(high, range.second);
    }
    if (same && kept_as(first) != SampleType::float32) return kept_as(first);
    if (!floats && low >= -32768 && high <= 32767) return SampleType::int16;
    if (!floats && low >= 0 && high <= 65535) return SampleType::uint16;
    notes.push_back(floats ? "its rescale slope is not a whole number: samples became float32"
                           : "its values go from " + text_of(low) + " to " + text_of(high) +
                                 ", beyond 16 bits: samples became float32");
    return SampleType::float32;
}

/// Slices of one type, and a value at any place in one of them.
template <class T>
class Sampler {
  public:
    Sampler(const Stack& stack, const std::vector<std::vector<std::byte>>& slices, int columns,
            int rows, double outside)
        : stack_(stack), slices_(slices), columns_(columns), rows_(rows), outside_(outside) {}

    /// At grid column and row `x`, `y` of slice `s`, its shift undone: bilinear.
    double at(std::size_t s, int x, int y) const {
        if (!stack_.sheared) return pixel(s, x, y);
        const double u = x + stack_.first_u - stack_.slices[s].u;
        const double v = y + stack_.first_v - stack_.slices[s].v;
        const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
        const double a = u - i, b = v - j;
        return (1 - b) * ((1 - a) * pixel(s, i, j) + a * pixel(s, i + 1, j)) +
               b * ((1 - a) * pixel(s, i, j + 1) + a * pixel(s, i + 1, j + 1));
    }

  private:
    double pixel(std::size_t s, int x, int y) const {
        if (x < 0 || y < 0 || x >= columns_ || y >= rows_) return outside_;
        return reinterpret_cast<const T*>(slices_[s].data())[y * columns_ + x];
    }
    const Stack& stack_;
    const std::vector<std::vector<std::byte>>& slices_;
    int columns_, rows_;
    double outside_;
};

template <class T>
void fill(const Stack& stack, const std::vector<std::vector<std::byte>>& slices,
          const DicomSlice& one, double outside, T* to) {
    const Sampler<T> sampler(stack, slices, one.columns, one.rows, outside);
    const auto plane = static_cast<std::size_t>(stack.geometry.size[0]) *
                       static_cast<std::size_t>(stack.geometry.size[1]);
    for (const GridSlice& g : stack.grid) {
        if (g.weight == 0 && !stack.sheared) {
            std::memcpy(to, slices[g.first].data(), plane * sizeof(T));
            to += plane;
            continue;
        }
        for (int y = 0; y < stack.geometry.size[1]; ++y) {
            for (int x = 0; x < stack.geometry.size[0]; ++x) {
                double value = sampler.at(g.first, x, y);
                if (g.weight > 0) value += g.weight * (sampler.at(g.second, x, y) - value);
                *to++ = static_cast<T>(std::is_integral_v<T> ? std::round(value) : value);
            }
        }
    }
}

/// A file with several frames: ITK's geometry, since the frames' own positions lie deep in it.
Result read_frames(const DicomSlice& slice, const Request& request) {
    Result result;
    result.format = "DICOM, several frames in one file";
    std::vector<Decoded> all;
    all.push_back(decode(slice, request));
    checked_time_step(request, 1);
    result.geometry = all[0].geometry;
    result.type = common_type(all, result.notes);
    result.notes.emplace_back("the positions of its frames were not checked for gaps or tilt");
    const auto count = static_cast<std::size_t>(sample_count(result.geometry));
    const auto samples = shared_samples(count * size_of(result.type));
    convert(all[0].stored, all[0].samples.data(), result.type, samples.data(), count);
    finish(result, request, samples);
    return result;
}

Result read_series(const DicomSeries& series, const Request& request) {
    if (series.slices.front().frames > 1) {
        if (series.slices.size() == 1) return read_frames(series.slices.front(), request);
        throw Failure("it has several files with several frames each; give one of these files");
    }
    Stack stack = stack_slices(series, request);
    std::vector<Decoded> decoded;
    for (const PlacedSlice& p : stack.slices) {
        decoded.push_back(decode(series.slices[p.slice], request));
        say_progress(0.1 + 0.8 * static_cast<double>(decoded.size()) /
                               static_cast<double>(stack.slices.size()));
    }
    Result result;
    result.format = stack.slices.size() > 1 ? "DICOM series" : "DICOM, one slice";
    result.geometry = stack.geometry;
    result.time_steps = stack.time_steps;
    result.notes = stack.notes;
    result.type = common_type(decoded, result.notes);
    const DicomSlice& one = series.slices.front();
    const auto pixels = static_cast<std::size_t>(one.columns) * static_cast<std::size_t>(one.rows);
    double outside = range_of(decoded[0].stored, decoded[0].samples).first;
    std::vector<std::vector<std::byte>> slices;
    for (Decoded& d : decoded) {
        outside = std::min(outside, range_of(d.stored, d.samples).first);
        slices.emplace_back(pixels * size_of(result.type));
        convert(d.stored, d.samples.data(), result.type, slices.back().data(), pixels);
        d.samples = {};
    }
    const std::int64_t sizes[] = {stack.geometry.size[0], stack.geometry.size[1],
                                  stack.geometry.size[2]};
    const auto samples =
        shared_samples(checked_bytes(sizes, size_of(result.type), UINT64_MAX, request));
    void* const to = samples.data();
    with_type(result.type, [&](auto zero) {
        fill(stack, slices, one, outside, static_cast<decltype(zero)*>(to));
    });
    finish(result, request, samples);
    return result;
}

}  // namespace

bool looks_like_dicom(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    char start[132] = {};
    in.read(start, sizeof start);
    return in.gcount() == sizeof start && std::memcmp(start + 128, "DICM", 4) == 0;
}

Result read_dicom_file(const Request& request) {
    say_doing(request.path.filename().string());
    DicomSlice slice = slice_from(request.path);
    if (slice.rows < 1 || slice.columns < 1) {
        throw Failure("is a DICOM file without an image; give the folder with the slices");
    }
    return read_series({slice.series_uid, slice.description, slice.modality, {slice}}, request);
}

Result read_dicom_folder(const Request& request) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(request.path)) {
        if (entry.is_regular_file() && looks_like_dicom(entry.path())) {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    std::vector<DicomSlice> slices;
    for (const fs::path& file : files) {
        say_doing(file.filename().string());
        DicomSlice slice = slice_from(file);
        if (slice.rows > 0 && slice.columns > 0) slices.push_back(std::move(slice));
    }
    if (slices.empty())
        throw Failure("has DICOM files, but none with an image; give another folder");
    const auto all = series_of(std::move(slices));
    return read_series(choose_series(all, request.series), request);
}

}  // namespace palpate::io

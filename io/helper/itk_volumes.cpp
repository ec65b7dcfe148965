// Reads NIfTI, and writes NRRD, MetaImage and NIfTI, with ITK's ImageIO classes, straight from and
// into the shared samples: no itk::Image, no pixel conversion, no factories. A NIfTI file has
// passed check_nifti() before.
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <Eigen/LU>
#include <cmath>

#include "io/helper/headers.hpp"
#include "io/helper/readers.hpp"

namespace palpate::io {
namespace {

Stored stored_from(itk::IOComponentEnum type) {
    using itk::IOComponentEnum;
    switch (type) {
        case IOComponentEnum::UCHAR:
            return Stored::uint8;
        case IOComponentEnum::CHAR:
            return Stored::int8;
        case IOComponentEnum::USHORT:
            return Stored::uint16;
        case IOComponentEnum::SHORT:
            return Stored::int16;
        case IOComponentEnum::UINT:
            return Stored::uint32;
        case IOComponentEnum::INT:
            return Stored::int32;
        case IOComponentEnum::ULONG:
        case IOComponentEnum::ULONGLONG:
            return Stored::uint64;
        case IOComponentEnum::LONG:
        case IOComponentEnum::LONGLONG:
            return Stored::int64;
        case IOComponentEnum::FLOAT:
            return Stored::float32;
        case IOComponentEnum::DOUBLE:
            return Stored::float64;
        default:
            throw Failure("its sample type is not known; save it as int16 or float32");
    }
}

itk::IOComponentEnum component_from(SampleType type) {
    switch (type) {
        case SampleType::uint8:
            return itk::IOComponentEnum::UCHAR;
        case SampleType::int16:
            return itk::IOComponentEnum::SHORT;
        case SampleType::uint16:
            return itk::IOComponentEnum::USHORT;
        case SampleType::float32:
            break;
    }
    return itk::IOComponentEnum::FLOAT;
}

/// The first three axes; missing ones are one sample thick.
Geometry geometry_of(const itk::ImageIOBase& io) {
    Geometry g;
    g.size = Index3::Ones();
    const unsigned axes = std::min(3U, io.GetNumberOfDimensions());
    for (unsigned a = 0; a < axes; ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        g.size[i] = static_cast<int>(io.GetDimensions(a));
        g.spacing[i] = io.GetSpacing(a);
        g.origin[i] = io.GetOrigin(a);
        const auto axis = io.GetDirection(a);
        for (unsigned r = 0; r < axes; ++r) g.direction(static_cast<Eigen::Index>(r), i) = axis[r];
    }
    // A slice that is one sample thick may come with a spacing of 0: no distance is measured there.
    if (g.size[2] == 1 && !(g.spacing[2] > 0)) g.spacing[2] = 1;
    if (g.direction.determinant() == 0 && axes == 3 && g.size[2] == 1) {
        g.direction.col(2) = g.direction.col(0).cross(g.direction.col(1));
    }
    return g;
}

/// How many volumes of `volume` samples each ITK finds.
std::int64_t steps_of(const itk::ImageIOBase& io, const HeaderFacts& facts, std::int64_t volume) {
    std::int64_t total = 1, expected = 1;
    for (unsigned a = 0; a < io.GetNumberOfDimensions(); ++a) {
        total *= static_cast<std::int64_t>(io.GetDimensions(a));
    }
    for (const auto s : facts.sizes) expected *= s;
    if (total != expected) {
        throw Failure("ITK reads " + std::to_string(total) + " samples, its header says " +
                      text_of(facts.sizes) + "; save it as plain NRRD");
    }
    if (io.GetNumberOfComponents() > 1) {
        throw Failure("it has " + std::to_string(io.GetNumberOfComponents()) +
                      " values a sample (colours or vectors); give a volume with one");
    }
    return total / volume;
}

void read_whole(itk::ImageIOBase& io, void* to) {
    const unsigned axes = io.GetNumberOfDimensions();
    itk::ImageIORegion region(axes);
    for (unsigned a = 0; a < axes; ++a) {
        region.SetIndex(a, 0);
        region.SetSize(a, io.GetDimensions(a));
    }
    io.SetIORegion(region);
    io.Read(to);
}

}  // namespace

PlainLayout nifti_samples(const Request& request) {
    if (is_gzip(request.path)) {
        throw Failure(
            "its samples are compressed, so they cannot be read piece by piece; save it as .nii, "
            "or "
            "convert it to OME-Zarr");
    }
    const NiftiHeader header = check_nifti(request);
    const auto io = itk::NiftiImageIO::New();
    io->SetFileName(request.path.string());
    io->ReadImageInformation();
    PlainLayout plain;
    plain.stored = header.stored;
    plain.place = header.place;
    plain.slope = header.slope;
    plain.intercept = header.intercept;
    plain.about.format = "NIfTI";
    plain.about.geometry = geometry_of(*io);
    plain.about.times = header.times;
    plain.about.notes = header.notes;
    plain.about.time_steps =
        static_cast<int>(steps_of(*io, header, sample_count(plain.about.geometry)));
    if (request.spacing) plain.about.geometry.spacing = *request.spacing;
    check_geometry(plain.about.geometry);
    return plain;
}

Result read_nifti(const Request& request) {
    const NiftiHeader facts = check_nifti(request);
    say_progress(0.3);  // what the check took of the time, roughly
    say_doing(request.path.filename().string());
    const auto io = itk::NiftiImageIO::New();
    io->SetFileName(request.path.string());
    io->ReadImageInformation();
    Result result;
    result.format = "NIfTI";
    result.notes = facts.notes;
    result.geometry = geometry_of(*io);
    const Stored stored = stored_from(io->GetComponentType());
    result.type = kept_as(stored);
    if (stored != facts.stored) {
        result.notes.push_back(
            "the file's slope and intercept were applied: " + name_of(facts.stored) + " became " +
            std::string(name_of(result.type)));
    } else {
        note_conversion(stored, result.notes);
    }
    const std::int64_t volume = sample_count(result.geometry);
    const std::int64_t steps = steps_of(*io, facts, volume);
    take_step(request, steps, facts.times, result);
    const auto count = static_cast<std::size_t>(volume);
    const auto samples = shared_samples(count * size_of(result.type));
    if (steps == 1 && name_of(stored) == name_of(result.type)) {
        read_whole(*io, samples.data());
    } else {
        std::vector<std::byte> all(static_cast<std::size_t>(io->GetImageSizeInBytes()));
        read_whole(*io, all.data());
        const std::size_t first = static_cast<std::size_t>(request.time_step) * count;
        convert(stored, all.data() + first * size_of(stored), result.type, samples.data(), count);
    }
    finish(result, request, samples);
    return result;
}

namespace {

/// Reads the header back and counts the data: a full disk shows here, ITK does not tell.
void check_written(const std::filesystem::path& path, const std::string& extension,
                   std::int64_t samples) {
    Request request;
    request.path = path;
    std::vector<std::int64_t> sizes;
    try {
        if (extension == ".nii" || extension == ".nii.gz") {
            sizes = check_nifti(request).sizes;
        } else {
            const bool nrrd = extension == ".nrrd" || extension == ".nhdr";
            VolumeHeader header = nrrd ? nrrd_header(request) : meta_image_header(request);
            stream_samples(header, {});
            sizes = header.sizes;
        }
    } catch (const Failure&) {
        throw Failure("was not written whole; is the disk full?");
    }
    std::int64_t written = 1;
    for (const auto s : sizes) written *= s;
    if (written != samples) throw Failure("is too large for this format; write .nrrd instead");
}

}  // namespace

void write_with_itk(const std::filesystem::path& path, const std::string& extension,
                    const Geometry& geometry, SampleType type, const void* samples, bool compress) {
    itk::ImageIOBase::Pointer io;
    if (extension == ".nrrd" || extension == ".nhdr") io = itk::NrrdImageIO::New();
    if (extension == ".mha" || extension == ".mhd") io = itk::MetaImageIO::New();
    if (extension == ".nii" || extension == ".nii.gz") io = itk::NiftiImageIO::New();
    if (!io) throw Failure("has no extension of a format that can be written");
    io->SetFileName(path.string());
    io->SetNumberOfDimensions(3);
    itk::ImageIORegion region(3);
    for (unsigned a = 0; a < 3; ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        const auto size = static_cast<itk::SizeValueType>(geometry.size[i]);
        io->SetDimensions(a, size);
        io->SetSpacing(a, geometry.spacing[i]);
        io->SetOrigin(a, geometry.origin[i]);
        const std::vector<double> axis = {geometry.direction(0, i), geometry.direction(1, i),
                                          geometry.direction(2, i)};
        io->SetDirection(a, axis);
        region.SetIndex(a, 0);
        region.SetSize(a, size);
    }
    io->SetIORegion(region);
    io->SetComponentType(component_from(type));
    io->SetPixelType(itk::IOPixelEnum::SCALAR);
    io->SetNumberOfComponents(1);
    io->SetUseCompression(compress);
    io->WriteImageInformation();
    io->Write(samples);
    check_written(path, extension, sample_count(geometry));
}

}  // namespace palpate::io

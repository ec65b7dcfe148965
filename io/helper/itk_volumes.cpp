// Writes NRRD, MetaImage and NIfTI with ITK's ImageIO classes, straight from the shared samples: no
// itk::Image, no pixel conversion, no factories.
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <fstream>

#include "io/helper/headers.hpp"
#include "io/helper/readers.hpp"

namespace palpate::io {
namespace {

/// Reads the header back and counts the data: a full disk shows here, ITK does not tell.
void check_written(const std::filesystem::path& path, std::int64_t samples) {
    Request request;
    request.path = path;
    std::uint64_t written = 0;
    try {
        VolumeHeader header = header_reader(path)(request);
        stream_samples(header, {});
        written = header.samples();
    } catch (const Failure&) {
        throw Failure(not_written_whole);
    }
    if (written != static_cast<std::uint64_t>(samples))
        throw Failure("is too large for this format; write .nrrd instead");
}

/// Says in a NRRD header that the axes are not known to be the body's. NIfTI has no place for an
/// origin without saying that they are.
void leave_unoriented(itk::ImageIOBase& io) {
    itk::EncapsulateMetaData<std::string>(io.GetMetaDataDictionary(), "NRRD_space",
                                          "3D-right-handed");
}

/// ITK has no way to leave MetaImage's orientation open.
void erase_orientation(const std::filesystem::path& path) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const std::string field = "AnatomicalOrientation = ";
    for (std::string line; std::getline(file, line) && !line.starts_with("ElementDataFile");) {
        if (!line.starts_with(field)) continue;
        file.seekp(file.tellg() - static_cast<std::streamoff>(line.size() - field.size() + 1));
        file << std::string(line.size() - field.size(), '?');
        return;
    }
}

}  // namespace

void write_with_itk(const std::filesystem::path& path, const WrittenVolume& volume) {
    const std::string extension = extension_of(path);
    const Geometry& geometry = volume.geometry;
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
    io->SetComponentType(with_type(volume.type, [](auto zero) {
        return itk::ImageIOBase::MapPixelType<decltype(zero)>::CType;
    }));
    io->SetPixelType(itk::IOPixelEnum::SCALAR);
    io->SetNumberOfComponents(1);
    io->SetUseCompression(volume.compress || extension == ".nii.gz");
    if (!geometry.oriented) leave_unoriented(*io);
    io->WriteImageInformation();
    io->Write(volume.samples);
    if (!geometry.oriented && extension.starts_with(".mh")) erase_orientation(path);
    check_written(path, sample_count(geometry));
}

}  // namespace palpate::io

// Reads NRRD, MetaImage and NIfTI with ITK's ImageIO classes.
#include "itk_reader.hpp"

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <cstring>

namespace palpate::io::test {
namespace {

template <class T>
std::vector<double> numbers(const std::vector<char>& bytes) {
    std::vector<double> values;
    for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
        T value;
        std::memcpy(&value, bytes.data() + at, sizeof value);
        values.push_back(static_cast<double>(value));
    }
    return values;
}

std::vector<double> numbers(itk::IOComponentEnum type, const std::vector<char>& bytes) {
    using itk::IOComponentEnum;
    switch (type) {
        case IOComponentEnum::UCHAR:
            return numbers<std::uint8_t>(bytes);
        case IOComponentEnum::CHAR:
            return numbers<std::int8_t>(bytes);
        case IOComponentEnum::USHORT:
            return numbers<std::uint16_t>(bytes);
        case IOComponentEnum::SHORT:
            return numbers<std::int16_t>(bytes);
        case IOComponentEnum::UINT:
            return numbers<std::uint32_t>(bytes);
        case IOComponentEnum::INT:
            return numbers<std::int32_t>(bytes);
        case IOComponentEnum::ULONG:
        case IOComponentEnum::ULONGLONG:
            return numbers<std::uint64_t>(bytes);
        case IOComponentEnum::LONG:
        case IOComponentEnum::LONGLONG:
            return numbers<std::int64_t>(bytes);
        case IOComponentEnum::FLOAT:
            return numbers<float>(bytes);
        default:
            return numbers<double>(bytes);
    }
}

ItkVolume read(itk::ImageIOBase& io, const std::filesystem::path& path) {
    io.SetFileName(path.string());
    io.ReadImageInformation();
    ItkVolume volume;
    volume.components = static_cast<int>(io.GetNumberOfComponents());
    const unsigned axes = io.GetNumberOfDimensions();
    itk::ImageIORegion region(axes);
    for (unsigned a = 0; a < axes; ++a) {
        region.SetIndex(a, 0);
        region.SetSize(a, io.GetDimensions(a));
        volume.sizes.push_back(static_cast<std::int64_t>(io.GetDimensions(a)));
        volume.spacing.push_back(io.GetSpacing(a));
        volume.origin.push_back(io.GetOrigin(a));
        volume.axes.push_back(io.GetDirection(a));
    }
    io.SetIORegion(region);
    std::vector<char> bytes(static_cast<std::size_t>(io.GetImageSizeInBytes()));
    io.Read(bytes.data());
    volume.samples = numbers(io.GetComponentType(), bytes);
    return volume;
}

}  // namespace

ItkVolume read_with_itk(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    try {
        if (extension == ".nrrd" || extension == ".nhdr") {
            return read(*itk::NrrdImageIO::New(), path);
        }
        if (extension == ".nii" || extension == ".gz") {
            return read(*itk::NiftiImageIO::New(), path);
        }
        return read(*itk::MetaImageIO::New(), path);
    } catch (const std::exception& e) {
        ItkVolume refused;
        refused.error = e.what();
        return refused;
    }
}

}  // namespace palpate::io::test

// The readers and writers of the helper programs, one source file for each family of formats.
#pragma once

#include <string>

#include "io/helper/headers.hpp"

namespace palpate::io {

/// Each reads request.path into the shared samples, or throws Failure or its library's exception.
/// A folder is one of DICOM's or TIFF's slices.
Result read_by_header(const Request& request);
Result read_dicom(const Request& request);
Result read_tiff(const Request& request);
Result read_vti(const Request& request);

/// Where the samples of request.path lie, without reading them, and the grid that is asked for.
/// Throws OnlyWhole where they cannot be read from there by the box: compressed, text, or those of
/// several volumes mixed.
VolumeHeader locate_by_header(const Request& request);

/// Whether a name begins with a point: no slice of a folder, such as the "._a.tif" that macOS keeps
/// beside "a.tif" on disks of others, and half a copy of rsync's.
bool is_hidden(const std::filesystem::path& file);
/// Whether a folder shows it as a file.
bool is_shown_file(const std::filesystem::directory_entry& entry);
/// A link to a file that is not there, as git-annex and DataLad leave them, or to itself.
bool is_dangling_link(const std::filesystem::directory_entry& entry);
/// DICOM's four letters after 128 bytes, or, without these, elements as files begin with.
bool begins_as_dicom(const std::filesystem::path& file);
/// The same for a file in a folder, where hidden ones do not count.
bool looks_like_dicom(const std::filesystem::path& file);
/// Whether a name says DICOM, also of a packed file.
bool has_dicom_name(const std::filesystem::path& file);
/// Whether a file lists the slices of a disc (DICOMDIR).
bool is_dicom_index(const std::filesystem::path& file);
/// Whether a folder is a disc's: its slices are in folders of folders.
bool has_dicom_index(const std::filesystem::path& folder);
/// TIFF's first four bytes, whatever the name (.lsm, .btf, .tf8, ...).
bool begins_as_tiff(const std::filesystem::path& file);
/// HDF5's first eight bytes, whatever the name (.nxs, .nc, ...).
bool begins_as_hdf5(const std::filesystem::path& file);

struct MeshSize {
    std::int64_t vertices = 0, triangles = 0;
};
/// Reads a mesh into shared memory: all vertices [3 doubles each], then all triangles [3 32-bit
/// numbers of vertices each].
MeshSize read_mesh(const std::filesystem::path& path, const std::string& extension);

/// For every format: what its library says of a full disk is nothing for people.
inline constexpr const char* not_written_whole = "was not written whole; is the disk full?";

struct WrittenVolume {
    Geometry geometry;
    SampleType type = SampleType::uint8;
    const void* samples = nullptr;
    bool compress = false;
};
/// Writes the shared samples to `path`, in the format that its extension names.
void write_with_itk(const std::filesystem::path& path, const WrittenVolume& volume);
void write_vti(const std::filesystem::path& path, const WrittenVolume& volume);
void write_tiff(const std::filesystem::path& path, const WrittenVolume& volume);

}  // namespace palpate::io

// Headers of NRRD, MetaImage, NIfTI, MGH, MRC and VTK files: each format has one function here that
// turns a file into a description, which reading it whole and reading it by the box both use. Every
// function throws Failure.
#pragma once

#include <map>
#include <set>

#include "io/helper/decode.hpp"
#include "io/inflate.hpp"

namespace palpate::io {

/// A text header's fields, names in lower case.
struct HeaderFields {
    std::map<std::string, std::string> values;
    std::map<std::string, std::string> keys;  ///< NRRD's own pairs, "key:=value", as they are
    std::set<std::string> disputed;           ///< fields that are given twice
    std::uint64_t data_offset = 0;            ///< of the first byte after the header

    /// `only_once`: the format does not allow to repeat a field.
    void add(const std::string& name, const std::string& value, bool only_once) {
        const auto [at, is_new] = values.emplace(name, value);
        if (!is_new && (only_once || at->second != value)) disputed.insert(name);
    }
    bool has(const std::string& name) const { return values.count(name) > 0; }
    /// Empty if there is no such field. Throws Failure if it is there twice.
    std::string value(const std::string& name) const;
    /// Throws Failure that names the field if it is missing or empty.
    std::string needed(const std::string& name) const;
};

/// Where and how the samples are stored.
struct DataPlace {
    std::filesystem::path file;
    std::uint64_t offset = 0;           ///< of the first byte of data (or of the stream)
    std::uint64_t length = UINT64_MAX;  ///< bytes of a compressed stream, if the header says
    std::uint64_t skip = 0;             ///< bytes before the samples, after unpacking
    enum class Encoding { raw, compressed, text } encoding = Encoding::raw;
    /// What may follow the samples: VTK's arrays begin with a word, FreeSurfer's tags are numbers.
    enum class Footer { none, words, tags } footer = Footer::none;
    bool is_at_end = false;  ///< compressed samples are the last bytes of what is unpacked
    bool swapped = false;    ///< the bytes of a sample are in the other order than the machine's
};

/// All that reading the samples of one volume takes.
struct VolumeHeader {
    std::string format;
    std::vector<std::int64_t> sizes;  ///< every axis, the file's order
    Stored stored = Stored::uint8;
    ValueMap value_map;
    std::vector<std::string> notes;
    FrameTimes times;  ///< of a file with several volumes
    Geometry geometry;
    /// Where the samples lie; in several files, one behind the other, as many in each.
    std::vector<DataPlace> places{1};
    std::int64_t steps = 1;  ///< volumes in the file
    /// Samples of one volume that lie together, before those of the next volume: the whole volume
    /// where the volumes follow each other, 1 where the axis that counts them is the first.
    std::int64_t together = 1;
    ValueInfo values;

    std::uint64_t samples() const;  ///< of all volumes
    std::uint64_t bytes() const { return samples() * size_of(stored); }
    std::uint64_t bytes_each() const { return bytes() / places.size(); }  ///< of a file
};

VolumeHeader nrrd_header(const Request& request);
VolumeHeader meta_image_header(const Request& request);
VolumeHeader nifti_header(const Request& request);
VolumeHeader mgh_header(const Request& request);
VolumeHeader mrc_header(const Request& request);
VolumeHeader vtk_header(const Request& request);
/// One of these, by a file's extension; null for a file of another format.
using ReadHeader = VolumeHeader(const Request& request);
ReadHeader* header_reader(const std::filesystem::path& path);

/// So many bytes from the beginning of a file, unpacked if it is packed; fewer if it has no more.
/// Throws Failure.
std::vector<std::byte> start_of(const std::filesystem::path& file, std::size_t bytes);

/// The other file of a pair of NIfTI or Analyze, a.hdr and a.img, which may be packed. Of several,
/// the first is taken.
std::vector<std::filesystem::path> other_halves(const std::filesystem::path& path);

/// The other files that are read with this header's volume: those that it names, or the other half
/// of a pair. None if the header cannot be read.
std::vector<std::filesystem::path> files_read_with(const std::filesystem::path& header);

/// In lower case; of a.nii.gz both, which are packed.
std::string extension_of(const std::filesystem::path& path);

/// Throws Failure unless the file has the bytes that raw samples take. Up to 4096 more give a note,
/// unless they are as many as the samples.
void check_raw_length(VolumeHeader& header);

/// Hands the bytes of all samples to `sink` in order, in the machine's byte order and in pieces of
/// whole samples. Throws Failure if the data are damaged, fewer than the header says, or longer by
/// more than 4096 bytes or as much again; up to that, a note is added. With an empty sink it only
/// checks.
void stream_samples(VolumeHeader& header, const ByteSink& sink);

/// Appends a number of a text as a sample. Throws Failure if an integer type cannot hold it.
void append_sample(double number, Stored stored, std::vector<std::byte>& bytes);

/// What to do with scans of Philips in two files, .PAR and .REC.
inline constexpr const char* parrec_advice =
    "is of a scan of Philips (PAR/REC), which is not read; convert it with dcm2niix or "
    "parrec2nii";

/// Numbers separated by blanks; throws Failure that names the `field`.
std::vector<double> numbers_in(const std::string& text, const std::string& field);
/// The same for sizes.
std::vector<std::int64_t> sizes_in(const std::string& text, const std::string& field);
/// The same for a field of one whole number of at least `least`.
std::int64_t whole_number_in(const std::string& text, const std::string& field, double least);

/// Whether the name of a data file says that a list of them follows.
bool is_list(const std::string& name);
/// The data files that a header names: one, those of a pattern such as "a%03d.raw 1 9 2", or after
/// "LIST" those of the lines in the header from `fields.data_offset` on. One that is not there is
/// looked for beside the header, with a note. `steps`: if above 0, a pattern without its numbers,
/// or with the first alone, means so many files, unless a file has that name.
std::vector<std::filesystem::path> data_files(const std::string& name, const HeaderFields& fields,
                                              const std::filesystem::path& header,
                                              std::vector<std::string>& notes,
                                              std::int64_t steps = 0);
/// A place like this one in each file.
std::vector<DataPlace> places_in(const std::vector<std::filesystem::path>& files,
                                 const DataPlace& like);
/// For headers whose `field` is -1: the samples of a file are its last bytes, behind the header.
/// Throws Failure for samples that are not raw.
void put_at_end(DataPlace& place, std::uint64_t bytes, const std::string& field);
/// The bytes of all data files; a missing one has none, which reading them says. Throws Failure
/// unless each may have as many slices.
std::uint64_t file_bytes(const VolumeHeader& header);

}  // namespace palpate::io

// Files that are made, or damaged, so that a library would compute for ever or fill the memory: the
// refusal comes first, at little cost.
#include <sys/resource.h>

#include <chrono>
#include <limits>

#include "volume_nifti_bytes.hpp"

namespace palpate::io::test {
namespace {

/// [s] of processor time of this process and of the children that it has waited for.
double processor_time() {
    double seconds = 0;
    for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        ::getrusage(who, &usage);
        for (const timeval& t : {usage.ru_utime, usage.ru_stime}) {
            seconds += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
        }
    }
    return seconds;
}

std::string refusal_of_bytes(const std::filesystem::path& path, const std::string& bytes) {
    put_bytes(path, bytes);
    const std::string message = refusal(path);
    EXPECT_TRUE(one_line_about(message, path)) << message;
    return message;
}

constexpr float huge = 3e38F, tiny = 1e-38F;

/// `rows` x 4 numbers of a NIfTI transform.
std::string transform(float xx, float yy, float zz, float shift) {
    return little(xx) + little(0.0F) + little(0.0F) + little(shift) + little(0.0F) + little(yy) +
           little(0.0F) + little(shift) + little(0.0F) + little(0.0F) + little(zz) + little(shift);
}

TEST(hostile_file, a_header_that_says_much_is_quoted_in_short) {
    const ScratchFolder folder;
    for (const char* blank : {"", "\x1b", "\r"}) {
        const std::string much = std::string(70'000, 'x') + blank + 'x';
        const std::string message = refusal_of_bytes(
            folder / "a.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nspace: " + much +
                                   "\nsizes: 1 1 1\nencoding: raw\n\n\x01");
        EXPECT_LT(message.size(), 1000);
        EXPECT_TRUE(contains(message, "'space'")) << message;
        EXPECT_TRUE(contains(message, "correct the header")) << message;
    }
}

TEST(hostile_file, a_nifti_transform_without_bounds_never_reaches_the_library) {
    const ScratchFolder folder;
    const auto with_transform = [&](const std::string& numbers) {
        return refusal_of_bytes(folder / "a.nii", nifti([&](std::string& header) {
                                    put_at(header, 252, little<std::int16_t>(0));
                                    put_at(header, 254, little<std::int16_t>(1));
                                    put_at(header, 280, numbers);
                                }));
    };
    for (const float bad : {huge, -huge, infinite, not_a_number, tiny}) {
        EXPECT_TRUE(contains(with_transform(transform(1, bad, 1, 0)), "'srow'")) << bad;
        EXPECT_TRUE(contains(with_transform(transform(bad, bad, bad, bad)), "'srow'")) << bad;
        if (bad != tiny) {
            EXPECT_TRUE(contains(with_transform(transform(1, 1, 1, bad)), "'srow'")) << bad;
        }
    }
    // What is within the bounds is read; the transform says the spacing.
    const auto notes_with = [&](float spacing, std::int16_t qform) {
        put_bytes(folder / "a.nii", nifti([&](std::string& header) {
                      put_at(header, 80, little(spacing) + little(3.0F) + little(4.0F));
                      put_at(header, 252, little(qform) + little<std::int16_t>(1));
                      put_at(header, 280, transform(2, 3, 4, 5));
                  }));
        const VolumeFile file = read_volume(folder / "a.nii");
        EXPECT_EQ(file.volume.geometry().spacing, Vec3(2, 3, 4));
        return all_notes(file);
    };
    EXPECT_EQ(notes_with(2, 0), "");
    EXPECT_TRUE(contains(notes_with(1, 1), "two spacings along axis 1"));
}

TEST(hostile_file, every_other_length_of_a_nifti_header_has_bounds_too) {
    const ScratchFolder folder;
    for (const std::size_t at : {80U, 84U, 88U, 256U, 260U, 264U, 268U, 272U, 276U}) {
        for (const float bad : {huge, -huge, infinite, not_a_number}) {
            refusal_of_bytes(folder / "a.nii",
                             nifti([&](std::string& header) { put_at(header, at, little(bad)); }));
        }
    }
}

TEST(hostile_file, lengths_beyond_sense_are_refused_in_every_format) {
    const ScratchFolder folder;
    const std::string data(24, 'x');
    for (const char* number : {"3e38", "-3e38", "1e300", "1e-300", "nan", "inf"}) {
        const std::string n = number;
        const std::string nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\n";
        if (n != "nan") {  // not known, as the format has it
            refusal_of_bytes(folder / "a.nrrd",
                             nrrd + "spacings: 1 " + n + " 1\nencoding: raw\n\n" + data);
        }
        refusal_of_bytes(folder / "a.nrrd", nrrd + "space: LPS\nspace directions: (1,0,0) (0," + n +
                                                ",0) (0,0,1)\nencoding: raw\n\n" + data);
        const std::string meta = "NDims = 3\nDimSize = 2 3 4\nElementType = MET_UCHAR\n";
        refusal_of_bytes(folder / "a.mha",
                         meta + "ElementSpacing = 1 " + n + " 1\nElementDataFile = LOCAL\n" + data);
        const auto vti = [&](const std::string& where) {
            return "<VTKFile type=\"ImageData\" version=\"0.1\" "
                   "byte_order=\"LittleEndian\">\n<ImageData WholeExtent=\"0 1 0 0 0 0\" " +
                   where +
                   "><Piece Extent=\"0 1 0 0 0 0\"><PointData><DataArray type=\"Int16\" "
                   "Name=\"a\" format=\"ascii\">1 2</DataArray></PointData></Piece></ImageData>"
                   "</VTKFile>\n";
        };
        SCOPED_TRACE(n);
        refusal_of_bytes(folder / "a.vti", vti("Spacing=\"" + n + " 1 1\""));
        if (n == "1e-300") continue;  // a fine position
        refusal_of_bytes(folder / "a.vti", vti("Origin=\"" + n + " 1 1\""));
        refusal_of_bytes(folder / "a.vti", vti("Direction='" + n + " 0 0 0 1 0 0 0 1'"));
        refusal_of_bytes(folder / "a.mha",
                         meta + "Offset = 1 " + n + " 1\nElementDataFile = LOCAL\n" + data);
    }
}

/// A gzip stream of `bytes` and then 3 GiB of zeros, in 200 kB.
std::string bomb_after(const std::filesystem::path& scratch, const std::string& bytes) {
    put_gzip(scratch, bytes);
    const std::string first = bytes_of(scratch);
    put_gzip(scratch, std::string(64 << 20, '\0'));
    const std::string zeros = bytes_of(scratch);
    std::string bomb = first;
    for (int i = 0; i < 48; ++i) bomb += zeros;
    return bomb;
}

TEST(hostile_file, a_gzip_bomb_is_unpacked_up_to_the_declared_size_only) {
    const ScratchFolder folder;
    const std::string packed_nifti = bomb_after(folder / "x.gz", nifti([](std::string&) {}));
    const std::string packed_raw = bomb_after(folder / "x.gz", std::string(24, 'x'));
    const double before = processor_time();
    EXPECT_TRUE(contains(refusal_of_bytes(folder / "a.nii.gz", packed_nifti),
                         "unpacks to more than the header says"));
    EXPECT_TRUE(contains(refusal_of_bytes(folder / "a.nrrd",
                                          "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\n"
                                          "encoding: gzip\n\n" +
                                              packed_raw),
                         "unpacks to more than the header says"));
    put_bytes(folder / "a.raw.gz", packed_raw);
    ReadOptions options;
    options.raw = RawLayout{Index3(2, 3, 4)};
    EXPECT_TRUE(contains(refusal(folder / "a.raw.gz", options), "unpacks to more than the 24"));
    EXPECT_LT(processor_time() - before, 4);  // 3 GiB take longer, three times even more so
}

/// A TIFF page of 4x3 bytes in one deflate strip, which is given.
std::string tiff_with_strip(const std::string& strip) {
    std::string bytes = "II" + little<std::uint16_t>(42) + little<std::uint32_t>(8);
    const std::uint32_t fields[][2] = {{256, 4}, {257, 3}, {258, 8}, {259, 8}, {262, 1},
                                       {273, 0}, {277, 1}, {278, 3}, {279, 0}};
    bytes += little(static_cast<std::uint16_t>(std::size(fields)));
    const std::size_t strip_at = 8 + 2 + 12 * std::size(fields) + 4;
    for (const auto& [tag, value] : fields) {
        const std::size_t number = tag == 273 ? strip_at : tag == 279 ? strip.size() : value;
        bytes += little(static_cast<std::uint16_t>(tag)) + little<std::uint16_t>(4) +
                 little<std::uint32_t>(1) + little(static_cast<std::uint32_t>(number));
    }
    return bytes + little<std::uint32_t>(0) + strip;
}

TEST(hostile_file, a_tiff_strip_that_unpacks_to_more_than_its_rows_is_refused) {
    const auto packed = [](std::size_t zeros) {
        std::string in(zeros, '\0'), out(compressBound(static_cast<uLong>(zeros)), '\0');
        auto size = static_cast<uLongf>(out.size());
        compress(reinterpret_cast<Bytef*>(out.data()), &size,
                 reinterpret_cast<const Bytef*>(in.data()), static_cast<uLong>(zeros));
        out.resize(size);
        return out;
    };
    const ScratchFolder folder;
    put_bytes(folder / "a.tif", tiff_with_strip(packed(12)));
    EXPECT_EQ(read_volume(folder / "a.tif").volume.geometry().size, Index3(4, 3, 1));
    EXPECT_TRUE(contains(refusal_of_bytes(folder / "a.tif", tiff_with_strip(packed(64 << 20))),
                         "unpacks to more than"));
}

}  // namespace
}  // namespace palpate::io::test

// Palpate and ITK read the same samples and the same geometry from the same NRRD and MetaImage
// files: real ones, headers as other programs write them, and random ones.
#include <zlib.h>

#include <functional>

#include "io/real_volumes.hpp"
#include "io/volume_support.hpp"
#include "itk_reader.hpp"

namespace palpate::io::test {
namespace {

/// Both read it, and find the same.
void expect_as_itk(const std::filesystem::path& path) {
    SCOPED_TRACE(path.string());
    const ItkVolume itk = read_with_itk(path);
    ASSERT_EQ(itk.error, "");
    VolumeFile file = read_volume(path);
    const Geometry& g = file.volume.geometry();
    const std::size_t axes = std::min<std::size_t>(3, itk.sizes.size());
    for (std::size_t a = 0; a < axes; ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        EXPECT_EQ(g.size[i], itk.sizes[a]);
        EXPECT_NEAR(g.spacing[i], itk.spacing[a], 1e-14 * itk.spacing[a]);
        EXPECT_EQ(g.origin[i], itk.origin[a]);
        for (std::size_t r = 0; r < axes; ++r) {
            EXPECT_NEAR(g.direction(static_cast<Eigen::Index>(r), i), itk.axes[a][r], 1e-15);
        }
    }
    const std::int64_t count = sample_count(g);
    const auto components = static_cast<std::size_t>(itk.components);
    ASSERT_EQ(static_cast<std::int64_t>(itk.samples.size()), count * file.time_steps);
    for (int step = 0; step < file.time_steps; ++step) {
        ReadOptions options;
        options.time_step = step;
        if (step > 0) file = read_volume(path, options);
        // ITK puts an axis of values first, and one of times last.
        const std::size_t first = components > 1 ? std::size_t(step) : std::size_t(step * count);
        for (std::int64_t i = 0; i < count; ++i) {
            const Index3 at(int(i % g.size[0]), int(i / g.size[0] % g.size[1]),
                            int(i / g.size[0] / g.size[1]));
            const double expected = itk.samples[first + components * std::size_t(i)];
            ASSERT_EQ(file.volume.sample(at), double(float(expected))) << at.transpose();
        }
    }
}

void expect_as_itk(const ScratchFolder& folder, const std::string& name, const std::string& bytes) {
    put_bytes(folder / name, bytes);
    expect_as_itk(folder / name);
}

std::string gzipped(const std::string& bytes) {
    std::string packed(compressBound(bytes.size()) + 64, '\0');
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

std::string text_of(const Vec3& v, const char* separator) {
    char text[100];
    std::snprintf(text, sizeof text, "%.17g%s%.17g%s%.17g", v[0], separator, v[1], separator, v[2]);
    return text;
}

std::string brackets(const Vec3& v) {
    return "(" + text_of(v, ",") + ")";
}

struct StoredType {
    const char* nrrd;
    const char* meta;
    std::size_t bytes;
};
constexpr StoredType stored_types[] = {
    {"int8", "MET_CHAR", 1},       {"uint8", "MET_UCHAR", 1},       {"short", "MET_SHORT", 2},
    {"uint16", "MET_USHORT", 2},   {"int32", "MET_INT", 4},         {"unsigned int", "MET_UINT", 4},
    {"int64", "MET_LONG_LONG", 8}, {"uint64", "MET_ULONG_LONG", 8}, {"float", "MET_FLOAT", 4},
    {"double", "MET_DOUBLE", 8}};

/// Bytes of random samples; those of floating point are numbers of moderate size.
std::string random_samples(std::mt19937& random, const StoredType& type, std::size_t count,
                           bool swapped) {
    std::string bytes;
    const std::string name = type.nrrd;
    for (std::size_t i = 0; i < count; ++i) {
        std::string sample;
        if (name == "float") {
            sample = little(static_cast<float>(uniform(random, -1e4, 1e4)));
        } else if (name == "double") {
            sample = little(uniform(random, -1e4, 1e4));
        } else {
            for (std::size_t b = 0; b < type.bytes; ++b) sample += static_cast<char>(random());
        }
        if (swapped) std::reverse(sample.begin(), sample.end());
        bytes += sample;
    }
    return bytes;
}

std::string random_nrrd_geometry(std::mt19937& random, const Geometry& g) {
    static const char* const spaces[] = {"space: right-anterior-superior\n", "space: RAS\n",
                                         "space: left-posterior-superior\n", "space: scanner-xyz\n",
                                         "space dimension: 3\n"};
    if (random() % 3 > 0) {
        std::string text = spaces[random() % 5];
        text += "space directions:";
        for (int a = 0; a < 3; ++a) text += " " + brackets(g.spacing[a] * g.direction.col(a));
        if (random() % 4 > 0) text += "\nspace origin: " + brackets(g.origin);
        return text + "\n";
    }
    std::string text = "spacings: " + text_of(g.spacing, " ") + "\n";
    if (random() % 2 == 0) text += "axis mins: " + text_of(g.origin, " ") + "\n";
    if (random() % 2 == 0) text += "centers: node cell ???\n";
    return text;
}

const char* pick(std::mt19937& random, std::initializer_list<const char*> all) {
    return all.begin()[random() % all.size()];
}

}  // namespace

TEST(read_as_itk, random_nrrd_files) {
    const ScratchFolder folder;
    std::mt19937 random(20240701);
    for (int round = 0; round < 60; ++round) {
        const StoredType& type = stored_types[round % 10];
        const Geometry g = random_geometry(random, round % 2 == 1, round % 5 == 2);
        const bool big = random() % 2 == 0, packed = random() % 2 == 0;
        const bool detached = random() % 3 == 0, kinds = random() % 2 == 0;
        std::string data =
            random_samples(random, type, static_cast<std::size_t>(sample_count(g)), big);
        std::string header = "NRRD0005\n# a remark\ntype: " + std::string(type.nrrd) +
                             "\ndimension: 3\nsizes: " + text_of(g.size.cast<double>(), " ") +
                             "\nkey:=value\n" + random_nrrd_geometry(random, g);
        if (kinds) header += "kinds: domain space ???\n";
        header += std::string("endian: ") + (big ? "big\n" : "little\n");
        if (packed) data = gzipped(data);
        header += packed ? pick(random, {"encoding: gzip\n", "encoding: gz\n"}) : "encoding: raw\n";
        if (detached) {
            const bool skipped = random() % 2 == 0;
            if (skipped) header += "line skip: 2\n";
            put_bytes(folder / "a.bin", (skipped ? "one\ntwo\n" : "") + data);
            header += pick(random, {"data file: a.bin\n", "datafile: a.bin\n"});
            expect_as_itk(folder, "a.nhdr", header);
        } else {
            expect_as_itk(folder, "a.nrrd", header + "\n" + data);
        }
        if (HasFailure()) return;
    }
}

TEST(read_as_itk, random_meta_images) {
    const ScratchFolder folder;
    std::mt19937 random(20240702);
    for (int round = 0; round < 60; ++round) {
        const StoredType& type = stored_types[round % 10];
        const Geometry g = random_geometry(random, round % 2 == 1, round % 5 == 2);
        const bool big = random() % 2 == 0, packed = random() % 2 == 0;
        std::string data =
            random_samples(random, type, static_cast<std::size_t>(sample_count(g)), big);
        std::string header =
            "ObjectType = Image\nNDims = 3\nBinaryData = True\n" +
            std::string(pick(random, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"})) + " = " +
            (big ? "True" : "False") + "\n";
        header += std::string(pick(random, {"TransformMatrix", "Rotation", "Orientation"})) +
                  " = " + text_of(g.direction.col(0), " ") + " " +
                  text_of(g.direction.col(1), " ") + " " + text_of(g.direction.col(2), " ") + "\n";
        header += std::string(pick(random, {"Offset", "Position", "Origin"})) + " = " +
                  text_of(g.origin, " ") + "\n";
        header += std::string(pick(random, {"ElementSpacing", "ElementSize"})) + " = " +
                  text_of(g.spacing, " ") + "\nDimSize = " + text_of(g.size.cast<double>(), " ") +
                  "\n";
        const bool detached = random() % 2 == 0;
        const std::size_t before = detached && !packed && random() % 2 == 0 ? 7 : 0;
        if (before > 0) header += "HeaderSize = 7\n";
        if (packed) data = gzipped(data);
        if (packed) {
            header +=
                "CompressedData = True\nCompressedDataSize = " + std::to_string(data.size()) + "\n";
        }
        header += "ElementType = " + std::string(type.meta) + "\nElementDataFile = ";
        if (detached) {
            put_bytes(folder / "a.raw", std::string(before, 'x') + data);
            expect_as_itk(folder, "a.mhd", header + "a.raw\n");
        } else {
            expect_as_itk(folder, "a.mha", header + "LOCAL\n" + data);
        }
        if (HasFailure()) return;
    }
}

TEST(read_as_itk, headers_with_something_unusual) {
    const ScratchFolder folder;
    std::string bytes;
    for (char i = 0; i < 24; ++i) bytes += i;
    const std::string plain = "NRRD0004\ntype: uint8\nencoding: raw\n";
    const std::string three = plain + "dimension: 3\nsizes: 2 3 4\n";
    const std::string four = plain + "dimension: 4\n";
    for (const std::string& header :
         {three, three + "space: LPS\n", three + "space: LPS\nspace origin: (1,2,3)\n",
          three + "space: RAS\nspace directions: (0,2,0) (2,0,0) (0,0,-3)\n",
          three + "space: LPS\nspace directions: none (0,1,0) (0,0,3)\n",
          three +
              "spacings: 2 3 3\naxis mins: 5 6 7\naxis maxs: 9 12 19\ncenters: cell node cell\n",
          three + "spacings: 1 2 3\nkinds: domain domain domain\nunits: \"mm\" \"mm\" \"mm\"\n",
          plain + "dimension: 2\nsizes: 4 6\nspacings: 2 3\n", plain + "dimension: 1\nsizes: 24\n",
          plain + "dimension: 2\nsizes: 4 6\nspace dimension: 2\nspace directions: (0,2) (3,0)\n"
                  "space origin: (7,8)\n",
          four + "sizes: 2 3 2 2\nspacings: 1 2 3 0.5\n",
          four + "sizes: 2 3 2 2\nkinds: domain domain domain list\n",
          four + "sizes: 2 2 3 2\nkinds: domain list domain domain\nspacings: 1 nan 2 3\n",
          four + "sizes: 2 2 3 2\nkinds: list space space space\nspace: LPS\n"
                 "space directions: none (1,0,0) (0,2,0) (0,0,3)\n",
          four + "sizes: 1 2 3 4\nkinds: vector domain domain domain\nspacings: nan 1 2 3\n",
          plain + "dimension: 5\nsizes: 2 3 2 2 1\n"}) {
        SCOPED_TRACE(header);
        expect_as_itk(folder, "a.nrrd", header + "\n" + bytes);
    }
    const std::string meta = "NDims = 3\nDimSize = 2 3 4\nElementType = MET_UCHAR\n";
    for (const std::string& header :
         {meta, meta + "Position = 1 2 3\nOffset = 4 5 6\nOrigin = 7 8 9\n",
          meta + "Position = 1 2 3\nOffset = 4 5 6\n",
          meta + "Orientation = 0 1 0 1 0 0 0 0 1\nRotation = 0 0 1 0 1 0 1 0 0\n",
          meta + "ElementSize = 9 9 9\nElementSpacing = 1 2 3\n",
          meta + "BinaryData = False\nElementNumberOfChannels = 1\nElementSpacing = 1 1 1\n",
          std::string("NDims = 2\nDimSize = 4 6\nElementType = MET_UCHAR\nElementSpacing = 2 3\n"),
          std::string("NDims = 4\nDimSize = 2 3 2 2\nElementType = MET_UCHAR\n"
                      "ElementSpacing = 1 2 3 4\nOffset = 5 6 7 8\n"
                      "TransformMatrix = 0 1 0 0 1 0 0 0 0 0 1 0 0 0 0 1\n")}) {
        SCOPED_TRACE(header);
        const bool text = contains(header, "BinaryData = False");
        std::string data = bytes;
        if (text) {
            data.clear();
            for (int i = 0; i < 24; ++i) data += std::to_string(i) + " ";
        }
        expect_as_itk(folder, "a.mha", header + "ElementDataFile = LOCAL\n" + data);
    }
}

TEST(read_as_itk, a_header_size_counts_from_the_beginning_of_the_file) {
    const ScratchFolder folder;
    const std::string meta =
        "NDims = 3\nDimSize = 2 3 4\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\nHeaderSize "
        "= ";
    const std::string end = "\nElementDataFile = LOCAL\n";
    const std::size_t header = meta.size() + 3 + end.size();
    std::string bytes = "--";
    for (char i = 0; i < 24; ++i) bytes += i;
    expect_as_itk(folder, "a.mha", meta + std::to_string(header + 2) + end + bytes);
    // ITK takes the header for samples here.
    put_bytes(folder / "a.mha", meta + "002" + end + bytes);
    EXPECT_EQ(read_with_itk(folder / "a.mha").samples[0], 'i');
    EXPECT_TRUE(contains(refusal(folder / "a.mha"), "within the header"));
}

TEST(read_as_itk, what_itk_refuses_is_refused) {
    const ScratchFolder folder;
    const std::string plain = "NRRD0004\nencoding: raw\nsizes: 2 3 4\ndimension: 3\n";
    const std::string bytes(24, 'x');
    for (const std::string& header :
         {plain + "type: short\n", plain + "type: uint8\nspacings: 1 1\n",
          plain + "type: uint8\nkinds: domain domain\n",
          plain + "type: uint8\nkinds: domain domain sausage\n",
          plain + "type: uint8\nspace: nowhere\n",
          plain + "type: uint8\nspace: LPS\nspacings: 1 1 1\n",
          plain + "type: uint8\nspace: LPS\nspace directions: (1,0,0) (0,1,0)\n",
          plain + "type: uint8\nspace: LPS\nspace directions: (1,0) (0,1) (1,1)\n",
          plain + "type: uint8\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"}) {
        SCOPED_TRACE(header);
        put_bytes(folder / "a.nrrd", header + "\n" + bytes + bytes);
        EXPECT_NE(read_with_itk(folder / "a.nrrd").error, "");
        put_bytes(folder / "a.nrrd",
                  header + "\n" + bytes + (contains(header, "short") ? bytes : ""));
        EXPECT_NE(read_with_itk(folder / "a.nrrd").error, "");
        const std::string message = refusal(folder / "a.nrrd");
        EXPECT_TRUE(one_line_about(message, folder / "a.nrrd")) << message;
        EXPECT_FALSE(contains(message, "helper")) << message;
    }
}

TEST(read_otherwise_than_itk, a_space_may_have_more_dimensions_than_the_samples) {
    // As teem reads it: without directions the space does not matter.
    const ScratchFolder folder;
    put_bytes(folder / "a.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nencoding: raw\nspace: LPST\n\n" +
                  std::string(24, 'x'));
    EXPECT_NE(read_with_itk(folder / "a.nrrd").error, "");
    const Volume volume = read_volume(folder / "a.nrrd").volume;
    EXPECT_EQ(volume.geometry().size, Eigen::Vector3i(2, 3, 4));
    EXPECT_FALSE(volume.geometry().oriented);
}

TEST(read_otherwise_than_itk, left_anterior_superior_turns_the_axis_that_differs) {
    // ITK 5.2 turns left and right round, and leaves anterior: a mirrored body.
    const ScratchFolder folder;
    put_bytes(folder / "a.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nspace: LAS\nspace directions: "
              "(2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\nencoding: raw\n\n" +
                  std::string(24, 'x'));
    const ItkVolume itk = read_with_itk(folder / "a.nrrd");
    EXPECT_EQ(itk.origin, (std::vector<double>{-10, 20, 30}));
    const Geometry g = read_volume(folder / "a.nrrd").volume.geometry();
    EXPECT_EQ(g.origin, Vec3(10, -20, 30));
    EXPECT_EQ(g.direction, Mat3(Vec3(1, -1, 1).asDiagonal()));
}

TEST(read_otherwise_than_itk, the_ends_of_an_axis_tell_its_spacing) {
    // ITK 5.2 takes them for the origin, but 1 mm for the spacing.
    const ScratchFolder folder;
    put_bytes(folder / "a.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\naxis mins: 5 6 7\n"
              "axis maxs: 9 12 19\ncenters: cell node cell\nencoding: raw\n\n" +
                  std::string(24, 'x'));
    const ItkVolume itk = read_with_itk(folder / "a.nrrd");
    EXPECT_EQ(itk.spacing, (std::vector<double>{1, 1, 1}));
    const Geometry g = read_volume(folder / "a.nrrd").volume.geometry();
    EXPECT_EQ(g.spacing, Vec3(2, 3, 3));
    EXPECT_EQ(g.origin, Vec3(itk.origin[0], itk.origin[1], itk.origin[2]));
}

TEST(read_otherwise_than_itk, a_time_axis_outside_of_space_is_read) {
    const ScratchFolder folder;
    std::string bytes;
    for (char i = 0; i < 24; ++i) bytes += i;
    put_bytes(folder / "a.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 3 2 2\nspace: LPS\nspace directions: "
              "(2,0,0) (0,3,0) (0,0,4) none\nkinds: space space space time\n"
              "spacings: nan nan nan 0.5\nunits: \"mm\" \"mm\" \"mm\" \"s\"\nencoding: raw\n\n" +
                  bytes);
    EXPECT_NE(read_with_itk(folder / "a.nrrd").error, "");
    ReadOptions options;
    options.time_step = 1;
    const VolumeFile file = read_volume(folder / "a.nrrd", options);
    EXPECT_EQ(file.time_steps, 2);
    EXPECT_EQ(file.frame_interval, 0.5);
    EXPECT_EQ(file.volume.sample({1, 2, 1}), 23);
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(2, 3, 4));
}

TEST(read_as_itk, real_volumes) {
    for (const char* name :
         {"head", "lobster.nrrd", "orange.nrrd", "cthead_unc.nrrd", "neuron_confocal.nrrd",
          "fuel_small.nrrd", "fmri_headturn_4d.nrrd", "HeadMRVolume.mhd"}) {
        if (std::filesystem::exists(real_volume(name))) expect_as_itk(real_volume(name));
    }
}

}  // namespace palpate::io::test

// Headers as other programs write them: what is read of NRRD, MetaImage, NIfTI and VTI, and what is
// refused or said.
#include <zlib.h>

#include <limits>

#include "volume_nifti_bytes.hpp"

namespace palpate::io::test {
namespace {

std::string counting(int count) {
    std::string bytes;
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(i);
    return bytes;
}

const char* const plain_nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 4\n";
const char* const plain_meta =
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
    "DimSize = 2 3 4\nElementType = MET_UCHAR\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

/// Puts the bytes into a file of that name and reads it.
VolumeFile read_bytes(const ScratchFolder& folder, const std::string& name,
                      const std::string& bytes, const ReadOptions& options = {}) {
    put_bytes(folder / name, bytes);
    return read_volume(folder / name, options);
}

std::string refusal_of(const ScratchFolder& folder, const std::string& name,
                       const std::string& bytes, const ReadOptions& options = {}) {
    put_bytes(folder / name, bytes);
    const std::string message = refusal(folder / name, options);
    EXPECT_TRUE(one_line_about(message, folder / name)) << message;
    return message;
}

void expect_counting(const VolumeFile& file) {
    ASSERT_EQ(file.volume.geometry().size, Index3(2, 3, 4));
    for (int i = 0; i < 24; ++i) {
        ASSERT_EQ(file.volume.sample({i % 2, i / 2 % 3, i / 6}), i);
    }
}

TEST(nrrd, without_a_spacing_one_millimetre_is_taken_and_said) {
    const ScratchFolder folder;
    const VolumeFile file =
        read_bytes(folder, "a.nrrd", std::string(plain_nrrd) + "encoding: raw\n\n" + counting(24));
    expect_counting(file);
    EXPECT_EQ(file.volume.geometry().spacing, Vec3::Ones());
    EXPECT_TRUE(contains(all_notes(file), "1 mm was taken"));
}

TEST(nrrd, text_gzip_detached_and_skipped_data_are_read) {
    const ScratchFolder folder;
    std::string text;
    for (int i = 0; i < 24; ++i) text += std::to_string(i) + (i % 5 == 4 ? "\n" : " ");
    expect_counting(
        read_bytes(folder, "a.nrrd", std::string(plain_nrrd) + "encoding: ascii\n\n" + text));
    put_bytes(folder / "data.bin", "a line\nxy" + counting(24));
    expect_counting(read_bytes(folder, "b.nhdr",
                               std::string(plain_nrrd) +
                                   "encoding: raw\nline skip: 1\nbyte skip: 2\n"
                                   "data file: data.bin\n"));
    put_bytes(folder / "50%done.bin", counting(24));
    const std::string percent = "encoding: raw\ndata file: 50%done.bin\n";
    expect_counting(read_bytes(folder, "d.nhdr", plain_nrrd + percent));
    EXPECT_TRUE(contains(
        refusal_of(folder, "d.nhdr", plain_nrrd + replaced(percent, "done.bin", "d.bin 1 4 1")),
        "'501.bin' cannot be read"));
    expect_counting(read_bytes(
        folder, "c.nhdr",
        std::string(plain_nrrd) + "encoding: raw\nbyte skip: -1\ndata file: data.bin\n"));
}

TEST(nrrd, text_with_decimal_commas_is_refused_and_with_commas_between_numbers_read) {
    const ScratchFolder folder;
    const std::string head = std::string(plain_nrrd) + "encoding: ascii\n\n";
    std::string list, decimals;
    for (int i = 0; i < 24; ++i) {
        list += (i > 0 ? "," : "") + std::to_string(i);
        decimals += std::to_string(i) + ",5 ";
    }
    expect_counting(read_bytes(folder, "a.nrrd", head + list));
    EXPECT_TRUE(contains(all_notes(read_bytes(folder, "b.nrrd", head + list + ",24")), "are 25"));
    EXPECT_TRUE(contains(refusal_of(folder, "c.nrrd", head + decimals), "decimal commas"));
}

TEST(nrrd, right_anterior_superior_becomes_left_posterior_superior) {
    const ScratchFolder folder;
    const VolumeFile file =
        read_bytes(folder, "a.nrrd",
                   std::string(plain_nrrd) +
                       "space: right-anterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
                       "space origin: (10,20,30)\nencoding: raw\n\n" +
                       counting(24));
    expect_counting(file);
    const Geometry& g = file.volume.geometry();
    EXPECT_EQ(g.spacing, Vec3(2, 3, 4));
    EXPECT_EQ(g.origin, Vec3(-10, -20, 30));
    EXPECT_EQ(g.direction, Mat3(Vec3(-1, -1, 1).asDiagonal()));
}

TEST(nrrd, names_and_colours_of_a_segmentation_are_read) {
    const ScratchFolder folder;
    const std::string head =
        std::string(plain_nrrd) + "encoding: raw\n" +
        "Segment0_ID:=Segment_1\nSegment0_LabelValue:=1\nSegment0_Name:=left kidney\n"
        "Segment0_Color:=0.5 0.25 1.5\nSegment1_ID:=a\nSegment1_LabelValue:=none\n"
        "Segment2_ID:=b\nSegment2_LabelValue:=7\nanything:=else\n";
    const VolumeFile file = read_bytes(folder, "a.seg.nrrd", head + "\n" + counting(24));
    expect_counting(file);
    const auto& labels = file.values.labels;
    ASSERT_EQ(labels.size(), 2U);
    EXPECT_EQ(labels[0].value, 1);
    EXPECT_EQ(labels[0].name, "left kidney");
    EXPECT_EQ(labels[0].colour, (std::array{0.5, 0.25, 1.0}));
    EXPECT_EQ(labels[1].value, 7);
    EXPECT_TRUE(labels[1].name.empty());
    const std::string bad = replaced(head, "left kidney", "\xff\xfe" + std::string(9000, 'x'));
    const VolumeFile odd = read_bytes(folder, "b.seg.nrrd", bad + "\n" + counting(24));
    ASSERT_EQ(odd.values.labels.size(), 2U);
    EXPECT_LE(odd.values.labels[0].name.size(), 64U);
}

TEST(nrrd, segments_of_old_versions_of_slicer_are_one_in_each_layer) {
    const ScratchFolder folder;
    put_bytes(folder / "a.seg.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\n"
              "sizes: 2 4 3 1\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
              "kinds: list domain domain domain\nencoding: raw\n"
              "Segment0_ID:=Segment_1\nSegment0_Name:=bone\n"
              "Segment1_ID:=Segment_2\nSegment1_Name:=vessel\n\n" +
                  counting(24));
    for (int layer = 0; layer < 2; ++layer) {
        ReadOptions options;
        options.time_step = layer;
        const auto labels = read_volume(folder / "a.seg.nrrd", options).values.labels;
        ASSERT_EQ(labels.size(), 1U);
        EXPECT_EQ(labels[0].value, 1);
        EXPECT_EQ(labels[0].name, layer == 0 ? "bone" : "vessel");
    }
}

TEST(nrrd, headers_that_make_no_sense_are_refused) {
    const ScratchFolder folder;
    const std::string data = "encoding: raw\n\n" + counting(24);
    const auto refused = [&](const std::string& header) {
        return refusal_of(folder, "a.nrrd", header + data);
    };
    const std::string plain = plain_nrrd;
    EXPECT_TRUE(contains(refused(plain + "spacings: 1 -1 1\n"), "spacing of -1 mm"));
    EXPECT_TRUE(contains(refused(plain + "spacings: 1 0 1\n"), "spacing of 0 mm"));
    EXPECT_TRUE(contains(refused(plain + "spacings: 1 inf 1\n"), "spacing of inf mm"));
    EXPECT_TRUE(contains(refused(plain + "spacings: 1 a 1\n"), "not a list of numbers"));
    EXPECT_TRUE(contains(refused(plain + "space: left-posterior-superior\n"
                                         "space directions: (1,0,0) (0.5,1,0) (0,0,1)\n"),
                         "orthonormal"));
    EXPECT_TRUE(contains(refused(replaced(plain, "sizes: 2 3 4", "sizes: 100000 100000 100000")),
                         "header"));
    EXPECT_TRUE(contains(refused(replaced(plain, "sizes: 2 3 4", "sizes: 2 3 0")), "size 0"));
    EXPECT_TRUE(contains(refused(replaced(plain, "sizes: 2 3 4", "sizes: 2 3 -4")), "size -4"));
    EXPECT_TRUE(contains(refused(replaced(plain, "sizes: 2 3 4", "sizes: 2 3 5")),
                         "asks for 30 bytes of samples, there are 24"));
    EXPECT_TRUE(contains(refused(replaced(plain, "sizes: 2 3 4", "sizes: 2 12")), "do not agree"));
    EXPECT_TRUE(contains(refused(replaced(plain, "uint8", "block")), "sample type"));
    EXPECT_TRUE(contains(refused("NRRD0004\ntype: uint8\ndimension: 3\n"), "no field 'sizes'"));
    EXPECT_TRUE(contains(refusal_of(folder, "b.nrrd", plain + "encoding: bzip2\n\nxx"), "bzip2"));
    EXPECT_TRUE(contains(refusal_of(folder, "c.nhdr", plain + "encoding: raw\ndata file: no\n"),
                         "'no' cannot be read"));
    EXPECT_TRUE(contains(refusal_of(folder, "d.nrrd", plain), "within its header"));
}

TEST(nrrd, much_more_data_than_the_header_says_is_refused_a_little_is_said) {
    const ScratchFolder folder;
    const std::string head = std::string(plain_nrrd) + "spacings: 1 1 1\nencoding: raw\n\n";
    const VolumeFile file = read_bytes(folder, "a.nrrd", head + counting(24) + "\n");
    expect_counting(file);
    EXPECT_TRUE(contains(all_notes(file), "the rest was ignored"));
    EXPECT_TRUE(contains(refusal_of(folder, "a.nrrd", head + counting(24) + std::string(5000, 'x')),
                         "asks for 24 bytes"));
}

TEST(nrrd, time_steps_are_picked_wherever_their_axis_is) {
    const ScratchFolder folder;
    const std::string last =
        "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 2 3\nspacings: 1 1 1 0.5\nencoding: raw\n"
        "kinds: domain domain domain ";
    const std::string first =
        "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 2 2 2\nencoding: raw\n"
        "kinds: list domain domain domain\nspacings: nan 1 1 1\n\n";
    for (int step = 0; step < 3; ++step) {
        ReadOptions options;
        options.time_step = step;
        for (const char* kind : {"time\n\n", "list\n\n"}) {
            const VolumeFile a = read_bytes(folder, "a.nrrd", last + kind + counting(24), options);
            EXPECT_EQ(a.time_steps, 3);
            EXPECT_EQ(a.volume.sample({0, 0, 0}), 8 * step) << kind;
            EXPECT_EQ(a.volume.sample({1, 1, 1}), 8 * step + 7) << kind;
        }
        const VolumeFile b = read_bytes(folder, "b.nrrd", first + counting(24), options);
        EXPECT_EQ(b.time_steps, 3);
        EXPECT_EQ(b.volume.sample({0, 0, 0}), step);
        EXPECT_EQ(b.volume.sample({1, 1, 1}), 21 + step);
    }
    for (const int step : {-1, 3}) {
        ReadOptions options;
        options.time_step = step;
        EXPECT_TRUE(contains(refusal(folder / "b.nrrd", options), "it has 3"));
    }
    ReadOptions options;
    options.time_step = 1;
    put_bytes(folder / "c.nrrd", std::string(plain_nrrd) + "encoding: raw\n\n" + counting(24));
    EXPECT_TRUE(contains(refusal(folder / "c.nrrd", options), "it has 1"));
}

TEST(nrrd, a_time_axis_in_front_is_refused_and_not_taken_for_space) {
    const ScratchFolder folder;
    EXPECT_TRUE(contains(refusal_of(folder, "a.nrrd",
                                    "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 2 2 2\n"
                                    "encoding: raw\nkinds: time domain domain domain\n\n" +
                                        counting(24)),
                         "put it last"));
}

TEST(nrrd, vectors_and_colours_are_refused) {
    const ScratchFolder folder;
    for (const char* kind : {"vector", "3-color", "RGB-color"}) {
        EXPECT_TRUE(contains(refusal_of(folder, "a.nrrd",
                                        std::string("NRRD0004\ntype: uint8\ndimension: 4\n"
                                                    "sizes: 3 2 2 2\nencoding: raw\nkinds: ") +
                                            kind + " domain domain domain\n\n" + counting(24)),
                             "3 values a sample"))
            << kind;
    }
}

TEST(nrrd, other_types_become_one_that_is_kept_and_that_is_said) {
    const ScratchFolder folder;
    const auto read = [&](const std::string& type, const std::string& samples) {
        return read_bytes(folder, "a.nrrd",
                          "NRRD0004\ntype: " + type +
                              "\ndimension: 3\nsizes: 2 1 1\n"
                              "spacings: 1 1 1\nendian: little\nencoding: raw\n\n" +
                              samples);
    };
    const VolumeFile a = read("int8", "\xff\x05");
    EXPECT_EQ(a.volume.type(), SampleType::int16);
    EXPECT_EQ(a.volume.minimum(), -1);
    EXPECT_TRUE(contains(all_notes(a), "int8 became int16"));
    const auto check_float = [&](const std::string& type, const std::string& samples) {
        const VolumeFile b = read(type, samples);
        EXPECT_EQ(b.volume.type(), SampleType::float32) << type;
        EXPECT_EQ(b.volume.sample({0, 0, 0}), 70000) << type;
        EXPECT_EQ(b.volume.sample({1, 0, 0}), 3) << type;
        EXPECT_TRUE(contains(all_notes(b), "became float32")) << type;
    };
    check_float("int32", little<std::int32_t>(70000) + little<std::int32_t>(3));
    check_float("uint32", little<std::uint32_t>(70000) + little<std::uint32_t>(3));
    check_float("int64", little<std::int64_t>(70000) + little<std::int64_t>(3));
    check_float("uint64", little<std::uint64_t>(70000) + little<std::uint64_t>(3));
    check_float("double", little<double>(70000) + little<double>(3));
}

TEST(nrrd, samples_that_are_not_finite_are_replaced_and_counted) {
    const ScratchFolder folder;
    const std::string head =
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 1 1\nspacings: 1 1 1\nendian: little\n"
        "encoding: raw\n\n";
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const VolumeFile file = read_bytes(folder, "a.nrrd", head + little(nan) + little(4.5F));
    EXPECT_EQ(file.volume.minimum(), 4.5);
    EXPECT_TRUE(contains(all_notes(file), "1 sample was not finite"));
    EXPECT_TRUE(contains(refusal_of(folder, "a.nrrd", head + little(nan) + little(nan)), "finite"));
}

TEST(nrrd, the_spacing_option_wins) {
    const ScratchFolder folder;
    ReadOptions options;
    options.spacing = Vec3(0.5, 0.25, 2);
    const VolumeFile file = read_bytes(
        folder, "a.nrrd", std::string(plain_nrrd) + "encoding: raw\n\n" + counting(24), options);
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(0.5, 0.25, 2));
}

TEST(meta_image, headers_with_skips_and_text_are_read) {
    const ScratchFolder folder;
    const std::string spacing = "ElementSpacing = 1 2 3\n";
    put_bytes(folder / "a.raw", "1234567" + counting(24));
    for (const char* skip : {"7", "-1"}) {
        const VolumeFile file = read_bytes(
            folder, "a.mhd",
            plain_meta + spacing + "HeaderSize = " + skip + "\nElementDataFile = a.raw\n");
        expect_counting(file);
        EXPECT_EQ(file.volume.geometry().spacing, Vec3(1, 2, 3));
    }
    std::string text;
    for (int i = 0; i < 24; ++i) text += std::to_string(i) + " ";
    expect_counting(read_bytes(folder, "b.mha",
                               replaced(plain_meta, "BinaryData = True", "BinaryData = False") +
                                   spacing + "ElementDataFile = LOCAL\n" + text));
}

TEST(meta_image, headers_that_make_no_sense_are_refused) {
    const ScratchFolder folder;
    const std::string data = "ElementDataFile = LOCAL\n" + counting(24);
    const auto refused = [&](const std::string& header) {
        return refusal_of(folder, "a.mha", header + data);
    };
    const std::string plain = plain_meta;
    EXPECT_TRUE(contains(refused(plain + "ElementSpacing = 1 -1 1\n"), "spacing of -1 mm"));
    EXPECT_TRUE(contains(refused(plain + "ElementSpacing = 1 0 1\n"), "spacing of 0 mm"));
    EXPECT_TRUE(contains(refused(plain + "ElementSpacing = 1 nan 1\n"), "spacing"));
    EXPECT_TRUE(
        contains(refused(plain + "TransformMatrix = 1 0 0 0.5 1 0 0 0 1\n"), "orthonormal"));
    EXPECT_TRUE(contains(refused(plain + "ElementNumberOfChannels = 3\n"), "3 values a sample"));
    EXPECT_TRUE(contains(refused(replaced(plain, "2 3 4", "2 3 5")), "there are 24"));
    EXPECT_TRUE(contains(refused(replaced(plain, "2 3 4", "100000 100000 100000")), "header"));
    EXPECT_TRUE(contains(refused(replaced(plain, "MET_UCHAR", "MET_STRING")), "MET_STRING"));
    EXPECT_TRUE(contains(refused(replaced(plain, "NDims = 3", "NDims = 2")), "do not agree"));
    EXPECT_TRUE(contains(refusal_of(folder, "b.mhd", plain + "ElementDataFile = no.raw\n"),
                         "'no.raw' cannot be read"));
    EXPECT_TRUE(contains(refusal_of(folder, "c.mhd", plain + "ElementDataFile = LIST\na\nb\n"),
                         "'a' cannot be read"));
}

TEST(nifti, slope_and_intercept_are_applied_and_said) {
    const ScratchFolder folder;
    const VolumeFile plain =
        read_bytes(folder, "a.nii", nifti([](std::string& h) { put_at(h, 112, little(1.0F)); }));
    expect_counting(plain);
    EXPECT_EQ(plain.volume.type(), SampleType::int16);
    const VolumeFile scaled =
        read_bytes(folder, "a.nii",
                   nifti([](std::string& h) { put_at(h, 112, little(0.5F) + little(-3.0F)); }));
    EXPECT_EQ(scaled.volume.type(), SampleType::float32);
    EXPECT_EQ(scaled.volume.minimum(), -3);
    EXPECT_EQ(scaled.volume.maximum(), 8.5);
    EXPECT_TRUE(contains(all_notes(scaled), "slope"));
}

TEST(nifti, right_anterior_superior_becomes_left_posterior_superior) {
    const ScratchFolder folder;
    const VolumeFile file =
        read_bytes(folder, "a.nii", nifti([](std::string& h) {
                       put_at(h, 268, little(10.0F) + little(20.0F) + little(30.0F));
                   }));
    EXPECT_EQ(file.volume.geometry().origin, Vec3(-10, -20, 30));
    EXPECT_EQ(file.volume.geometry().direction, Mat3(Vec3(-1, -1, 1).asDiagonal()));
}

TEST(nifti, a_time_step_is_picked) {
    const ScratchFolder folder;
    ReadOptions options;
    options.time_step = 2;
    const VolumeFile file = read_bytes(folder, "a.nii", nifti([](std::string&) {}, 3), options);
    EXPECT_EQ(file.time_steps, 3);
    EXPECT_EQ(file.volume.minimum(), 48);
    EXPECT_EQ(file.volume.maximum(), 71);
    options.time_step = 3;
    EXPECT_TRUE(contains(refusal(folder / "a.nii", options), "it has 3"));
}

TEST(nifti, headers_that_make_no_sense_are_refused) {
    const ScratchFolder folder;
    const auto refused = [&](std::size_t at, const std::string& bytes) {
        return refusal_of(folder, "a.nii", nifti([&](std::string& h) { put_at(h, at, bytes); }));
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(contains(refused(84, little(nan)), "spacing"));
    EXPECT_TRUE(contains(refused(42, little<std::int16_t>(-2)), "not possible"));
    EXPECT_TRUE(contains(refused(42, little<std::int16_t>(30000)), "there are 48"));
    EXPECT_TRUE(contains(refused(70, little<std::int16_t>(128)), "colours"));
    EXPECT_TRUE(contains(refused(70, little<std::int16_t>(32)), "complex"));
    EXPECT_TRUE(contains(refused(108, little(-5.0F)), "samples at byte"));
    EXPECT_TRUE(contains(refused(108, little(347.0F)), "samples at byte"));
    EXPECT_TRUE(contains(refused(0, little<std::int32_t>(540)), "NIfTI-2"));
    EXPECT_TRUE(contains(refused(344, "ni1"), ".hdr/.img"));
    EXPECT_TRUE(contains(refused(344, "xyz"), "magic"));
}

TEST(nifti, samples_that_would_lie_within_the_header_are_taken_from_behind_it) {
    const ScratchFolder folder;
    for (const float place : {0.0F, 348.0F, 350.0F}) {
        const std::string whole = nifti([&](std::string& h) { put_at(h, 108, little(place)); });
        std::string without_extensions = whole;
        without_extensions.erase(348, 4);
        for (const std::string& bytes : {whole, without_extensions}) {
            const VolumeFile file = read_bytes(folder, "a.nii", bytes);
            expect_counting(file);
            EXPECT_TRUE(contains(all_notes(file), "within itself")) << all_notes(file);
        }
    }
}

std::string vti(const std::string& extent, const std::string& where, const std::string& components,
                int count) {
    std::string numbers;
    for (int i = 0; i < count; ++i) numbers += std::to_string(i) + " ";
    return "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<ImageData "
           "WholeExtent=\"" +
           extent + "\" Origin=\"1 2 3\" Spacing=\"2 2 2\"><Piece Extent=\"" + extent + "\"><" +
           where + "><DataArray type=\"Int16\" Name=\"a\" " + components + "format=\"ascii\">" +
           numbers + "</DataArray></" + where + "></Piece></ImageData></VTKFile>\n";
}

TEST(vti, an_extent_that_does_not_begin_at_zero_moves_the_origin) {
    const ScratchFolder folder;
    const VolumeFile file = read_bytes(folder, "a.vti", vti("5 6 0 2 -1 2", "PointData", "", 24));
    expect_counting(file);
    EXPECT_EQ(file.volume.geometry().origin, Vec3(11, 2, 1));
}

TEST(vti, samples_of_cells_lie_at_the_centres) {
    const ScratchFolder folder;
    const VolumeFile file = read_bytes(folder, "a.vti", vti("0 2 0 3 0 4", "CellData", "", 24));
    expect_counting(file);
    EXPECT_EQ(file.volume.geometry().origin, Vec3(2, 3, 4));
    EXPECT_TRUE(contains(all_notes(file), "centres"));
}

/// The same with other numbers and another type.
std::string vti_of(const std::string& type, const std::string& numbers) {
    std::string text = vti("0 2 0 0 0 0", "PointData", "", 0);
    text.replace(text.find("Int16"), 5, type);
    return text.insert(text.find("</DataArray>"), numbers);
}

TEST(vti, numbers_that_the_type_of_the_text_cannot_hold_are_refused) {
    const ScratchFolder folder;
    for (const auto& [type, least, greatest, below, above] :
         std::initializer_list<std::array<const char*, 5>>{
             {"Int8", "-128", "127", "-129", "128"},
             {"UInt8", "0", "255", "-1", "256"},
             {"Int16", "-32768", "32767", "-32769", "32768"},
             {"UInt16", "0", "65535", "-1", "65536"},
             {"UInt32", "0", "4294967295", "-1", "4294967296"}}) {
        const std::string fits = std::string(" 1\n+") + greatest + " " + least + "\n";
        const VolumeFile file = read_bytes(folder, "a.vti", vti_of(type, fits));
        EXPECT_EQ(file.volume.sample({0, 0, 0}), 1) << type;
        EXPECT_EQ(file.volume.sample({1, 0, 0}), static_cast<float>(std::stod(greatest))) << type;
        EXPECT_EQ(file.volume.sample({2, 0, 0}), std::stod(least)) << type;
        for (const char* number : {below, above}) {
            const std::string message =
                refusal_of(folder, "a.vti", vti_of(type, std::string("1 ") + number + " 3"));
            EXPECT_TRUE(contains(message, ", which its sample type cannot hold"))
                << type << ": " << message;
        }
    }
}

TEST(vti, what_stands_beside_the_numbers_of_an_array_is_not_taken_for_them) {
    const ScratchFolder folder;
    const std::string key =
        "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">1000</InformationKey>\n";
    const VolumeFile file = read_bytes(folder, "a.vti", vti_of("UInt8", "1 2 3" + key));
    EXPECT_EQ(file.volume.sample({2, 0, 0}), 3);
    EXPECT_TRUE(contains(refusal_of(folder, "a.vti", vti_of("UInt8", "1 2 300" + key)), "300"));
}

TEST(vti, text_with_more_numbers_than_samples_is_refused) {
    const ScratchFolder folder;
    for (const std::string type : {"UInt8", "Int32", "Float32", "Float64"}) {
        EXPECT_EQ(read_bytes(folder, "a.vti", vti_of(type, "1 2 3 ")).volume.sample({2, 0, 0}), 3);
        const std::string message = refusal_of(folder, "a.vti", vti_of(type, "1 2 3 4"));
        EXPECT_TRUE(contains(message, "more numbers than its piece has samples")) << message;
    }
    refusal_of(folder, "a.vti", vti("0 2 0 3 0 4", "CellData", "", 25));
}

TEST(vti, vectors_empty_grids_and_wrong_counts_are_refused) {
    const ScratchFolder folder;
    EXPECT_TRUE(
        contains(refusal_of(folder, "a.vti",
                            vti("0 1 0 2 0 3", "PointData", "NumberOfComponents=\"3\" ", 72)),
                 "3 values a sample"));
    refusal_of(folder, "a.vti", vti("0 1 0 2 0 3", "PointData", "", 20));
    refusal_of(folder, "a.vti", vti("0 -1 0 2 0 3", "PointData", "", 0));
    refusal_of(folder, "a.vti", vti("0 99999 0 99999 0 99999", "PointData", "", 24));
    EXPECT_TRUE(contains(
        refusal_of(folder, "a.vti", "<VTKFile type=\"PolyData\"><PolyData></PolyData></VTKFile>"),
        "not a VTI file"));
}

}  // namespace
}  // namespace palpate::io::test

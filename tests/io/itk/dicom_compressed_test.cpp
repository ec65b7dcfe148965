// Compressed DICOM: what the header declares is what the compressed image has, or the file is
// refused; no damage costs more memory than the declared size explains.
#include <sys/resource.h>
#include <zlib.h>

#include "dicom_transcoder.hpp"
#include "io/volume_dicom_slice.hpp"

namespace palpate::io::test {
namespace {

TestSlice smooth_slice(int frames = 1) {
    TestSlice slice;
    slice.columns = 40;
    slice.rows = 24;
    slice.frames = frames;
    for (int i = 0; i < 40 * 24 * frames; ++i) {
        slice.pixels.push_back(static_cast<std::uint16_t>(1000 + i % 40 * 7 + i / 40 * 5));
    }
    return slice;
}

/// The file with another number in an element of type US.
std::string with_number(std::string bytes, int element, int number) {
    DicomBytes before;
    before.number(0x28, static_cast<std::uint16_t>(element), 0);
    const auto at = bytes.find(before.bytes().substr(0, 8));
    return bytes.replace(at + 8, 2, little(static_cast<std::uint16_t>(number)));
}

/// [bytes] that any helper process so far has used at most.
double largest_helper() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

class Compressed : public testing::TestWithParam<Compression> {
  protected:
    std::string compressed(const TestSlice& slice) {
        put_slice(folder_ / "plain", slice);
        EXPECT_TRUE(compress_dicom(folder_ / "plain", file_, GetParam()));
        return bytes_of(file_);
    }
    std::string refusal_of(const std::string& bytes) {
        put_bytes(file_, bytes);
        const std::string message = refusal(file_);
        EXPECT_TRUE(one_line_about(message, file_)) << message;
        return message;
    }
    ScratchFolder folder_;
    std::filesystem::path file_ = folder_ / "a.dcm";
};

TEST_P(Compressed, samples_are_read_exactly_and_the_missing_checksum_is_said) {
    for (const int frames : {1, 3}) {
        const TestSlice slice = smooth_slice(frames);
        compressed(slice);
        const VolumeFile file = read_volume(file_);
        ASSERT_EQ(file.volume.geometry().size, Index3(40, 24, frames));
        for (std::size_t i = 0; i < slice.pixels.size(); ++i) {
            const auto k = static_cast<int>(i);
            ASSERT_EQ(file.volume.sample({k % 40, k / 40 % 24, k / 960}), slice.pixels[i]);
        }
        EXPECT_TRUE(contains(all_notes(file), "without a checksum")) << all_notes(file);
    }
}

TEST_P(Compressed, rows_and_columns_that_are_not_those_of_the_image_are_refused) {
    const std::string whole = compressed(smooth_slice());
    for (const int wrong : {1, 8, 23, 25, 39, 41, 64, 2000, 65535}) {
        for (const int element : {0x10, 0x11}) {
            const std::string message = refusal_of(with_number(whole, element, wrong));
            EXPECT_TRUE(contains(message, "its header says")) << message;
        }
    }
    EXPECT_TRUE(contains(refusal_of(with_number(whole, 0x100, 8)), "its header says"));
    EXPECT_TRUE(contains(refusal_of(with_number(whole, 2, 3)), "its header says"));
    if (GetParam() == Compression::rle) return;  // it counts pixels, it knows no rows
    EXPECT_TRUE(contains(refusal_of(with_number(with_number(whole, 0x10, 12), 0x11, 80)),
                         "its header says"));
}

TEST_P(Compressed, frames_that_are_missing_are_refused) {
    const std::string whole = compressed(smooth_slice(3));
    const auto at = whole.find(std::string("\x28\0\x08\0IS\2\0", 8));
    ASSERT_NE(at, std::string::npos);
    for (const char wrong : {'1', '2', '4', '9'}) {
        std::string bytes = whole;
        bytes[at + 8] = wrong;
        EXPECT_TRUE(contains(refusal_of(bytes), "a.dcm")) << wrong;
    }
}

TEST_P(Compressed, an_image_that_is_cut_off_is_refused) {
    const std::string whole = compressed(smooth_slice());
    // The last fragment: item, length, bytes; then the end of the sequence.
    const auto item = whole.rfind(std::string("\xfe\xff\x00\xe0", 4));
    std::uint32_t length = 0;
    std::memcpy(&length, whole.data() + item + 4, 4);
    for (const std::uint32_t less : {20U, length / 2}) {
        std::string bytes = whole.substr(0, item + 8 + length - less / 2 * 2);
        bytes.replace(item + 4, 4, little(length - less / 2 * 2));
        refusal_of(bytes + whole.substr(item + 8 + length));
    }
}

TEST_P(Compressed, flipped_bits_are_refused_or_give_the_declared_size_in_little_memory) {
    const std::string whole = compressed(smooth_slice());
    const auto pixels = whole.rfind(std::string("\xfe\xff\x00\xe0", 4));
    std::mt19937 random(51);
    int refused = 0;
    for (int i = 0; i < 150; ++i) {
        std::string bytes = whole;
        const std::size_t at = pixels + random() % (whole.size() - pixels);
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        put_bytes(file_, bytes);
        try {
            EXPECT_EQ(read_volume(file_).volume.geometry().size, Index3(40, 24, 1));
        } catch (const InputError& e) {
            EXPECT_TRUE(one_line_about(e.what(), file_)) << e.what();
            EXPECT_FALSE(contains(e.what(), ".c")) << e.what();
            ++refused;
        }
    }
    EXPECT_GT(refused, 5);
    EXPECT_LT(largest_helper(), 700e6);
}

INSTANTIATE_TEST_SUITE_P(dicom, Compressed,
                         testing::Values(Compression::jpeg_lossless, Compression::jpeg_ls,
                                         Compression::jpeg_2000, Compression::rle));

/// A part of a packed stream that refers to nothing before it, or the end of one.
std::string deflated_part(const std::string& bytes, int flush) {
    z_stream state{};
    deflateInit2(&state, 6, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY);
    std::string packed, out(1 << 16, '\0');
    state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    state.avail_in = static_cast<uInt>(bytes.size());
    do {
        state.next_out = reinterpret_cast<Bytef*>(out.data());
        state.avail_out = static_cast<uInt>(out.size());
        deflate(&state, flush);
        packed.append(out, 0, out.size() - state.avail_out);
    } while (state.avail_out == 0);
    deflateEnd(&state);
    return packed;
}

/// `bytes` with `zeros` behind them, packed; the zeros are never in memory together.
std::string deflated(const std::string& bytes, std::size_t zeros = 0) {
    if (zeros == 0) return deflated_part(bytes, Z_FINISH);
    std::string packed = deflated_part(bytes, Z_FULL_FLUSH);
    const std::string block = deflated_part(std::string(1 << 20, '\0'), Z_FULL_FLUSH);
    for (std::size_t i = 0; i < zeros; i += 1 << 20) packed += block;
    return packed + deflated_part({}, Z_FINISH);
}

std::string deflated_dicom(const TestSlice& slice) {
    return dicom_start(slice, "1.2.840.10008.1.2.1.99") + deflated(dicom_data_set(slice));
}

TEST(deflated_dicom, is_read_exactly_and_the_missing_checksum_is_said) {
    const ScratchFolder folder;
    const TestSlice slice = smooth_slice();
    put_bytes(folder / "a.dcm", deflated_dicom(slice));
    const VolumeFile file = read_volume(folder / "a.dcm");
    ASSERT_EQ(file.volume.geometry().size, Index3(40, 24, 1));
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(0.25, 0.5, 2.5));
    for (int i = 0; i < 960; ++i) {
        ASSERT_EQ(file.volume.sample({i % 40, i / 40, 0}),
                  slice.pixels[static_cast<std::size_t>(i)]);
    }
    EXPECT_TRUE(contains(all_notes(file), "(deflate) without a checksum")) << all_notes(file);
}

TEST(deflated_dicom, with_a_size_that_its_samples_do_not_have_is_refused) {
    const ScratchFolder folder;
    for (const int wrong : {1, 23, 25, 2000, 65535}) {
        const TestSlice slice = smooth_slice();
        put_bytes(folder / "a.dcm", dicom_start(slice, "1.2.840.10008.1.2.1.99") +
                                        deflated(with_number(dicom_data_set(slice), 0x10, wrong)));
        const std::string message = refusal(folder / "a.dcm");
        EXPECT_TRUE(contains(message, "its header asks for")) << message;
    }
}

TEST(deflated_dicom, damage_costs_no_more_memory_than_is_declared) {
    const ScratchFolder folder;
    TestSlice slice = smooth_slice();
    slice.columns = slice.rows = 512;
    slice.pixels.clear();
    std::mt19937 random(52);
    for (int i = 0; i < 512 * 512; ++i) {
        slice.pixels.push_back(static_cast<std::uint16_t>(random() % 64));
    }
    const std::string whole = deflated_dicom(slice);
    int refused = 0;
    for (int i = 0; i < 60; ++i) {
        std::string bytes = whole;
        const std::size_t begin = dicom_start(slice, "1.2.840.10008.1.2.1.99").size();
        const std::size_t at =
            begin + (i < 30 ? random() % 400 : random() % (whole.size() - begin));
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        put_bytes(folder / "a.dcm", bytes);
        try {
            EXPECT_EQ(read_volume(folder / "a.dcm").volume.geometry().size, Index3(512, 512, 1));
        } catch (const InputError& e) {
            EXPECT_TRUE(one_line_about(e.what(), folder / "a.dcm")) << e.what();
            ++refused;
        }
    }
    EXPECT_GT(refused, 20);
    for (const std::size_t length : {whole.size() - 1, whole.size() / 2, whole.size() / 2 + 1}) {
        put_bytes(folder / "a.dcm", whole.substr(0, length));
        EXPECT_TRUE(one_line_about(refusal(folder / "a.dcm"), folder / "a.dcm"));
    }
    EXPECT_LT(largest_helper(), 700e6);
}

TEST(deflated_dicom, bombs_cost_no_more_memory_than_is_declared) {
    const ScratchFolder folder;
    // 1 GB: a private element before the image, an image larger than it declares, one of a size
    // that is not declared, and zeros behind an image.
    const std::string start = dicom_start(smooth_slice(), "1.2.840.10008.1.2.1.99");
    DicomBytes element;
    element.long_value(9, 0x1001, "OB", "");
    put_bytes(folder / "a.dcm",
              start + deflated(element.bytes().substr(0, 8) + little(std::uint32_t{1} << 30),
                               std::size_t{1} << 30));
    EXPECT_TRUE(contains(refusal(folder / "a.dcm"), "unpack to more than its header asks for"));
    const std::string image = dicom_data_set(smooth_slice());
    const std::string data_set = image.substr(0, image.size() - 2 * 40 * 24 - 4);
    put_bytes(folder / "a.dcm",
              start + deflated(data_set + little(std::uint32_t{1} << 30), std::size_t{1} << 30));
    EXPECT_TRUE(contains(refusal(folder / "a.dcm"), "its header asks for 1920"));
    const std::string no_size = with_number(data_set, 0x10, 0);
    put_bytes(folder / "a.dcm",
              start + deflated(no_size + little(std::uint32_t{1} << 30), std::size_t{1} << 30));
    EXPECT_TRUE(contains(refusal(folder / "a.dcm"), "unpack to more than its header asks for"));
    put_bytes(folder / "a.dcm", start + deflated(image, std::size_t{1} << 30));
    EXPECT_TRUE(contains(refusal(folder / "a.dcm"), "unpack to more than its header asks for"));
    put_bytes(folder / "a.dcm", start + deflated(image, std::size_t{1} << 20));
    EXPECT_TRUE(contains(all_notes(read_volume(folder / "a.dcm")), "1048576 zero bytes after"));
    // Elements of no length, again and again: what is noted of each would be larger than it.
    for (const auto& [group, number] : {std::pair{0x28, 0x1053}, std::pair{0x6000, 0x22}}) {
        DicomBytes empty;
        empty.text(static_cast<std::uint16_t>(group), static_cast<std::uint16_t>(number), "LO", "");
        std::string many;
        for (int i = 0; i < 7 << 20; ++i) many += empty.bytes();
        put_bytes(folder / "a.dcm", start + deflated(many + image));
        EXPECT_TRUE(contains(refusal(folder / "a.dcm"), "again and again"));
    }
    EXPECT_LT(largest_helper(), 700e6);
}

}  // namespace
}  // namespace palpate::io::test

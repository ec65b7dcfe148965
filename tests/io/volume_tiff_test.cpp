// TIFF stacks: pages of one file, numbered slices of a folder, and what is refused of them.
#include <zlib.h>

#include <vector>

#include "volume_tiff_bytes.hpp"

namespace palpate::io::test {
namespace {

/// One page as our tests write it: one strip, little-endian.
TEST(tiff, pages_become_slices_plain_and_packed) {
    const ScratchFolder folder;
    for (const bool deflate : {false, true}) {
        std::vector<TestPage> pages;
        for (int z = 0; z < 5; ++z) pages.push_back(counting_page(12 * z));
        for (auto& page : pages) page.deflate = deflate;
        put_bytes(folder / "a.tif", tiff_bytes(pages));
        const VolumeFile file = read_volume(folder / "a.tif");
        ASSERT_EQ(file.volume.geometry().size, Index3(4, 3, 5));
        EXPECT_EQ(file.volume.geometry().spacing, Vec3::Ones());
        EXPECT_EQ(file.volume.type(), SampleType::uint8);
        for (int i = 0; i < 60; ++i) {
            EXPECT_EQ(file.volume.sample({i % 4, i / 4 % 3, i / 12}), i);
        }
        EXPECT_TRUE(contains(all_notes(file), "1 mm was taken")) << all_notes(file);
    }
}

TEST(tiff, a_strip_that_is_shorter_than_its_page_is_said_with_the_name_of_the_file) {
    const ScratchFolder folder;
    std::string bytes = tiff_bytes({counting_page(0)});
    const std::string entry =
        little<std::uint16_t>(279) + little<std::uint16_t>(4) + little<std::uint32_t>(1);
    const std::size_t at = bytes.find(entry);
    ASSERT_NE(at, bytes.npos);
    for (const std::uint32_t length : {12U, 6U, 0U}) {
        bytes.replace(at + entry.size(), 4, little(length));
        put_bytes(folder / "a.tif", bytes);
        const VolumeFile file = read_volume(folder / "a.tif");
        EXPECT_EQ(contains(all_notes(file), "'a.tif' does not say, or says wrongly, how long"),
                  length < 12)
            << all_notes(file);
    }
}

TEST(tiff, types_are_kept_and_the_spacing_option_is_taken) {
    const ScratchFolder folder;
    const auto read = [&](int bits, int format, const std::string& samples) {
        TestPage page;
        page.width = 2;
        page.height = 1;
        page.bits = bits;
        page.format = format;
        page.samples = samples;
        put_bytes(folder / "a.tiff", tiff_bytes({page}));
        ReadOptions options;
        options.spacing = Vec3(1, 2, 3);
        return read_volume(folder / "a.tiff", options);
    };
    const VolumeFile a = read(16, 1, little<std::uint16_t>(60000) + little<std::uint16_t>(1));
    EXPECT_EQ(a.volume.type(), SampleType::uint16);
    EXPECT_EQ(a.volume.maximum(), 60000);
    EXPECT_EQ(a.volume.geometry().spacing, Vec3(1, 2, 3));
    EXPECT_EQ(a.notes, std::vector<std::string>{});
    const VolumeFile b = read(16, 2, little<std::int16_t>(-7) + little<std::int16_t>(1));
    EXPECT_EQ(b.volume.type(), SampleType::int16);
    EXPECT_EQ(b.volume.minimum(), -7);
    const VolumeFile c = read(32, 3, little(0.25F) + little(-1.5F));
    EXPECT_EQ(c.volume.type(), SampleType::float32);
    EXPECT_EQ(c.volume.minimum(), -1.5);
    const VolumeFile d = read(32, 2, little<std::int32_t>(-70000) + little<std::int32_t>(5));
    EXPECT_EQ(d.volume.minimum(), -70000);
    EXPECT_TRUE(contains(all_notes(d), "int32 became float32"));
}

TEST(tiff, a_folder_of_slices_is_put_together_in_the_order_of_their_numbers) {
    const ScratchFolder folder;
    for (const int z : {10, 9, 8, 2, 1, 0, 7, 6, 5, 4, 3}) {
        put_bytes(folder / ("slice" + std::to_string(z) + ".tif"), tiff_bytes({counting_page(z)}));
    }
    const VolumeFile file = read_volume(folder.path());
    EXPECT_EQ(file.format, "TIFF slices");
    ASSERT_EQ(file.volume.geometry().size, Index3(4, 3, 11));
    for (int z = 0; z < 11; ++z) EXPECT_EQ(file.volume.sample({0, 0, z}), z);
    EXPECT_FALSE(contains(all_notes(file), "missing"));
    std::filesystem::remove(folder / "slice4.tif");
    EXPECT_TRUE(contains(refusal(folder.path()), "1 is missing"));
}

TEST(tiff, the_spacing_that_image_j_writes_is_taken) {
    const ScratchFolder folder;
    const auto read = [&](const std::string& description) {
        std::vector<TestPage> pages{counting_page(0), counting_page(12)};
        pages[0].description = description;
        pages[0].resolution[0] = 4000;  // four pixels a unit
        pages[0].resolution[1] = 1000;
        put_bytes(folder / "a.tif", tiff_bytes(pages));
        return read_volume(folder / "a.tif");
    };
    const auto spacing = [&](const std::string& description) {
        return read(description).volume.geometry().spacing;
    };
    const std::string head = "ImageJ=1.53t\nimages=2\nslices=2\n";
    EXPECT_EQ(spacing(head + "unit=mm\nspacing=1.5\nloop=false\n"), Vec3(0.25, 0.25, 1.5));
    EXPECT_EQ(spacing(head + "unit=cm\r\nspacing=-2\r\n"), Vec3(2.5, 2.5, 20));
    EXPECT_EQ(spacing(head + "unit=mm\n"), Vec3(0.25, 0.25, 1));  // it leaves out a 1
    for (const char* micron : {"micron", "um", "\xc2\xb5m", "\xb5m", "\\u00B5m", "\\u03bcm"}) {
        EXPECT_TRUE(
            spacing(head + "unit=" + micron + "\nspacing=3\n").isApprox(Vec3(25e-5, 25e-5, 3e-3)))
            << micron;
    }
    for (const char* angstrom : {"\xc3\x85", "\xc5", "\\u00c5", "\\u212B"}) {
        EXPECT_TRUE(
            spacing(head + "unit=" + angstrom + "\nspacing=4\n").isApprox(Vec3(25e-9, 25e-9, 4e-7)))
            << angstrom;
    }
    EXPECT_EQ(read(head + "unit=mm\nspacing=1.5\n").notes, std::vector<std::string>{});
    for (const std::string& flat :
         {head + "unit=mm\nspacing=0\n", head + "unit=mm\nspacing=wide\n",
          head + "unit=mm\nspacing=nan\n", std::string("ImageJ=1.53t\nunit=mm\n")}) {
        EXPECT_EQ(spacing(flat), Vec3(0.25, 0.25, 0.25)) << flat;
        EXPECT_TRUE(contains(all_notes(read(flat)), "that of pixels was taken")) << flat;
    }
    for (const std::string& silent :
         {std::string("unit=mm\nspacing=1.5\n"), std::string("a heart")}) {
        const VolumeFile file = read(silent);
        EXPECT_EQ(file.volume.geometry().spacing, Vec3::Ones()) << silent;
        EXPECT_TRUE(contains(all_notes(file), "1 mm was taken")) << silent;
    }
}

TEST(tiff, times_are_a_sequence) {
    const ScratchFolder folder;
    std::vector<TestPage> pages;
    for (int i = 0; i < 6; ++i) pages.push_back(counting_page(12 * i));
    const std::string head = "ImageJ=1.53t\nimages=6\nunit=mm\nspacing=2\n";
    for (const int frames : {6, 3, 2}) {
        pages[0].description = head + "slices=" + std::to_string(6 / frames) +
                               "\nframes=" + std::to_string(frames) + "\nfinterval=40\ntunit=ms\n";
        put_bytes(folder / "a.tif", tiff_bytes(pages));
        for (int step = 0; step < frames; ++step) {
            ReadOptions options;
            options.time_step = step;
            const VolumeFile file = read_volume(folder / "a.tif", options);
            EXPECT_EQ(file.time_steps, frames);
            EXPECT_DOUBLE_EQ(file.frame_interval, 0.04);
            ASSERT_EQ(file.volume.geometry().size[2], 6 / frames);
            EXPECT_EQ(file.volume.sample({0, 0, 0}), 12 * step * (6 / frames));
        }
    }
    pages[0].description = head + "frames=4\n";
    put_bytes(folder / "a.tif", tiff_bytes(pages));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "4 times, but has 6 pages"));
}

TEST(tiff, many_small_pages_are_slices_with_a_word_about_it) {
    const ScratchFolder folder;
    const std::vector<TestPage> pages(40, counting_page(0));
    put_bytes(folder / "a.tif", tiff_bytes(pages));
    const VolumeFile file = read_volume(folder / "a.tif");
    EXPECT_EQ(file.volume.geometry().size[2], 40);
    EXPECT_TRUE(contains(all_notes(file), "if they are moments")) << all_notes(file);
}

TEST(tiff, stacks_of_channels_and_stacks_that_lack_slices_are_refused) {
    const ScratchFolder folder;
    std::vector<TestPage> pages{counting_page(0), counting_page(12)};
    for (const auto& [text, reason] : std::initializer_list<std::pair<const char*, const char*>>{
             {"ImageJ=1.53t\nimages=2\nchannels=2\nunit=mm\nspacing=2\n", "2 channels"},
             {"ImageJ=1.53t\nimages=600\nslices=600\nunit=mm\nspacing=2\n", "600"}}) {
        pages[0].description = text;
        put_bytes(folder / "a.tif", tiff_bytes(pages));
        const std::string message = refusal(folder / "a.tif");
        EXPECT_TRUE(one_line_about(message, folder / "a.tif")) << message;
        EXPECT_TRUE(contains(message, reason)) << message;
    }
}

TEST(tiff, what_is_written_is_read_again_with_its_spacing) {
    const ScratchFolder folder;
    std::mt19937 random(54);
    for (const auto type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        for (const Index3& size : {Index3(1, 1, 1), Index3(7, 5, 1), Index3(700, 500, 3)}) {
            Geometry g = random_geometry(random, false, false);
            g.size = size;
            g.origin.setZero();
            const Volume volume = random_volume(random, type, g);
            for (const char* name : {"a.tif", "a.tiff"}) {
                WriteOptions options;
                options.compress = std::string(name) == "a.tiff";
                write_volume(volume, folder / name, options);
                const VolumeFile file = read_volume(folder / name);
                EXPECT_TRUE(same_samples(file.volume, volume)) << name_of(type) << " " << name;
                EXPECT_TRUE(file.volume.geometry().spacing.isApprox(g.spacing, 1e-6));
                EXPECT_EQ(file.notes, std::vector<std::string>{});
            }
        }
    }
    EXPECT_EQ(folder.names().size(), 2U);
}

TEST(tiff, thumbnails_are_left_out) {
    const ScratchFolder folder;
    TestPage thumbnail = counting_page(0);
    thumbnail.kind = 1;
    thumbnail.width = 2;
    thumbnail.height = 2;
    thumbnail.samples.resize(4);
    put_bytes(folder / "a.tif", tiff_bytes({counting_page(3), thumbnail, counting_page(5)}));
    EXPECT_EQ(read_volume(folder / "a.tif").volume.geometry().size, Index3(4, 3, 2));
}

TEST(tiff, colours_odd_bits_and_mixed_slices_are_refused) {
    const ScratchFolder folder;
    TestPage colours = counting_page(0);
    colours.width = 4;
    colours.height = 1;
    colours.samples_per_pixel = 3;
    put_bytes(folder / "a.tif", tiff_bytes({colours}));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "colours"));
    TestPage bits = counting_page(0);
    bits.bits = 24;
    put_bytes(folder / "a.tif", tiff_bytes({bits}));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "24 bits"));
    TestPage narrow = counting_page(0);
    narrow.width = 3;
    narrow.samples.resize(9);
    put_bytes(folder / "a.tif", tiff_bytes({counting_page(0), narrow}));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "slices of one kind"));
    TestPage huge = counting_page(0);
    huge.width = huge.height = 1000000;
    put_bytes(folder / "a.tif", tiff_bytes({huge}));
    EXPECT_TRUE(one_line_about(refusal(folder / "a.tif"), folder / "a.tif"));
}

TEST(tiff, truncated_and_flipped_files_are_refused_or_give_a_valid_volume) {
    const ScratchFolder folder;
    std::mt19937 random(51);
    TestPage page;
    page.width = 40;
    page.height = 30;
    for (int i = 0; i < 1200; ++i) page.samples += static_cast<char>(random() % 50);
    for (const bool deflate : {false, true}) {
        page.deflate = deflate;
        const std::string whole = tiff_bytes({page, page, page});
        put_bytes(folder / "a.tif", whole);
        ASSERT_EQ(read_volume(folder / "a.tif").volume.geometry().size[2], 3);
        for (int i = 0; i < 40; ++i) {
            std::string damaged = whole;
            const std::size_t at = 8 + random() % (whole.size() - 8);
            const bool cut = i % 2 == 0;
            if (cut) damaged.resize(at);
            if (!cut) damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
            put_bytes(folder / "a.tif", damaged);
            try {
                check(read_volume(folder / "a.tif").volume.geometry());
                EXPECT_FALSE(cut) << at << " of " << whole.size();
            } catch (const InputError& e) {
                EXPECT_TRUE(one_line_about(e.what(), folder / "a.tif")) << e.what();
            }
        }
    }
}

TEST(tiff, a_flipped_byte_of_packed_samples_is_refused) {
    const ScratchFolder folder;
    std::mt19937 random(52);
    TestPage page;
    page.width = 40;
    page.height = 30;
    page.deflate = true;
    for (int i = 0; i < 1200; ++i) page.samples += static_cast<char>(random() % 50);
    const std::string whole = tiff_bytes({page});
    const std::size_t packed = deflated(page.samples).size();
    for (int i = 0; i < 30; ++i) {
        std::string damaged = whole;
        const std::size_t at = 8 + random() % packed;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
        put_bytes(folder / "a.tif", damaged);
        EXPECT_TRUE(one_line_about(refusal(folder / "a.tif"), folder / "a.tif")) << at;
    }
}

TEST(tiff, an_orientation_that_is_not_applied_is_said_and_a_page_of_another_is_refused) {
    const ScratchFolder folder;
    TestPage first = counting_page(0), second = counting_page(12);
    put_bytes(folder / "a.tif", tiff_bytes({first, second}));
    EXPECT_FALSE(contains(all_notes(read_volume(folder / "a.tif")), "Orientation"));
    first.orientation = 4;  // the first row is at the bottom
    put_bytes(folder / "a.tif", tiff_bytes({first, second}));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "(Orientation 4)"));
    second.orientation = 4;
    put_bytes(folder / "a.tif", tiff_bytes({first, second}));
    const VolumeFile file = read_volume(folder / "a.tif");
    EXPECT_TRUE(contains(all_notes(file), "its Orientation 4 was not applied"));
    EXPECT_EQ(file.volume.sample({0, 0, 0}), 0);
}

TEST(tiff, noise_and_text_are_refused) {
    const ScratchFolder folder;
    std::mt19937 random(53);
    std::string noise = "II*";
    for (int i = 0; i < 3000; ++i) noise += static_cast<char>(random());
    for (const std::string& bytes : {std::string("a letter"), noise, std::string(1000, '\0')}) {
        put_bytes(folder / "a.tif", bytes);
        EXPECT_TRUE(one_line_about(refusal(folder / "a.tif"), folder / "a.tif"));
    }
}

}  // namespace
}  // namespace palpate::io::test

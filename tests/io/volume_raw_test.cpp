// Headerless files: read by the layout that the caller gives, or refused with both numbers.
#include <zlib.h>

#include <limits>

#include "palpate/io/raw_options.hpp"
#include "volume_support.hpp"

namespace palpate::io::test {
namespace {

std::string raw_bytes(const Volume& volume) {
    return {static_cast<const char*>(volume.data()), volume.bytes()};
}

ReadOptions options_for(const Volume& volume, std::uint64_t skip = 0) {
    ReadOptions options;
    options.raw = RawLayout{volume.geometry().size, volume.type(), volume.geometry().spacing, skip};
    return options;
}

TEST(raw_file, every_type_is_read_plain_packed_and_after_a_header) {
    const ScratchFolder folder;
    std::mt19937 random(21);
    for (const auto type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        Geometry g = random_geometry(random, false, false);
        g.origin.setZero();
        g.oriented = false;
        const Volume volume = random_volume(random, type, g);
        for (const std::string& header : {std::string(), std::string(37, 'h')}) {
            put_bytes(folder / "a.raw", header + raw_bytes(volume));
            put_gzip(folder / "a.raw.gz", header + raw_bytes(volume));
            for (const char* name : {"a.raw", "a.raw.gz"}) {
                const VolumeFile file =
                    read_volume(folder / name, options_for(volume, header.size()));
                EXPECT_TRUE(same_samples(file.volume, volume)) << name;
                EXPECT_EQ(file.volume.geometry(), g);
            }
        }
    }
}

TEST(raw_file, of_a_spacing_that_could_not_be_saved_is_refused) {
    const ScratchFolder folder;
    put_bytes(folder / "a.raw", std::string(8, 'x'));
    for (const double spacing : {1e-10, 1e10}) {
        ReadOptions options;
        options.raw = RawLayout{{2, 2, 2}, SampleType::uint8, Vec3(1, spacing, 1)};
        const std::string message = refusal(folder / "a.raw", options);
        EXPECT_TRUE(contains(message, "mm is outside 1e-9 to 1e9 mm")) << message;
        options.spacing = Vec3(1, 1e-9, 1e9);
        EXPECT_EQ(read_volume(folder / "a.raw", options).volume.geometry().spacing,
                  *options.spacing);
    }
}

TEST(raw_file, big_endian_samples_are_turned_round) {
    const ScratchFolder folder;
    std::mt19937 random(22);
    for (const auto type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        Geometry g = random_geometry(random, false, false);
        g.origin.setZero();
        const Volume volume = random_volume(random, type, g);
        std::string bytes = raw_bytes(volume);
        const std::size_t each = size_of(type);
        for (std::size_t at = 0; at < bytes.size(); at += each) {
            std::reverse(bytes.data() + at, bytes.data() + at + each);
        }
        put_bytes(folder / "a.raw", bytes);
        ReadOptions options = options_for(volume);
        options.raw->big_endian = true;
        EXPECT_TRUE(same_samples(read_volume(folder / "a.raw", options).volume, volume));
    }
}

TEST(raw_file, what_is_written_is_read_again_with_the_words_that_were_said) {
    const ScratchFolder folder;
    std::mt19937 random(23);
    Geometry g;
    g.size = Index3(61, 40, 300);  // more than one piece
    g.oriented = false;
    g.spacing = Vec3(0.1, 1, 2.5);
    for (const auto type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        const Volume volume = random_volume(random, type, g);
        double part = 0;
        WriteOptions options;
        options.progress = [&](double fraction) { part = fraction; };
        write_volume(volume, folder / "a.raw", options);
        EXPECT_EQ(part, 1);
        EXPECT_EQ(opening_words("a.raw", volume), " (open it with dims 61x40x300, type " +
                                                      std::string(name_of(type)) +
                                                      ", spacing 0.1,1,2.5)");
        ReadOptions read;
        read.raw = raw_layout_from("61x40x300", name_of(type), "0.1,1,2.5", 0);
        const VolumeFile file = read_volume(folder / "a.raw", read);
        EXPECT_TRUE(same_samples(file.volume, volume));
        EXPECT_EQ(file.volume.geometry(), g);
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.raw"});
    Geometry other;
    other.size = Index3(2, 2, 2);
    EXPECT_EQ(opening_words("a.nrrd", random_volume<float>(random, other)), "");
}

TEST(raw_file, given_up_or_without_room_it_leaves_what_was_there) {
    const ScratchFolder folder;
    std::mt19937 random(24);
    Geometry g;
    g.size = Index3(64, 64, 600);
    const Volume volume = random_volume<std::uint8_t>(random, g);
    put_bytes(folder / "a.raw", "before");
    WriteOptions options;
    options.progress = [](double fraction) {
        if (fraction > 0.5) throw std::runtime_error("given up");
    };
    EXPECT_THROW(write_volume(volume, folder / "a.raw", options), std::runtime_error);
    EXPECT_EQ(bytes_of(folder / "a.raw"), "before");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.raw"});
    std::filesystem::create_symlink("/dev/full", folder / "full.raw");
    const std::string full =
        message_of<OutputError>([&] { write_volume(volume, folder / "full.raw"); });
    EXPECT_TRUE(contains(full, "No space left")) << full;
}

TEST(raw_file, a_wrong_size_is_said_with_both_numbers) {
    const ScratchFolder folder;
    std::mt19937 random(22);
    Geometry g;
    g.size = Index3(10, 9, 8);
    const Volume volume = random_volume<std::int16_t>(random, g);
    const std::string bytes = raw_bytes(volume);
    for (const std::string& wrong : {bytes + "x", bytes.substr(1), std::string("x")}) {
        put_bytes(folder / "a.raw", wrong);
        put_gzip(folder / "a.gz", wrong);
        for (const char* name : {"a.raw", "a.gz"}) {
            const std::string message = refusal(folder / name, options_for(volume));
            EXPECT_TRUE(one_line_about(message, folder / name)) << message;
            EXPECT_TRUE(contains(message, std::to_string(wrong.size()))) << message;
            EXPECT_TRUE(contains(message, "1440")) << message;
        }
    }
}

TEST(raw_file, a_layout_that_makes_no_sense_is_refused) {
    const ScratchFolder folder;
    put_bytes(folder / "a.raw", "12345678");
    const auto with = [&](const Index3& size, const Vec3& spacing) {
        ReadOptions options;
        options.raw = RawLayout{size, SampleType::uint8, spacing, 0};
        return refusal(folder / "a.raw", options);
    };
    EXPECT_TRUE(contains(with({0, 1, 8}, Vec3::Ones()), "at least 1"));
    EXPECT_TRUE(contains(with({-2, -2, 2}, Vec3::Ones()), "at least 1"));
    EXPECT_TRUE(contains(with({100000, 100000, 100000}, Vec3::Ones()), "memory"));
    EXPECT_TRUE(contains(with({2000000000, 1, 1}, Vec3::Ones()), "1048576"));
    EXPECT_TRUE(contains(with({2, 2, 2}, Vec3(1, -1, 1)), "spacing"));
    EXPECT_TRUE(contains(with({2, 2, 2}, Vec3(1, NAN, 1)), "spacing"));
}

TEST(raw_file, a_damaged_gzip_is_refused) {
    const ScratchFolder folder;
    std::mt19937 random(23);
    Geometry g;
    g.size = Index3(20, 20, 20);
    const Volume volume = random_volume<std::uint8_t>(random, g);
    put_gzip(folder / "a.gz", raw_bytes(volume));
    const std::string whole = bytes_of(folder / "a.gz");
    for (int i = 0; i < 200; ++i) {
        std::string damaged = whole;
        const std::size_t at = 10 + random() % (whole.size() - 10);
        if (i % 2 == 0) {
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
        } else {
            damaged.resize(at);
        }
        put_bytes(folder / "a.gz", damaged);
        EXPECT_TRUE(one_line_about(refusal(folder / "a.gz", options_for(volume)), folder / "a.gz"));
    }
    put_bytes(folder / "a.gz", whole + "rubbish");
    EXPECT_TRUE(contains(refusal(folder / "a.gz", options_for(volume)), "something else"));
}

TEST(raw_file, samples_that_are_not_finite_become_the_least_finite_one) {
    const ScratchFolder folder;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const float samples[] = {3, nan, -2, infinity, -infinity, 7, 1, 0};
    const std::string bytes(reinterpret_cast<const char*>(samples), sizeof samples);
    put_bytes(folder / "a.raw", bytes);
    ReadOptions options;
    options.raw = RawLayout{{2, 2, 2}, SampleType::float32, Vec3::Ones(), 0};
    const VolumeFile file = read_volume(folder / "a.raw", options);
    EXPECT_EQ(file.volume.minimum(), -2);
    EXPECT_EQ(file.volume.maximum(), 7);
    EXPECT_EQ(file.volume.sample({1, 0, 0}), -2);
    EXPECT_TRUE(contains(all_notes(file), "3 samples were not finite"));
    put_bytes(folder / "a.raw", std::string(32, '\xff'));
    EXPECT_TRUE(contains(refusal(folder / "a.raw", options), "no sample is a finite number"));
}

TEST(raw_file, the_spacing_option_wins_and_a_folder_is_refused) {
    const ScratchFolder folder;
    put_bytes(folder / "a.raw", "12345678");
    ReadOptions options;
    options.raw = RawLayout{{2, 2, 2}, SampleType::uint8, Vec3::Ones(), 0};
    options.spacing = Vec3(1, 2, 3);
    EXPECT_EQ(read_volume(folder / "a.raw", options).volume.geometry().spacing, Vec3(1, 2, 3));
    EXPECT_TRUE(contains(refusal(folder.path(), options), "is a folder"));
}

}  // namespace
}  // namespace palpate::io::test

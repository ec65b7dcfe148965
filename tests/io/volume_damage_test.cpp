// Damaged input of every kind: an InputError with one helpful line, or a valid volume; never a
// crash, never wrong samples out of a compressed stream.
#include <unistd.h>
#include <zlib.h>

#include "palpate/io/mesh_file.hpp"
#include "volume_support.hpp"

namespace palpate::io::test {
namespace {

struct Kind {
    std::string extension;
    bool compress;
};

std::ostream& operator<<(std::ostream& out, const Kind& kind) {
    return out << kind.extension << (kind.compress ? " compressed" : "");
}

class Damage : public testing::TestWithParam<Kind> {
  protected:
    /// A whole file of this kind, and the volume in it.
    std::string whole(std::mt19937& random, const std::filesystem::path& path) {
        Geometry g = random_geometry(random, true, false);
        g.size = Index3(16, 15, 14);
        volume_ = random_volume<std::int16_t>(random, g);
        WriteOptions options;
        options.compress = GetParam().compress;
        write_volume(volume_, path, options);
        return bytes_of(path);
    }
    Volume volume_{Geometry{Index3::Ones()}, std::vector<std::uint8_t>{0}};
};

TEST_P(Damage, a_truncated_file_is_refused_whatever_its_length) {
    const ScratchFolder folder;
    std::mt19937 random(11);
    const auto path = folder / ("volume" + GetParam().extension);
    const std::string file = whole(random, path);
    std::vector<std::size_t> lengths = {
        1, 2, 10, 100, 300, 352, file.size() / 2, file.size() - 200, file.size() - 60};
    for (int i = 0; i < 6; ++i) lengths.push_back(1 + random() % (file.size() - 100));
    for (const std::size_t length : lengths) {
        put_bytes(path, file.substr(0, length));
        const std::string message = refusal(path);
        EXPECT_TRUE(one_line_about(message, path)) << length << ": " << message;
    }
}

TEST_P(Damage, flipped_bytes_are_refused_or_give_a_valid_volume) {
    const ScratchFolder folder;
    std::mt19937 random(12);
    const auto path = folder / ("volume" + GetParam().extension);
    const std::string file = whole(random, path);
    for (int i = 0; i < 40; ++i) {
        std::string flipped = file;
        // Half of them among the first bytes: that is where the header is.
        const std::size_t at =
            random() % (i % 2 == 0 ? std::min<std::size_t>(800, file.size()) : file.size());
        flipped[at] = static_cast<char>(flipped[at] ^ (1 << random() % 8));
        put_bytes(path, flipped);
        try {
            const VolumeFile read = read_volume(path);
            check(read.volume.geometry());
        } catch (const InputError& e) {
            EXPECT_TRUE(one_line_about(e.what(), path)) << at << ": " << e.what();
        }
    }
}

TEST_P(Damage, a_flipped_byte_of_compressed_samples_is_refused) {
    if (!GetParam().compress) GTEST_SKIP() << "nothing guards samples that are not compressed";
    const ScratchFolder folder;
    std::mt19937 random(13);
    const auto path = folder / ("volume" + GetParam().extension);
    const std::string file = whole(random, path);
    for (int i = 0; i < 20; ++i) {
        std::string flipped = file;
        const std::size_t at = file.size() / 4 + random() % (file.size() * 3 / 4 - 60);
        flipped[at] = static_cast<char>(flipped[at] ^ (1 << random() % 8));
        put_bytes(path, flipped);
        const std::string message = refusal(path);
        EXPECT_TRUE(one_line_about(message, path)) << at << ": " << message;
    }
}

TEST_P(Damage, an_empty_file_text_and_noise_are_refused) {
    const ScratchFolder folder;
    std::mt19937 random(14);
    const auto path = folder / ("volume" + GetParam().extension);
    std::string noise(5000, '\0');
    for (char& c : noise) c = static_cast<char>(random());
    for (const std::string& bytes :
         {std::string(), std::string("\n"), std::string("This is a letter, not a volume.\n"), noise,
          std::string(100000, '\0'), std::string(100000, 'a')}) {
        put_bytes(path, bytes);
        const std::string message = refusal(path);
        EXPECT_TRUE(one_line_about(message, path)) << message;
    }
}

INSTANTIATE_TEST_SUITE_P(formats, Damage,
                         testing::Values(Kind{".nrrd", false}, Kind{".nrrd", true},
                                         Kind{".mha", false}, Kind{".mha", true},
                                         Kind{".nii", false}, Kind{".nii.gz", true},
                                         Kind{".vti", false}, Kind{".vti", true}));

TEST(read_volume, says_what_is_wrong_with_a_path) {
    const ScratchFolder folder;
    EXPECT_TRUE(contains(refusal(folder / "missing.nrrd"), "does not exist"));
    EXPECT_TRUE(contains(refusal(""), "does not exist"));
    EXPECT_TRUE(contains(refusal("/dev/null"), "neither a file nor a folder"));
    EXPECT_TRUE(contains(refusal("HTTPS://host/v.zarr"), "is a web address"));
    EXPECT_TRUE(contains(refusal("ftp://host/v.zarr"), "begins with none of http://"));
    EXPECT_TRUE(contains(refusal("https:/host/v.zarr"), "two slashes behind the colon"));
    EXPECT_TRUE(contains(refusal(folder.path()), "no DICOM or TIFF slices"));
    std::filesystem::create_directory(folder / "inner");
    EXPECT_TRUE(contains(refusal(folder.path()), "give one of the folders in it"));
    put_bytes(folder / "volume.xyz", "something");
    EXPECT_TRUE(contains(refusal(folder / "volume.xyz"), "dims"));
    std::filesystem::create_symlink("circle", folder / "circle");
    EXPECT_TRUE(one_line_about(refusal(folder / "circle"), folder / "circle"));
}

TEST(read_volume, a_file_without_permission_is_refused) {
    if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
    const ScratchFolder folder;
    put_bytes(folder / "secret.nrrd", "NRRD0004\n");
    std::filesystem::permissions(folder / "secret.nrrd", std::filesystem::perms::none);
    EXPECT_TRUE(contains(refusal(folder / "secret.nrrd"), "permission"));
}

TEST(read_volume, samples_beside_a_header_without_permission_are_refused_as_such) {
    if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
    const ScratchFolder folder;
    std::mt19937 random(16);
    write_volume(random_volume<std::uint8_t>(random, random_geometry(random, false, false)),
                 folder / "a.nhdr");
    std::filesystem::permissions(folder / "a.raw", std::filesystem::perms::none);
    const std::string message = refusal(folder / "a.nhdr");
    EXPECT_TRUE(contains(message, "'a.raw' cannot be read (Permission denied)")) << message;
    EXPECT_TRUE(contains(message, "allow this user to read it")) << message;
}

TEST(read_volume, names_with_blanks_quotes_and_foreign_bytes_are_read) {
    const ScratchFolder folder;
    std::mt19937 random(15);
    const Volume volume =
        random_volume<std::uint8_t>(random, random_geometry(random, false, false));
    for (const char* name :
         {"a b.nrrd", "it's \"x\".mha", "\xc3\xa4\xff.nrrd", "-v.nii", "$x;y.vti"}) {
        write_volume(volume, folder / name);
        EXPECT_TRUE(same_samples(read_volume(folder / name).volume, volume)) << name;
    }
}

TEST(read_volume, extensions_may_be_in_capitals) {
    const ScratchFolder folder;
    std::mt19937 random(16);
    const Volume volume =
        random_volume<std::uint8_t>(random, random_geometry(random, false, false));
    write_volume(volume, folder / "a.nrrd");
    std::filesystem::rename(folder / "a.nrrd", folder / "A.NRRD");
    EXPECT_TRUE(same_samples(read_volume(folder / "A.NRRD").volume, volume));
}

TEST(volume_damage, the_address_that_git_lfs_leaves_in_place_of_a_file_is_named_as_such) {
    const ScratchFolder folder;
    for (const char* name : {"a.nii.gz", "a.nrrd", "a.dcm", "a.tif", "a.vti"}) {
        put_bytes(folder / name, "version https://git-lfs.github.com/spec/v1\noid sha256:4d\n");
        EXPECT_TRUE(contains(refusal(folder / name), "run git lfs pull")) << name;
    }
}

TEST(volume_damage, a_web_page_in_place_of_a_file_is_called_so) {
    const ScratchFolder folder;
    const std::string rest = "<head><title>Sign in</title></head><body></body></html>\n";
    const std::string page = "<html lang=\"en\">" + rest;
    const std::string pages[] = {
        page, "<!DOCTYPE html>\n" + page, "\xef\xbb\xbf\r\n  <!doctype HTML>" + page,
        "<?xml version=\"1.0\"?>\n<!-- served by a proxy -->\n<!DOCTYPE html PUBLIC \"\">" + page};
    for (const char* const name : {"a.vti", "a.tif", "a.nrrd", "a.nii.gz", "a.mha", "a.mrc",
                                   "a.vtk", "a.mgz", "a.dcm", "a.lsm", "scan"}) {
        for (const std::string& bytes : pages) {
            put_bytes(folder / name, bytes);
            EXPECT_TRUE(contains(refusal(folder / name), "is a web page (perhaps"))
                << name << bytes;
        }
    }
    for (const char* const name : {"a.stl", "a.ply", "a.obj", "a.vtp"}) {
        for (const std::string& bytes : pages) {
            put_bytes(folder / name, bytes);
            const auto message = message_of<InputError>([&] { (void)read_mesh(folder / name); });
            EXPECT_TRUE(contains(message, "is a web page (perhaps")) << name << bytes << message;
        }
    }
    put_bytes(folder / "a.vti", "<?xml version=\"1.0\"?>\n<!-- <html> -->\n<VTKFile type=\"odd\">");
    EXPECT_FALSE(contains(refusal(folder / "a.vti"), "web page"));
}

}  // namespace
}  // namespace palpate::io::test

// An image that several writers make chunk by chunk, in any order, is the one that
// convert_to_zarr() makes, to the byte.
#include "palpate/stream/growing_image.hpp"

#include <algorithm>
#include <map>

#include "io/volume_support.hpp"
#include "stream/store_support.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using support::bytes_of;
using support::ScratchFolder;

std::map<std::string, std::string> files_of(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) {
            files[fs::relative(entry.path(), folder).string()] = bytes_of(entry.path());
        }
    }
    return files;
}

std::vector<Index3> all_chunks(const GrowingImage& image, int level) {
    std::vector<Index3> chunks;
    const Index3 count = image.chunks(level);
    for (int z = 0; z < count[2]; ++z) {
        for (int y = 0; y < count[1]; ++y) {
            for (int x = 0; x < count[0]; ++x) chunks.emplace_back(x, y, z);
        }
    }
    return chunks;
}

TEST(GrowingImage, of_several_writers_in_any_order_is_that_of_convert_to_the_byte) {
    const ScratchFolder folder;
    std::mt19937 random(4);
    for (const int version : {2, 3}) {
        Geometry grid = io::test::random_geometry(random, true, false);
        grid.size = Index3(43, 20, 31);
        const Volume volume = io::test::random_volume(random, SampleType::int16, grid);
        const auto store = store_of(volume, "v");
        ConvertOptions options;
        options.zarr_version = version;
        options.chunk = 8;
        const std::string name = std::to_string(version);
        (void)convert_to_zarr(*store, 0, folder / (name + ".zarr"), options);

        const fs::path out = folder / (name + "-grown.zarr");
        const GrowingImage one(out, SampleType::int16, grid, options, ".part-1");
        const GrowingImage other(out, SampleType::int16, grid, options, ".part-2");
        one.write_metadata({});
        for (int level = 0; level < one.levels(); ++level) {
            std::vector<Index3> chunks = all_chunks(one, level);
            std::ranges::shuffle(chunks, random);
            for (const Index3& chunk : chunks) {
                const GrowingImage& image = random() % 2 == 0 ? one : other;
                const auto samples = level == 0 ? read_box(*store, 0, image.box(0, chunk))
                                                : image.means(level, chunk, {});
                image.write(level, chunk, samples);
                EXPECT_EQ(other.written(level, chunk), samples);
            }
        }
        one.write_metadata(Range{volume.minimum(), volume.maximum()});
        EXPECT_GT(one.levels(), 1);
        EXPECT_EQ(files_of(out), files_of(folder / (name + ".zarr")));
    }
}

TEST(GrowingImage, refuses_samples_of_another_box_and_leaves_no_file_of_bad_options) {
    const ScratchFolder folder;
    Geometry grid;
    grid.size = Index3(20, 20, 20);
    ConvertOptions options;
    options.chunk = 16;
    const GrowingImage image(folder / "v.zarr", SampleType::uint8, grid, options);
    const std::vector<std::byte> samples(std::size_t{16} * 16 * 16);
    EXPECT_THROW((void)image.write(0, {1, 0, 0}, samples), std::invalid_argument);
    EXPECT_THROW((void)image.write(0, {2, 0, 0}, {}), std::invalid_argument);
    for (const int level : {-1, image.levels()}) {
        EXPECT_THROW((void)image.box(level, {0, 0, 0}), std::out_of_range);
        EXPECT_THROW((void)image.write(level, {0, 0, 0}, samples), std::out_of_range);
    }
    EXPECT_THROW((void)image.means(0, {0, 0, 0}, {}), std::invalid_argument);
    options.chunk = 4;
    EXPECT_THROW(GrowingImage(folder / "w.zarr", SampleType::uint8, grid, options),
                 std::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace palpate::stream::test

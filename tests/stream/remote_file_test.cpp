// HDF5 and TIFF behind a server: read as those on the disk.
#include <gtest/gtest.h>

#include "stream/store_support.hpp"
#include "stream/volume_server.hpp"
#include "stream/written_files.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using support::contains;
using support::message_of;
using support::ScratchFolder;

void expect_same_store(const Store& here, const Store& there) {
    std::mt19937 random(3);
    EXPECT_EQ(here.info().format, there.info().format);
    EXPECT_EQ(here.info().channels, there.info().channels);
    EXPECT_EQ(here.info().times, there.info().times);
    ASSERT_EQ(here.info().levels.size(), there.info().levels.size());
    for (std::size_t l = 0; l < here.info().levels.size(); ++l) {
        const Geometry& grid = here.info().levels[l].geometry;
        EXPECT_EQ(grid, there.info().levels[l].geometry);
        const auto level = static_cast<int>(l);
        const SampleBox box = l == 0 ? whole_box(grid) : random_box(random, grid.size);
        EXPECT_EQ(read_box(here, level, box), read_box(there, level, box));
    }
}

std::string in_address(std::string name) {
    for (const auto& [c, escape] : {std::pair{"%", "%25"}, {"?", "%3F"}, {"#", "%23"}}) {
        for (std::size_t at = 0; (at = name.find(c, at)) != name.npos; at += 3) {
            name.replace(at, 1, escape);
        }
    }
    return name;
}

StoreOptions patient() {
    StoreOptions options;
    options.attempts = 10;
    return options;
}

TEST(RemoteFile, hdf5_and_tiff_are_read_where_a_server_tells_sizes_to_head_alone) {
    for (const auto& [folder, name] : {std::pair{"hdf5", "image.ims"}, {"tiff", "pages.tif"}}) {
        const fs::path& files = written_by(folder);
        const VolumeServer server({"--folder", files.string(), "--open-sizes"});
        expect_same_store(*open_store(files / name), *open_store(server.address(name), patient()));
        const std::string message =
            message_of<io::InputError>([&, missing = "no_" + std::string(name)] {
                (void)open_store(server.address(missing));
            });
        EXPECT_TRUE(contains(message, "does not exist")) << message;
    }
}

TEST(RemoteFile, hdf5_and_tiff_read_as_on_the_disk_although_answers_fail) {
    int files = 0;
    for (const fs::path& folder : {written_by("hdf5"), written_by("tiff")}) {
        const VolumeServer server(
            {"--folder", folder.string(), "--failures", "0.02", "--truncated", "0.02"});
        for (const char* name :
             {"image.ims", "lonely.h5", "missing.ims", "ims-4-gzip-u2.ims", "ims-16-lz4-u2.ims",
              "pages.tif", "pyramid.tif", "pyramid-TCZYX.ome.tif", "kind-0-u1.tif"}) {
            if (!fs::exists(folder / name)) continue;
            SCOPED_TRACE(name);
            const std::string address = server.address(name);
            ASSERT_TRUE(is_store(address) && is_chunked(address));
            const auto there = open_store(address, patient());
            EXPECT_EQ(there->info().address, address);
            expect_same_store(*open_store(folder / name), *there);
            EXPECT_GT(there->traffic().bytes, 0U);
            ++files;
        }
    }
    EXPECT_EQ(files, 9);
}

TEST(RemoteFile, names_with_escapes_a_query_and_a_fragment_are_found) {
    const ScratchFolder folder;
    fs::create_directories(folder.path() / "a folder");
    fs::copy_file(written_by("hdf5") / "image.ims",
                  folder.path() / "a folder" / "an image 50%.ims");
    const VolumeServer server({"--folder", folder.path().string()});
    const auto store =
        open_store(server.address("a%20folder/an%20image%2050%25.ims?version=1#top"));
    expect_same_store(*open_store(written_by("hdf5") / "image.ims"), *store);
}

/// A name without a query is no secret, and messages are no keys.
TEST(RemoteFile, names_with_characters_of_addresses_are_found_and_lead_back) {
    const ScratchFolder folder;
    const std::pair<fs::path, const char*> names[] = {
        {written_by("hdf5") / "image.ims", "what?.ims"},
        {written_by("hdf5") / "image.ims", "50%25#1?.ims"},
        {written_by("tiff") / "pyramid.tif", "what?now.tif"},
        {written_by("tiff") / "pyramid.tif", "a@b.tif"}};
    const VolumeServer server({"--folder", folder.path().string()});
    for (const auto& [from, name] : names) {
        SCOPED_TRACE(name);
        fs::copy_file(from, folder.path() / name);
        const auto here = open_store(from), there = open_store(server.address(in_address(name)));
        EXPECT_EQ(there->info().address, server.address(in_address(name)));
        expect_same_store(*here, *there);
        expect_same_store(*here, *open_store(there->info().address));
    }
}

TEST(RemoteFile, a_file_that_is_gone_has_no_missing_chunks) {
    const ScratchFolder folder;
    const VolumeServer server({"--folder", folder.path().string()});
    const fs::path file = folder.path() / "image.ims";
    for (const std::string& address : {file.string(), server.address("image.ims")}) {
        SCOPED_TRACE(address);
        fs::copy_file(written_by("hdf5") / "image.ims", file);
        const auto store = open_store(address);
        const SampleBox box = whole_box(store->info().levels[0].geometry);
        EXPECT_FALSE(read_box(*store, 0, box).empty());
        fs::remove(file);
        const std::string message =
            message_of<io::InputError>([&] { (void)read_box(*store, 0, box); });
        EXPECT_EQ(message,
                  address + ": is gone since it was opened; put it back, or open it again");
    }
}

TEST(RemoteFile, a_disk_cache_keeps_its_parts_until_the_file_is_another) {
    const ScratchFolder folder;
    fs::copy_file(written_by("hdf5") / "image.ims", folder.path() / "image.ims");
    const VolumeServer server({"--folder", folder.path().string()});
    StoreOptions options;
    options.cache_folder = folder.path() / "cache";
    options.cache_bytes = 1 << 24;
    const auto read = [&] {
        const auto store = open_store(server.address("image.ims"), options);
        expect_same_store(*open_store(folder.path() / "image.ims"), *store);
        return store->traffic();
    };
    const Traffic first = read(), second = read();
    EXPECT_GT(first.bytes, 1000U);
    EXPECT_GT(second.cached, first.cached);
    EXPECT_LE(second.bytes, 100U) << "its size and first bytes";
    fs::remove(folder.path() / "image.ims");
    fs::copy_file(written_by("hdf5") / "missing.ims", folder.path() / "image.ims");
    EXPECT_GT(read().bytes, 1000U);
}

/// The same samples in the same places, but for one byte in the middle.
void write_anew(const fs::path& file) {
    std::string bytes = support::bytes_of(file);
    bytes[bytes.size() / 2] ^= 1;
    const auto later = fs::last_write_time(file) + std::chrono::seconds(1);
    support::put_bytes(file, bytes);
    fs::last_write_time(file, later);
}

void replace(const fs::path& file) {
    const fs::path other = file.string() + ".new";
    fs::copy_file(file, other);
    write_anew(other);
    fs::rename(other, file);
}

TEST(RemoteFile, a_file_that_is_written_anew_while_it_is_read_is_an_error_here_and_there) {
    const ScratchFolder folder;
    const std::pair<const char*, fs::path> files[] = {{"image.ims", written_by("hdf5")},
                                                      {"pages.tif", written_by("tiff")}};
    const VolumeServer server({"--folder", folder.path().string()});
    for (const auto& [name, from] : files) {
        const fs::path file = folder.path() / name;
        fs::copy_file(from / name, file);
        for (const std::string& address : {file.string(), server.address(name)}) {
            for (const auto change : {write_anew, replace}) {
                SCOPED_TRACE(address);
                const auto store = open_store(address);
                const SampleBox box = whole_box(store->info().levels[0].geometry);
                const auto before = read_box(*store, 0, box);
                change(file);
                const std::string message =
                    message_of<io::InputError>([&] { (void)read_box(*store, 0, box); });
                EXPECT_TRUE(contains(message, "was written anew")) << message;
                EXPECT_EQ(read_box(*open_store(address), 0, box).size(), before.size());
            }
        }
    }
}

TEST(RemoteFile, what_cannot_be_read_is_one_line) {
    const ScratchFolder folder;
    const fs::path good = written_by("hdf5") / "image.ims";
    fs::copy_file(good, folder.path() / "cut.ims");
    fs::resize_file(folder.path() / "cut.ims", fs::file_size(good) / 2);
    support::put_bytes(folder.path() / "none.h5", "this is no HDF5");
    support::put_bytes(folder.path() / "none.tif", "nor is this TIFF");
    support::put_bytes(folder.path() / "empty.ims", "");
    const VolumeServer server({"--folder", folder.path().string()});
    const VolumeServer whole({"--folder", folder.path().string(), "--no-ranges"});
    const std::pair<std::string, const char*> wrong[] = {
        {server.address("cut.ims"), "damaged"},
        {server.address("none.h5"), "HDF5"},
        {server.address("none.tif"), "TIFF"},
        {server.address("empty.ims"), ""},
        {server.address("absent.ims"), "does not exist"},
        {whole.address("cut.ims"), "whole files only"}};
    for (const auto& pair : wrong) {
        const std::string& address = pair.first;
        const char* const what = pair.second;
        const std::string message = refusal(address);
        EXPECT_TRUE(message.starts_with(address)) << message;
        EXPECT_TRUE(contains(message, what)) << message;
        EXPECT_FALSE(contains(message, "\n")) << message;
    }
}

}  // namespace
}  // namespace palpate::stream::test

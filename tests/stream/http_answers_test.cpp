// What servers answer, checked before it is used: other parts than were asked for, compressed
// bodies, pages, endless ones; secrets in addresses; stopping while a store is opened.
#include <fstream>

#include "io/volume_support.hpp"
#include "stream/store_support.hpp"
#include "stream/volume_server.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

/// A Zarr array of 4 x 4 x 4 bytes in one shard with two chunks: 'u' below, 'v' above.
void put_shards(const fs::path& folder) {
    fs::create_directories(folder / "c/0/0");
    put_bytes(folder / "zarr.json",
              R"({"zarr_format":3,"node_type":"array","shape":[4,4,4],"data_type":"uint8",)"
              R"("chunk_grid":{"name":"regular","configuration":{"chunk_shape":[4,4,4]}},)"
              R"("chunk_key_encoding":{"name":"default"},"fill_value":0,"codecs":[)"
              R"({"name":"sharding_indexed","configuration":{"chunk_shape":[2,4,4],)"
              R"("codecs":[{"name":"bytes"}],"index_codecs":[{"name":"bytes"}]}}]})");
    const auto entry = [](std::uint64_t a, std::uint64_t b) {
        return io::test::little(a) + io::test::little(b);
    };
    put_bytes(folder / "c/0/0/0", std::string(5, '-') + std::string(32, 'u') +
                                      std::string(32, 'v') + entry(5, 32) + entry(37, 32));
}

/// A Zarr array of 4 x 4 x 4 bytes in two chunks; the second is not stored.
void put_chunk(const fs::path& folder, char value) {
    fs::create_directories(folder);
    put_bytes(folder / ".zarray",
              R"({"zarr_format":2,"shape":[4,4,4],"chunks":[2,4,4],"dtype":"|u1",)"
              R"("compressor":null,"fill_value":9,"order":"C","filters":null})");
    put_bytes(folder / "0.0.0", std::string(32, value));
}

StoreOptions patient_once() {
    StoreOptions options;
    options.timeout_s = 60;
    options.attempts = 1;
    return options;
}

/// A server of a folder with both.
struct Served {
    ScratchFolder folder;
    VolumeServer server;

    explicit Served(std::vector<std::string> options = {}) : server(with_folder(options)) {
        put_shards(folder / "s.zarr");
        put_chunk(folder / "c.zarr", 'x');
    }
    std::vector<std::string> with_folder(std::vector<std::string> options) const {
        options.insert(options.end(), {"--folder", folder.path().string()});
        return options;
    }
    Volume read(const std::string& name, const StoreOptions& options = patient_once()) const {
        return volume_of(*open_store(server.address(name), options));
    }
    std::string refusal(const std::string& name) const {
        return message_of<io::InputError>([&] { (void)read(name); });
    }
};

TEST(HttpAnswers, a_part_that_was_not_asked_for_is_refused) {
    const std::string message = Served({"--other-range"}).refusal("s.zarr");
    EXPECT_TRUE(contains(message, "which were not asked for")) << message;
}

TEST(HttpAnswers, the_end_of_a_file_is_read_by_its_place_where_a_server_knows_no_suffixes) {
    const Volume volume = Served({"--no-suffixes"}).read("s.zarr");
    EXPECT_EQ(volume.sample({0, 0, 0}), 'u');
    EXPECT_EQ(volume.sample({0, 0, 3}), 'v');
}

TEST(HttpAnswers, what_lies_compressed_on_the_server_is_unpacked) {
    const Volume volume = Served({"--gzip"}).read("c.zarr");
    EXPECT_EQ(volume.sample({0, 0, 0}), 'x');
    EXPECT_EQ(volume.sample({0, 0, 3}), 9);
}

TEST(HttpAnswers, a_chunk_that_is_forbidden_is_missing_only_if_the_caller_says_so) {
    const Served served({"--missing", "403"});
    const std::string message = served.refusal("c.zarr");
    EXPECT_TRUE(contains(message, "--forbidden-is-missing")) << message;
    StoreOptions options = patient_once();
    options.forbidden_is_missing = true;
    EXPECT_EQ(served.read("c.zarr", options).sample({0, 0, 3}), 9);
}

TEST(HttpAnswers, a_web_page_in_the_place_of_metadata_is_called_one) {
    const std::string message = Served({"--missing", "page"}).refusal("no.zarr");
    EXPECT_TRUE(contains(message, "web page")) << message;
}

TEST(HttpAnswers, of_an_endless_page_about_an_error_little_is_read) {
    const Served served({"--missing", "endless"});
    EXPECT_TRUE(contains(served.refusal("no.zarr"), "has no metadata"));
    const std::string get = std::string(PALPATE_ZARR_PYTHON) +
                            " -c \"import json, urllib.request as u; print(json.loads(" +
                            "u.urlopen('" + served.server.address("counts") +
                            "').read())['endless'])\" > " + (served.folder / "pieces").string();
    ASSERT_EQ(std::system(get.c_str()), 0);
    int pieces = 0;
    std::ifstream(served.folder / "pieces") >> pieces;
    // Several pages; what the sockets hold of each is a few megabytes.
    EXPECT_GT(pieces, 0);
    EXPECT_LT(pieces, 4000) << "more than 256 MB";
}

TEST(HttpAnswers, a_store_that_is_rewritten_with_the_same_metadata_does_not_meet_the_old_entries) {
    const Served served;
    StoreOptions options = patient_once();
    options.cache_folder = served.folder / "cache";
    options.cache_bytes = 1 << 20;
    EXPECT_EQ(served.read("c.zarr", options).sample({0, 0, 0}), 'x');
    put_chunk(served.folder / "new.zarr", 'y');  // another file, whatever the clock of the disk
    fs::rename(served.folder / "c.zarr", served.folder / "old.zarr");
    fs::rename(served.folder / "new.zarr", served.folder / "c.zarr");
    EXPECT_EQ(served.read("c.zarr", options).sample({0, 0, 0}), 'y');
    put_bytes(served.folder / "c.zarr/0.0.0", std::string(32, 'z'));
    EXPECT_EQ(served.read("c.zarr", options).sample({0, 0, 0}), 'y') << "from the cache";
    EXPECT_EQ(served.read("c.zarr?versionId=2", options).sample({0, 0, 0}), 'z');
}

TEST(HttpAnswers, messages_do_not_give_away_passwords_and_signatures) {
    for (const std::string& address :
         {std::string("http://me:secret@127.0.0.1:9/a.zarr?sig=secret"),
          std::string("http://secret@127.0.0.1:9/a.ims?secret")}) {
        const std::string message =
            message_of<io::InputError>([&] { (void)open_store(address, patient_once()); });
        EXPECT_TRUE(contains(message, "http://127.0.0.1:9/a.")) << message;
        EXPECT_FALSE(contains(message, "secret")) << message;
    }
    EXPECT_EQ(io::without_secrets("https://me:p@w@h.org/a?b=c: is no s3://k@b, or x@y?"),
              "https://h.org/a?...: is no s3://b, or x@y?");
    EXPECT_EQ(io::without_secrets("http://h.org"), "http://h.org");
    EXPECT_EQ(io::without_secrets("a://b@"), "a://");
}

struct Impatient {};

TEST(HttpAnswers, opening_a_store_of_a_silent_server_stops_when_asked_to) {
    const Served served;
    served.server.stop_answering();
    for (const char* name : {"c.zarr", "c.ims"}) {
        int calls = 0;
        const auto begin = std::chrono::steady_clock::now();
        const auto tell = [&](double) {
            if (++calls == 3) throw Impatient{};
        };
        EXPECT_THROW((void)open_store(served.server.address(name), patient_once(), tell),
                     Impatient);
        // It would wait for 60 s.
        EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
    }
}

}  // namespace
}  // namespace palpate::stream::test

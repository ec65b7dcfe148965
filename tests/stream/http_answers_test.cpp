// What servers answer, checked before it is used: other parts than were asked for, compressed
// bodies, pages, endless ones; secrets in addresses; stopping while a store is opened.
#include <dlfcn.h>
#include <netdb.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "io/volume_support.hpp"
#include "palpate/edit.hpp"
#include "palpate/stream/convert.hpp"
#include "palpate/stream/edits.hpp"
#include "palpate/stream/loader.hpp"
#include "stream/shards.hpp"
#include "stream/store_support.hpp"
#include "stream/volume_server.hpp"
#include "support/allocation_counter.hpp"
#include "support/eventually.hpp"

namespace palpate::stream::test {
namespace {

const std::string silent_name = "silent.invalid";
std::atomic<bool> asked_for_name{false}, answers_for_name{false};

}  // namespace

/// Takes the place of the system's function. Never answers for 20 s.
extern "C" int getaddrinfo(const char* name, const char* service, const addrinfo* hints,
                           addrinfo** result) {
    if (name == nullptr || name != silent_name) {
        static const auto system =
            reinterpret_cast<decltype(&::getaddrinfo)>(::dlsym(RTLD_NEXT, "getaddrinfo"));
        return system(name, service, hints, result);
    }
    asked_for_name = true;
    for (int i = 0; i < 20'000 && !answers_for_name; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    asked_for_name = false;
    return EAI_FAIL;
}

namespace {

namespace fs = std::filesystem;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

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

std::shared_ptr<const Samples> edits_of(const Store& store) {
    const ReadSamples read = [&](const SampleBox& box, std::span<std::byte> to) {
        store.read(0, box, to, {});
    };
    const auto empty = empty_samples(store, volume_of(store), 0);
    return edited(empty, edit::Fill{{{1, 1, 1}, {2, 2, 2}}, 5}, read).samples;
}

/// Edits of the store at an address, in a folder.
void save_edits_of(const std::string& address, const fs::path& out,
                   const StoreOptions& options = patient_once()) {
    const auto store = open_store(address, options);
    save_edits(*store, {address, options}, 0, *edits_of(*store), out, {});
}

/// Thrown to stop what waits.
struct Impatient {};

TEST(HttpAnswers, one_whose_headers_do_not_end_is_refused_and_costs_little) {
    const VolumeServer server({"--trailers"});
    StoreOptions options;
    options.timeout_s = 5;
    options.attempts = 1;
    expect_refusal("headers without end", server.address("c.zarr"), options);
}

TEST(HttpAnswers, one_that_comes_drop_by_drop_is_not_waited_for) {
    const VolumeServer server({"--drips"});
    StoreOptions options;
    options.timeout_s = 1;  // all of it would take hours
    options.attempts = 1;
    expect_refusal("Timeout was reached", server.address("c.zarr"), options);
}

TEST(HttpAnswers, a_part_that_was_not_asked_for_is_refused) {
    const std::string message = Served({"--other-range"}).refusal("s.zarr");
    EXPECT_TRUE(contains(message, "which were not requested")) << message;
}

TEST(HttpAnswers, the_end_of_a_file_is_read_by_its_place_where_a_server_knows_no_suffixes) {
    for (const char* kind : {"--no-suffixes", "--other-suffix"}) {
        const Served served({kind});
        StoreOptions options = patient_once();
        options.attempts = 3;
        const auto store = open_store(served.server.address("s.zarr"), options);
        const auto retries = [&] { return store->traffic().retries; };
        EXPECT_EQ(read_box(*store, 0, {{0, 0, 1}, {0, 0, 1}}), std::vector{std::byte{'v'}});
        const auto before = retries();
        EXPECT_EQ(before > 0, std::string(kind) == "--other-suffix");
        EXPECT_EQ(read_box(*store, 0, {{0, 0, 7}, {0, 0, 7}}), std::vector{std::byte{'u'}});
        EXPECT_EQ(retries(), before) << "it is known how to ask this server";
    }
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
    const fs::path saved = served.folder / "edits.zarr";
    save_edits_of(served.server.address("c.zarr"), saved, options);
    EXPECT_EQ(volume_of(*open_store(saved, patient_once())).sample({0, 0, 3}), 9)
        << "edits are opened as their original was";
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

TEST(HttpAnswers, in_the_cache_each_query_has_its_own_samples_however_it_is_signed) {
    const Served served;
    StoreOptions options = patient_once();
    options.cache_folder = served.folder / "cache";
    options.cache_bytes = 1 << 20;
    char sample = 'a';
    for (const std::string query :
         {"", "?generation=1", "?generation=2", "?snapshot=1", "?versionid=1", "?VersionId=2",
          "?dataset=1", "?dataset=2", "?st=1", "?st=2", "?expires=1", "?expires=2",
          "?tokens=1&dataset=2", "?dataset=1&part=2"}) {
        put_bytes(served.folder / "c.zarr/0.0.0", std::string(32, sample));
        EXPECT_EQ(served.read("c.zarr" + query, options).sample({0, 0, 0}), sample) << query;
        ++sample;
    }
    const auto kept = served.read("c.zarr?dataset=1", options).sample({0, 0, 0});
    for (const std::string end :
         {"&X-Amz-Signature=1&X-Amz-Date=2", "&x-goog-signature=3", "&Expires=1&Signature=2",
          "&AWSAccessKeyId=k", "&sv=1&st=2&se=3&sig=4", "&access_token=t", "&TOKEN=u"}) {
        EXPECT_EQ(served.read("c.zarr?dataset=1" + end, options).sample({0, 0, 0}), kept) << end;
    }
}

TEST(HttpAnswers, an_answer_for_which_there_is_no_memory_is_an_error_and_does_not_hang) {
    const Served served({"--long-tags"});
    const std::string address = served.server.address("c.zarr");
    int calls = 0;
    const auto tell = [&](double) {
        if (++calls == 1000) throw Impatient{};
    };
    const std::string message = message_of<io::InputError>([&] {
        const support::DeniedAllocations of_the_tag(5000, 12000);
        (void)open_store(address, patient_once(), tell);
    });
    EXPECT_TRUE(contains(message, "too little memory")) << message;
    EXPECT_EQ(volume_of(*open_store(address, patient_once())).sample({0, 0, 0}), 'x');
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
    EXPECT_EQ(io::without_secrets("(http://h.org/a?b=c,d;e)f&sig=g): of 'http://h.org/a?b'"),
              "(http://h.org/a?...): of 'http://h.org/a?...'");
    EXPECT_EQ(io::without_secrets("a://b@"), "a://");
}

TEST(HttpAnswers, opening_a_store_of_a_silent_server_stops_when_asked_to) {
    const Served served;
    const fs::path edits = served.folder / "e.zarr";
    save_edits_of(served.server.address("c.zarr"), edits);
    EXPECT_EQ(volume_of(*open_store(edits.string())).sample({1, 1, 1}), 5);
    served.server.stop_answering();
    for (const std::string& address :
         {served.server.address("c.zarr"), served.server.address("c.ims"), edits.string()}) {
        int calls = 0;
        const auto tell = [&](double) {
            if (++calls == 3) throw Impatient{};
        };
        StoreOptions options = patient_once();
        options.timeout_s = 1e6;  // it would wait for days
        EXPECT_THROW((void)open_store(address, options, tell), Impatient);
    }
}

TEST(HttpAnswers, writing_from_a_silent_server_stops_when_asked_to) {
    const Served served;
    StoreOptions options = patient_once();
    options.timeout_s = 1e6;  // it would wait for days
    const std::string address = served.server.address("c.zarr");
    const auto store = open_store(address, options);
    const auto samples = edits_of(*store);
    served.server.stop_answering();
    const fs::path out = served.folder / "out";
    int calls = 0;
    ConvertOptions convert;
    convert.progress = [&](double) {
        if (++calls % 3 == 0) throw Impatient{};
    };
    io::WriteOptions plain;
    plain.progress = convert.progress;
    for (const bool resumable : {true, false}) {
        convert.resumable = resumable;
        EXPECT_THROW((void)convert_to_zarr(*store, 0, out, convert), Impatient);
    }
    for (const char* name : {"a.raw", "a.nrrd", "a.mha"}) {
        EXPECT_THROW(write_plain(*store, 0, served.folder / name, plain), Impatient);
    }
    EXPECT_THROW(save_edits(*store, {address, options}, 0, *samples, served.folder / "e.zarr",
                            convert.progress),
                 Impatient);
    EXPECT_EQ(calls, 3 * 6);
}

TEST(HttpAnswers, a_server_of_names_that_never_answers_is_not_waited_for) {
    int calls = 0;
    const auto tell = [&](double) {
        if (asked_for_name && ++calls == 3) throw Impatient{};
    };
    EXPECT_THROW((void)open_store("http://" + silent_name + "/c.zarr", patient_once(), tell),
                 Impatient);
    EXPECT_TRUE(asked_for_name) << "it still waits, although we do not";
    answers_for_name = true;
    EXPECT_TRUE(support::comes_true([] { return !asked_for_name; }));
}

TEST(HttpAnswers, edits_do_not_keep_the_password_of_their_original_and_say_so) {
    const Served served;
    const fs::path edits = served.folder / "e.zarr";
    const std::string plain = served.server.address("c.zarr");
    save_edits_of("http://me:secret@" + plain.substr(7) + "?versionId=3&sig=secret", edits);
    const std::string note = support::bytes_of(edits / "palpate-edits.json");
    EXPECT_FALSE(contains(note, "=secret") || contains(note, ":secret")) << note;
    EXPECT_TRUE(contains(note, plain + "?versionId=3\"")) << note;
    const auto store = open_store(edits.string());
    EXPECT_EQ(volume_of(*store).sample({1, 1, 1}), 5);
    EXPECT_TRUE(std::ranges::any_of(store->info().notes, [](const std::string& words) {
        return contains(words, "without its password");
    }));
    fs::rename(served.folder / "c.zarr", served.folder / "hidden.zarr");
    const std::string message =
        message_of<io::InputError>([&] { (void)open_store(edits.string()); });
    EXPECT_TRUE(contains(message, "write the whole one into")) << message;
}

}  // namespace
}  // namespace palpate::stream::test

// Stores behind HTTP: slow, failing, cutting and lying servers, cancelling, and the disk cache.
#include <fcntl.h>

#include <chrono>
#include <thread>

#include "io/volume_support.hpp"
#include "palpate/io/address.hpp"
#include "stream/shards.hpp"
#include "stream/store_support.hpp"
#include "stream/volume_server.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

StoreOptions quick() {
    StoreOptions options;
    options.timeout_s = 2;
    return options;
}

void expect_formula(const Store& store, int level, const SampleBox& box) {
    const auto bytes = read_box(store, level, box);
    std::size_t at = 0, wrong = 0;
    for (int z = box.low[2]; z <= box.high[2]; ++z) {
        for (int y = box.low[1]; y <= box.high[1]; ++y) {
            for (int x = box.low[0]; x <= box.high[0]; ++x) {
                wrong +=
                    std::to_integer<int>(bytes[at++]) != virtual_sample(level, Index3(x, y, z));
            }
        }
    }
    EXPECT_EQ(wrong, 0U) << "level " << level;
}

/// Around a surface, over the border of chunks.
const SampleBox at_a_surface{Index3(120, 370, 380), Index3(140, 390, 390)};

TEST(Http, a_volume_of_a_terabyte_opens_and_gives_the_samples_of_its_formula) {
    const VolumeServer server;
    ASSERT_TRUE(is_store(server.address("virtual.zarr")));
    const auto store = open_store(server.address("virtual.zarr"), quick());
    const StoreInfo& info = store->info();
    EXPECT_EQ(info.format, "OME-Zarr 0.4");
    ASSERT_EQ(info.levels.size(), 8U);
    EXPECT_GT(static_cast<double>(sample_count(info.levels[0].geometry)), 1e12);
    EXPECT_TRUE(info.levels[0].geometry.spacing.isApprox(Vec3::Constant(1e-3)));
    EXPECT_TRUE(info.levels[3].geometry.origin.isApprox(Vec3::Constant(3.5e-3)));
    expect_formula(*store, 0, at_a_surface);
    expect_formula(*store, 2, {Index3(30, 90, 95), Index3(70, 100, 100)});
    expect_formula(*store, 7, {Index3(50, 50, 50), Index3(95, 80, 70)});
    EXPECT_GT(store->traffic().requests, 20U);
    EXPECT_GT(store->traffic().bytes, 1000U);
}

TEST(Http, a_scheme_is_written_in_letters_of_any_case) {
    const VolumeServer server;
    const std::string address = server.address("virtual.zarr");
    expect_formula(*open_store("HTTP" + address.substr(4)), 0, at_a_surface);
    for (const char* other : {"ftp://host/a.zarr", "http:/host/a.zarr", "S3:", "a/http://b", ""}) {
        EXPECT_FALSE(io::is_web_address(other)) << other;
    }
    EXPECT_TRUE(io::is_web_address("S3://bucket/a.zarr"));
}

TEST(Http, metadata_of_all_levels_are_asked_for_together) {
    // Asked for one after the other none would be answered.
    const VolumeServer server({"--levels-together", "8"});
    StoreOptions options;
    options.requests = 32;
    options.attempts = 1;
    EXPECT_EQ(open_store(server.address("virtual.zarr"), options)->info().levels.size(), 8U);
}

TEST(Http, failures_cut_bodies_and_wrong_bytes_are_asked_for_again) {
    const VolumeServer server(
        {"--failures", "0.1", "--truncated", "0.05", "--lies", "0.1", "--jitter", "5"});
    StoreOptions options = quick();
    options.attempts = 8;
    const auto store = open_store(server.address("virtual.zarr"), options);
    for (int i = 0; i < 20; ++i) {
        const Index3 shift(64 * i, 0, 0);
        expect_formula(*store, 0,
                       {at_a_surface.low + shift, at_a_surface.low + shift + Index3(5, 20, 10)});
    }
    EXPECT_GT(store->traffic().retries, 3U);
}

TEST(Http, several_threads_read_at_a_time_within_the_bound_on_requests) {
    // No chunk is answered before four are asked for; the delay would show a fifth.
    const VolumeServer server({"--delay", "20", "--chunks-together", "4"});
    StoreOptions options;
    options.requests = 4;
    const auto store = open_store(server.address("virtual.zarr"), options);
    const ScratchFolder folder;
    const std::string get =
        std::string(PALPATE_ZARR_PYTHON) + " -c \"import urllib.request as u; print(u.urlopen('" +
        server.address("counts") + "').read().decode())\" > " + (folder / "counts").string();
    {
        std::vector<std::jthread> threads;
        for (int t = 0; t < 10; ++t) {
            threads.emplace_back([&, t] {
                const Index3 low(768 * t + 120, 370, 380);
                expect_formula(*store, 0, {low, low + Index3(20, 4, 3)});
            });
        }
    }
    EXPECT_EQ(std::system(get.c_str()), 0);
    const std::string counts = support::bytes_of(folder / "counts");
    EXPECT_TRUE(contains(counts, "\"most_at_once\": 4,")) << counts;
}

TEST(Http, reading_stops_when_asked_to_while_the_server_is_silent) {
    const VolumeServer server;
    StoreOptions options;
    options.timeout_s = 3600;  // only the request to stop ends the wait
    const auto store = open_store(server.address("virtual.zarr"), options);
    server.stop_answering();
    std::vector<std::byte> out(1);
    std::stop_source source;
    const std::jthread stopper([&] {
        std::this_thread::sleep_for(100ms);  // so that it usually waits
        source.request_stop();
    });
    EXPECT_THROW(store->read(0, {Index3::Zero(), Index3::Zero()}, out, source.get_token()),
                 Cancelled);
}

TEST(Http, a_missing_chunk_is_fill_and_missing_metadata_an_error) {
    const ScratchFolder folder;
    fs::create_directories(folder / "a b.zarr");
    put_bytes(folder / "a b.zarr/.zarray",
              R"({"zarr_format":2,"shape":[4,4,4],"chunks":[2,4,4],"dtype":"|u1",)"
              R"("compressor":null,"fill_value":9,"order":"C","filters":null})");
    put_bytes(folder / "a b.zarr/0.0.0", std::string(32, 'x'));
    const VolumeServer server({"--folder", folder.path().string()});
    const auto store = open_store(server.address("a b.zarr"), quick());
    const Volume volume = volume_of(*store);
    EXPECT_EQ(volume.sample(Index3(0, 0, 0)), 'x');
    EXPECT_EQ(volume.sample(Index3(0, 0, 3)), 9);
    const std::string message = refusal(server.address("no.zarr"), quick());
    EXPECT_TRUE(contains(message, "has no metadata of Zarr")) << message;
    EXPECT_TRUE(contains(message, "download a file of another format")) << message;
}

TEST(Http, shards_are_read_in_parts_and_a_server_without_parts_is_refused) {
    const ScratchFolder folder;
    put_shards(folder / "s.zarr");
    const VolumeServer server({"--folder", folder.path().string()});
    const Volume volume = volume_of(*open_store(server.address("s.zarr"), quick()));
    EXPECT_EQ(volume.sample(Index3(0, 0, 0)), 'v');
    EXPECT_EQ(volume.sample(Index3(0, 0, 3)), 'u');
    const VolumeServer plain({"--folder", folder.path().string(), "--no-ranges"});
    const auto store = open_store(plain.address("s.zarr"), quick());
    const std::string message = message_of<io::InputError>([&] { (void)volume_of(*store); });
    EXPECT_TRUE(contains(message, "whole files only")) << message;
}

TEST(Http, shards_that_are_written_anew_after_their_index_was_read_are_noticed) {
    const ScratchFolder folder;
    const fs::path zarr = folder / "s.zarr";
    const VolumeServer server({"--folder", folder.path().string()});
    StoreOptions with_cache = quick();
    with_cache.cache_folder = folder / "cache";
    with_cache.cache_bytes = 1 << 20;
    const std::tuple<std::string, StoreOptions> ways[] = {{zarr.string(), {}},
                                                          {server.address("s.zarr"), quick()},
                                                          {server.address("s.zarr"), with_cache}};
    for (const auto& [address, options] : ways) {
        SCOPED_TRACE(address);
        put_shards(zarr);
        auto store = open_store(address, options);
        const auto sample = [&](int z) {
            return std::to_integer<char>(read_box(*store, 0, {{0, 0, z}, {0, 0, z}}).front());
        };
        EXPECT_EQ(sample(0), 'v');
        put_shards(zarr, false);
        fs::last_write_time(zarr / "c/0/0/0", fs::file_time_type::clock::now() + 1h);
        EXPECT_EQ(sample(2), 'u');
        EXPECT_EQ(sample(0), 'v');
        store = open_store(address, options);
        EXPECT_EQ(sample(2), 'u');
        if (!options.cache_folder.empty()) continue;  // holds all of one time
        // No chunk is stored any more.
        put_bytes(zarr / "c/0/0/0", io::test::little(~0ULL) + io::test::little(~0ULL) +
                                        io::test::little(~0ULL) + io::test::little(~0ULL));
        EXPECT_EQ(sample(2), 0);
    }
}

TEST(Http, endless_redirections_other_protocols_and_silent_hosts_are_errors_in_one_line) {
    const VolumeServer server;
    StoreOptions options = quick();
    options.attempts = 2;
    for (const std::string& address :
         {server.address("loop"), server.address("file"), std::string("http://127.0.0.1:9/a.zarr"),
          std::string("s3://")}) {
        const std::string message = refusal(address, options);
        EXPECT_TRUE(message.starts_with(address)) << message;
    }
}

StoreOptions cached(const fs::path& folder, std::uint64_t bytes) {
    StoreOptions options = quick();
    options.cache_folder = folder;
    options.cache_bytes = bytes;
    return options;
}

TEST(DiskCache, what_was_read_once_comes_from_the_disk_the_next_time) {
    const ScratchFolder folder;
    const VolumeServer server;
    const StoreOptions options = cached(folder / "cache", 100 << 20);
    expect_formula(*open_store(server.address("virtual.zarr"), options), 0, at_a_surface);
    const auto again = open_store(server.address("virtual.zarr"), options);
    const Traffic opened = again->traffic();
    expect_formula(*again, 0, at_a_surface);
    EXPECT_EQ(again->traffic().requests, opened.requests);
    EXPECT_EQ(again->traffic().cached, 8U);  // 2 chunks along each axis
}

TEST(DiskCache, damaged_entries_are_noticed_and_fetched_again) {
    const ScratchFolder folder;
    const VolumeServer server;
    const StoreOptions options = cached(folder / "cache", 100 << 20);
    expect_formula(*open_store(server.address("virtual.zarr"), options), 0, at_a_surface);
    std::mt19937 random(5);
    int damaged = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "cache")) {
        if (!entry.is_regular_file()) continue;
        std::string bytes = support::bytes_of(entry.path());
        if (damaged % 2 == 0) {
            bytes[random() % bytes.size()] ^= 0x11;
        } else {
            bytes.resize(random() % bytes.size());
        }
        put_bytes(entry.path(), bytes);
        ++damaged;
    }
    EXPECT_EQ(damaged, 8);
    const auto again = open_store(server.address("virtual.zarr"), options);
    expect_formula(*again, 0, at_a_surface);
    EXPECT_EQ(again->traffic().cached, 0U);
}

TEST(DiskCache, stays_within_its_bound_with_two_users_and_drops_what_was_not_used) {
    const ScratchFolder folder;
    const VolumeServer server({"--raw"});
    const std::uint64_t bound = 8 << 20;  // 32 raw chunks
    const StoreOptions options = cached(folder / "cache", bound);
    const auto one = open_store(server.address("virtual.zarr"), options);
    const auto two = open_store(server.address("virtual.zarr"), options);
    std::uint64_t most = 0;
    for (int i = 0; i < 60; ++i) {
        const Index3 at(64 * (i % 12), 64 * (i / 12), 384);
        (void)read_box(i % 2 == 0 ? *one : *two, 0, {at, at});
        most = std::max(most, bytes_in(folder / "cache"));
    }
    EXPECT_LE(most, bound);
    EXPECT_GT(most, bound / 2);
    EXPECT_EQ(one->traffic().cached + two->traffic().cached, 0U);
    (void)read_box(*one, 0, {Index3(64 * 11, 64 * 4, 384), Index3(64 * 11, 64 * 4, 384)});
    EXPECT_EQ(one->traffic().cached, 1U);  // the last one is still there
}

TEST(DiskCache, drops_first_what_a_clock_that_was_set_back_has_left_in_the_future) {
    const ScratchFolder folder;
    const VolumeServer server({"--raw"});
    const auto store =
        open_store(server.address("virtual.zarr"), cached(folder / "cache", 8 << 20));
    const auto read = [&](int i) {
        const Index3 at(64 * (i % 12), 64 * (i / 12), 384);
        (void)read_box(*store, 0, {at, at});
    };
    for (int i = 0; i < 24; ++i) read(i);
    for (const auto& entry : fs::recursive_directory_iterator(folder / "cache")) {
        if (entry.is_regular_file()) fs::last_write_time(entry, entry.last_write_time() + 24h);
    }
    for (int i = 24; i < 44; ++i) read(i);
    const std::uint64_t before = store->traffic().cached;
    for (int i = 36; i < 44; ++i) read(i);
    EXPECT_EQ(store->traffic().cached - before, 8U);
}

TEST(DiskCache, survives_processes_that_are_killed_while_they_use_it) {
    const ScratchFolder folder;
    const VolumeServer server;
    const StoreOptions options = cached(folder / "cache", 4 << 20);
    const std::string address = server.address("virtual.zarr");
    std::mt19937 times(12);
    const auto pieces = [&] {
        return fs::exists(folder / "cache")
                   ? std::distance(fs::recursive_directory_iterator(folder / "cache"), {})
                   : 0;
    };
    // On a slow machine a process may be killed before it has read anything.
    for (int round = 0; round < 8 || (pieces() < 60 && round < 100); ++round) {
        std::vector<pid_t> processes;
        for (int p = 0; p < 2; ++p) {
            const pid_t process = ::fork();
            if (process == 0) {
                const auto store = open_store(address, options);
                std::mt19937 random(static_cast<unsigned>(10 * round + p));
                while (true) {
                    const Index3 at(static_cast<int>(random() % 700),
                                    static_cast<int>(random() % 700), 384);
                    (void)read_box(*store, 0, {at, at});
                }
            }
            processes.push_back(process);
        }
        // The second goes on, and cleans up after the first, for some time.
        for (const pid_t process : processes) {
            std::this_thread::sleep_for(std::chrono::milliseconds(40 + times() % 200));
            ::kill(process, SIGKILL);
        }
        for (const pid_t process : processes) ::waitpid(process, nullptr, 0);
    }
    const auto store = open_store(address, options);
    // Every piece that may be there: what is damaged is removed and fetched.
    for (int y = 32; y < 704; y += 64) {
        for (int x = 32; x < 704; x += 64) {
            const Index3 at(x, y, 384);
            expect_formula(*store, 0, {at, at + Index3(1, 1, 1)});
        }
    }
    EXPECT_GT(store->traffic().cached, 20U);
    for (const std::string& name : folder.names()) EXPECT_EQ(name, "cache");
    for (const auto& entry : fs::directory_iterator(folder / "cache")) {
        EXPECT_FALSE(contains(entry.path().string(), ".part")) << entry.path();
    }
}

TEST(DiskCache, a_folder_that_cannot_be_written_is_no_error_but_noted) {
    const ScratchFolder folder;
    put_bytes(folder / "file", "x");
    const VolumeServer server;
    const auto notes_with = [&](const fs::path& cache) {
        const auto store = open_store(server.address("virtual.zarr"), cached(cache, 1 << 20));
        expect_formula(*store, 0, at_a_surface);
        std::vector<std::string> notes;
        for (const std::string& note : store->info().notes) {
            if (contains(note, cache.string())) notes.push_back(note);
        }
        return notes;
    };
    EXPECT_EQ(notes_with(folder / "cache").size(), 0U);
    const auto notes = notes_with(folder / "file/cache");
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_TRUE(contains(notes[0], "Not a directory")) << notes[0];
}

TEST(DiskCache, a_store_that_is_written_anew_does_not_meet_the_old_entries) {
    const ScratchFolder folder;
    const VolumeServer server({"--folder", folder.path().string()});
    const StoreOptions options = cached(folder / "cache", 1 << 20);
    const auto write = [&](char value, const std::string& comment) {
        fs::create_directories(folder / "a.zarr");
        put_bytes(folder / "a.zarr/.zarray",
                  R"({"zarr_format":2,"shape":[2,4,4],"chunks":[2,4,4],"dtype":"|u1",)"
                  R"("compressor":null,"fill_value":0,"order":"C","filters":null,"made":")" +
                      comment + "\"}");
        put_bytes(folder / "a.zarr/0.0.0", std::string(32, value));
    };
    write('a', "first");
    EXPECT_EQ(volume_of(*open_store(server.address("a.zarr"), options)).minimum(), 'a');
    write('b', "second");
    EXPECT_EQ(volume_of(*open_store(server.address("a.zarr"), options)).minimum(), 'b');
}

TEST(DiskCache, of_a_server_that_does_not_tell_of_changes_it_serves_one_session) {
    const ScratchFolder folder;
    const VolumeServer server({"--folder", folder.path().string(), "--no-tags"});
    fs::create_directories(folder / "a.zarr");
    put_bytes(folder / "a.zarr/.zarray",
              R"({"zarr_format":2,"shape":[2,4,4],"chunks":[2,4,4],"dtype":"|u1",)"
              R"("compressor":null,"fill_value":0,"order":"C","filters":null})");
    for (const char value : {'a', 'b'}) {
        put_bytes(folder / "a.zarr/0.0.0", std::string(32, value));
        const auto store = open_store(server.address("a.zarr"), cached(folder / "cache", 1 << 20));
        const auto is_told = [](const std::string& note) { return contains(note, "ETag"); };
        EXPECT_EQ(std::ranges::count_if(store->info().notes, is_told), 1);
        EXPECT_EQ(volume_of(*store).minimum(), value);
        EXPECT_EQ(volume_of(*store).minimum(), value);
        EXPECT_EQ(store->traffic().cached, 1U) << "it is read again";
    }
}

}  // namespace
}  // namespace palpate::stream::test

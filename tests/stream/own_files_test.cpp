// Palpate deletes and continues what it made itself, and nothing else: OUT.partial of others,
// links, other sources and settings, originals of edits.
#include <sys/stat.h>
#include <unistd.h>

#include <map>

#include "io/system/growing_folder.hpp"
#include "palpate/stream/convert.hpp"
#include "palpate/stream/edits.hpp"
#include "palpate/stream/loader.hpp"
#include "stream/formats/content.hpp"
#include "stream/objects/disk_cache.hpp"
#include "stream/store_support.hpp"
#include "support/edits.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using support::bytes_of;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;

Volume noise(std::uint64_t seed, SampleType type = SampleType::uint8) {
    return support::noise_of(type, support::grid({40, 30, 20}, {0.5, 0.6, 1}), seed);
}

ConvertOptions small_chunks() {
    ConvertOptions options;
    options.chunk = 8;
    options.threads = 1;
    return options;
}

struct Left {};

/// Begins a conversion and leaves it when all chunks are written.
void leave_behind(const Store& store, const fs::path& out,
                  ConvertOptions options = small_chunks()) {
    options.progress = [](double part) {
        if (part == 1) throw Left{};
    };
    EXPECT_THROW((void)convert_to_zarr(store, 0, out, options), Left);
    EXPECT_TRUE(fs::exists(out.string() + ".partial"));
}

std::string refusal(const Store& store, const fs::path& out) {
    return message_of<io::OutputError>(
        [&] { (void)convert_to_zarr(store, 0, out, small_chunks()); });
}

/// A store and edits of it, which are saved.
struct EditedOriginal {
    ScratchFolder folder;
    std::shared_ptr<const Store> store;
    std::shared_ptr<const Samples> edits;

    EditedOriginal() {
        put_original(1);
        store = open_store(folder / "v.zarr");
        const ReadSamples read = [&](const SampleBox& box, std::span<std::byte> to) {
            store->read(0, box, to, {});
        };
        const edit::Fill fill{{{3, 3, 3}, {9, 9, 9}}, 7};
        edits = edited(empty_samples(*store, noise(1), 0), fill, read).samples;
    }
    void put_original(std::uint64_t seed) const {
        fs::remove_all(folder / "v.zarr");
        (void)convert_to_zarr(*store_of(noise(seed), "v"), 0, folder / "v.zarr", small_chunks());
    }
    void save(const fs::path& out, const std::string& content = {}, bool is_rescue = false) const {
        save_edits(*store, {folder / "v.zarr", {}, content, is_rescue}, 0, *edits, out, {});
    }
    std::byte sample_in(const fs::path& saved) const {
        return read_box(*open_store(saved), 0, {{5, 5, 5}, {5, 5, 5}})[0];
    }
};

/// Every name below a folder, with the bytes of files.
std::map<std::string, std::string> all_in(const fs::path& folder) {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        all[entry.path().string()] =
            entry.is_regular_file() && !entry.is_symlink() ? bytes_of(entry.path()) : "";
    }
    return all;
}

using Makers = std::map<std::string, std::function<void(const fs::path&)>>;

/// Possible contents of OUT.partial. `ours`: one that was left behind.
Makers other_partials(const fs::path& precious, const fs::path& ours) {
    Makers all;
    all["folder"] = [](const fs::path& at) {
        fs::create_directory(at);
        put_bytes(at / "thesis.txt", "years");
    };
    all["empty"] = [](const fs::path& at) { fs::create_directory(at); };
    all["link"] = [=](const fs::path& at) { fs::create_directory_symlink(precious, at); };
    all["link to one of ours"] = [=](const fs::path& at) {
        fs::create_directory_symlink(ours, at);
    };
    all["broken link"] = [](const fs::path& at) { fs::create_symlink("/nowhere", at); };
    all["file"] = [](const fs::path& at) { put_bytes(at, "text"); };
    all["pipe"] = [](const fs::path& at) { ASSERT_EQ(::mkfifo(at.c_str(), 0600), 0); };
    const std::string marker = "palpate-partial.json";
    all["marker that is a link"] = [=](const fs::path& at) {
        fs::create_directory(at);
        fs::create_symlink(ours / marker, at / marker);
    };
    all["marker that is a pipe"] = [=](const fs::path& at) {
        fs::create_directory(at);
        ASSERT_EQ(::mkfifo((at / marker).c_str(), 0600), 0);
    };
    all["marker without a nonce"] = [=](const fs::path& at) {
        fs::create_directory(at);
        put_bytes(at / marker, R"({"palpate":"yes","job":""})");
    };
    all["note of earlier versions"] = [](const fs::path& at) {
        fs::create_directory(at);
        put_bytes(at / "palpate-convert.json", "{}");
    };
    return all;
}

TEST(OwnFiles, a_partial_that_palpate_did_not_make_is_refused_and_stays_as_it_is) {
    const ScratchFolder folder, precious;
    put_bytes(precious / "thesis.txt", "years");
    const auto store = store_of(noise(1), "v");
    leave_behind(*store, folder / "ours.zarr");
    const Makers others = other_partials(precious.path(), folder / "ours.zarr.partial");
    for (const auto& [name, make] : others) {
        SCOPED_TRACE(name);
        const fs::path out = folder / (name + ".zarr"), partial = out.string() + ".partial";
        make(partial);
        const auto before = all_in(folder.path()), there = all_in(precious.path());
        const std::string message = refusal(*store, out);
        EXPECT_TRUE(contains(message, partial.string())) << message;
        EXPECT_TRUE(contains(message, "give another name")) << message;
        EXPECT_EQ(all_in(folder.path()), before);
        EXPECT_EQ(all_in(precious.path()), there);
    }
}

TEST(OwnFiles, a_partial_of_other_work_with_a_foreign_file_in_it_is_refused_by_its_name) {
    const ScratchFolder folder;
    const fs::path out = folder / "v.zarr", partial = folder / "v.zarr.partial";
    leave_behind(*store_of(noise(1), "v"), out);
    put_bytes(partial / "notes.txt", "mine");
    const std::string message = refusal(*store_of(noise(2), "v"), out);
    EXPECT_TRUE(contains(message, "notes.txt")) << message;
    EXPECT_EQ(bytes_of(partial / "notes.txt"), "mine");
    EXPECT_TRUE(fs::exists(partial / "result/0/c/0/0/0"));
}

TEST(OwnFiles, a_link_inside_a_partial_of_ours_is_refused_and_never_followed) {
    const ScratchFolder folder, precious;
    put_bytes(precious / "thesis.txt", "years");
    const fs::path out = folder / "v.zarr", partial = folder / "v.zarr.partial";
    leave_behind(*store_of(noise(1), "v"), out);
    fs::create_directory_symlink(precious.path(), partial / "result/0/c/7");
    const Volume other = noise(2);
    const std::string message = refusal(*store_of(other, "v"), out);
    EXPECT_TRUE(contains(message, "result/0/c/7")) << message;
    EXPECT_EQ(bytes_of(precious / "thesis.txt"), "years");
    fs::remove(partial / "result/0/c/7");
    const Converted converted = convert_to_zarr(*store_of(other, "v"), 0, out, small_chunks());
    EXPECT_EQ(converted.kept, 0U);
    EXPECT_TRUE(contains(converted.note, "begun anew")) << converted.note;
    EXPECT_EQ(bytes_of(precious / "thesis.txt"), "years");
    expect_same_boxes(*open_store(out), other, 3);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"v.zarr"});
}

TEST(OwnFiles, a_foreign_file_at_any_depth_of_a_partial_stays) {
    const std::vector<std::string> places = {"thesis.txt",
                                             "result/thesis.txt",
                                             "result/0/thesis.txt",
                                             "result/0/c/0/0/0.txt",
                                             "work/thesis.txt",
                                             "result/2024/thesis.txt",
                                             "previous"};
    for (const std::string& place : places) {
        SCOPED_TRACE(place);
        const ScratchFolder folder;
        const fs::path out = folder / "v.zarr", partial = folder / "v.zarr.partial";
        leave_behind(*store_of(noise(1), "v"), out);
        fs::create_directories((partial / place).parent_path());
        put_bytes(partial / place, "years");
        const std::string message = refusal(*store_of(noise(2), "v"), out);
        // A folder that is not ours is named itself.
        const std::string named = contains(place, "2024") ? "result/2024" : place;
        EXPECT_TRUE(contains(message, named)) << message;
        EXPECT_EQ(bytes_of(partial / place), "years");
        // The same work goes on; what lies in its result goes with that.
        const Converted converted =
            convert_to_zarr(*store_of(noise(1), "v"), 0, out, small_chunks());
        if (place.starts_with("result/")) {
            EXPECT_EQ(bytes_of(out / place.substr(7)), "years");
            continue;
        }
        EXPECT_TRUE(contains(converted.note, place)) << converted.note;
        EXPECT_EQ(bytes_of(partial / place), "years");
        EXPECT_FALSE(fs::exists(partial / "palpate-partial.json"));
    }
}

TEST(OwnFiles, saving_edits_touches_no_partial_whoever_made_it) {
    const ScratchFolder precious;
    put_bytes(precious / "thesis.txt", "years");
    const EditedOriginal edits;
    const ScratchFolder& folder = edits.folder;
    for (const bool is_link : {false, true}) {
        const fs::path out = folder / (is_link ? "link.zarr" : "edits.zarr");
        const fs::path partial = out.string() + ".partial";
        if (is_link) {
            fs::create_directory_symlink(precious.path(), partial);
        } else {
            leave_behind(*store_of(noise(1), "v"), out);  // an interrupted conversion
        }
        const auto before = all_in(partial);
        edits.save(out);
        EXPECT_EQ(edits.sample_in(out), std::byte{7});
        EXPECT_EQ(all_in(partial), before);
    }
    EXPECT_EQ(bytes_of(precious / "thesis.txt"), "years");
    // Foreign files in a folder of edits stay there, also chunks that are not of the edits.
    for (const std::string place : {"notes.txt", "0/notes.txt", "2024/notes.txt", "0/c/notes.txt",
                                    "0/c/1/1/900", "5/c/0/0/0", ".palpate-12-3.part"}) {
        const fs::path file = folder / ("edits.zarr/" + place);
        fs::create_directories(file.parent_path());
        put_bytes(file, "mine");
        const std::string message =
            message_of<io::OutputError>([&] { edits.save(folder / "edits.zarr"); });
        EXPECT_TRUE(contains(message, place.substr(0, place.find('/')))) << message;
        EXPECT_EQ(bytes_of(file), "mine");
        fs::remove(file);
        if (place.starts_with("2024")) fs::remove(file.parent_path());
        if (place.starts_with("5")) fs::remove_all(folder / "edits.zarr/5");
    }
}

TEST(OwnFiles, a_folder_whose_note_of_edits_is_not_of_palpate_is_not_replaced) {
    const EditedOriginal edits;
    const ScratchFolder& folder = edits.folder;
    (void)convert_to_zarr(*edits.store, 0, folder / "other.zarr", small_chunks());
    put_bytes(folder / "other.zarr/palpate-edits.json", "");
    const auto before = all_in(folder / "other.zarr");
    EXPECT_THROW(edits.save(folder / "other.zarr"), io::OutputError);
    EXPECT_EQ(all_in(folder / "other.zarr"), before);
}

TEST(OwnFiles, an_interrupted_run_is_continued_for_the_same_content_only) {
    const ScratchFolder folder;
    const fs::path out = folder / "v.zarr";
    // In memory: the name is the same, the samples are not (another filter, series or time).
    leave_behind(*store_of(noise(1), "v"), out);
    EXPECT_GT(convert_to_zarr(*store_of(noise(1), "v"), 0, out, small_chunks()).kept, 0U);
    fs::remove_all(out);
    const Volume one = noise(1);
    const auto* const first = static_cast<const std::uint8_t*>(one.data());
    std::vector<std::uint8_t> samples(first, first + one.bytes());
    samples[samples.size() / 2] ^= 1;
    const Volume changed(one.geometry(), std::move(samples));
    leave_behind(*store_of(noise(1), "v"), out);
    EXPECT_EQ(convert_to_zarr(*store_of(changed, "v"), 0, out, small_chunks()).kept, 0U);
    expect_same_boxes(*open_store(out), changed, 4);
    fs::remove_all(out);
    // A file of the same size and of the same time.
    io::write_volume(noise(1), folder / "v.raw");
    StoreOptions options;
    options.raw = io::RawLayout{{40, 30, 20}, SampleType::uint8};
    leave_behind(*open_store(folder / "v.raw", options), out);
    const auto time = fs::last_write_time(folder / "v.raw");
    io::write_volume(noise(2), folder / "v.raw");
    fs::last_write_time(folder / "v.raw", time);
    const auto anew = open_store(folder / "v.raw", options);
    EXPECT_EQ(convert_to_zarr(*anew, 0, out, small_chunks()).kept, 0U);
    expect_same_boxes(*open_store(out), noise(2), 5);
}

TEST(OwnFiles, an_interrupted_run_is_continued_for_the_same_settings_only) {
    const ScratchFolder folder;
    const fs::path out = folder / "v.zarr";
    std::string bytes(std::size_t{2} * 40 * 30 * 20, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i / 7);
    put_bytes(folder / "v.raw", bytes);
    using Change = std::function<void(StoreOptions&, ConvertOptions&)>;
    const std::map<std::string, Change> changes = {
        {"byte order", [](StoreOptions& s, ConvertOptions&) { s.raw->big_endian = true; }},
        {"type", [](StoreOptions& s, ConvertOptions&) { s.raw->type = SampleType::int16; }},
        {"spacing", [](StoreOptions& s, ConvertOptions&) { s.spacing = Vec3(1, 1, 2); }},
        {"size",
         [](StoreOptions& s, ConvertOptions&) {
             s.raw->size = {30, 40, 20};
         }},
        {"version", [](StoreOptions&, ConvertOptions& c) { c.zarr_version = 2; }},
        {"chunk", [](StoreOptions&, ConvertOptions& c) { c.chunk = 16; }},
        {"compression",
         [](StoreOptions&, ConvertOptions& c) { c.compression = Compression::none; }}};
    for (const auto& [name, change] : changes) {
        SCOPED_TRACE(name);
        StoreOptions store;
        store.raw = io::RawLayout{{40, 30, 20}, SampleType::uint16};
        leave_behind(*open_store(folder / "v.raw", store), out);
        ConvertOptions convert = small_chunks();
        change(store, convert);
        const auto source = open_store(folder / "v.raw", store);
        EXPECT_EQ(convert_to_zarr(*source, 0, out, convert).kept, 0U);
        expect_same_boxes(*open_store(out), volume_of(*source), 6);
        fs::remove_all(out);
    }
}

TEST(OwnFiles, edits_do_not_open_over_another_volume_in_the_originals_place) {
    const EditedOriginal edits;
    const fs::path out = edits.folder / "e.zarr";
    edits.save(out);
    edits.put_original(2);
    expect_refusal("holds other data", out);
    edits.put_original(1);  // made anew, the same: a copy on another disk must do
    EXPECT_EQ(edits.sample_in(out), std::byte{7});
}

TEST(OwnFiles, edits_of_an_original_that_was_replaced_meanwhile_are_only_rescued) {
    const EditedOriginal edits;
    const fs::path out = edits.folder / "e.zarr";
    const std::string content = content_below_edits(*edits.store, 0);
    edits.put_original(2);
    const std::string message = message_of<io::OutputError>([&] { edits.save(out, content); });
    EXPECT_TRUE(contains(message, "was replaced since it was opened")) << message;
    EXPECT_FALSE(fs::exists(out));
    edits.save(out, content, true);
    EXPECT_THROW((void)open_store(out), io::InputError);
    edits.put_original(1);
    EXPECT_EQ(edits.sample_in(out), std::byte{7});
}

TEST(OwnFiles, a_pipe_or_a_link_at_the_name_of_a_chunk_neither_hangs_nor_leads_elsewhere) {
    const ScratchFolder folder, precious;
    put_bytes(precious / "thesis.txt", "years");
    const Volume volume = noise(1);
    const fs::path out = folder / "v.zarr", chunks = folder / "v.zarr.partial/result/0/c/0/0";
    leave_behind(*store_of(volume, "v"), out);
    fs::remove(chunks / "0");
    ASSERT_EQ(::mkfifo((chunks / "0").c_str(), 0600), 0);
    ASSERT_EQ(::mkfifo((chunks / "0.part").c_str(), 0600), 0);
    fs::remove(chunks / "1");
    fs::create_symlink(precious / "thesis.txt", chunks / "1");
    fs::create_symlink(precious / "thesis.txt", chunks / "1.part");
    EXPECT_GT(convert_to_zarr(*store_of(volume, "v"), 0, out, small_chunks()).kept, 0U);
    const DiskCache cache(folder / "cache", 1 << 20);
    cache.put("a", Bytes(100));
    for (const auto& entry : fs::recursive_directory_iterator(folder / "cache")) {
        if (!entry.is_regular_file()) continue;
        fs::remove(entry.path());
        ASSERT_EQ(::mkfifo(entry.path().c_str(), 0600), 0);
    }
    EXPECT_FALSE(cache.find("a"));
    expect_same_boxes(*open_store(out), volume, 3);
    EXPECT_EQ(bytes_of(precious / "thesis.txt"), "years");
}

/// A volume whose folder of results goes while it is read.
class Disturbing : public Store {
  public:
    Disturbing(std::shared_ptr<const Store> of, int at, std::function<void()> disturb)
        : of_(std::move(of)), at_(at), disturb_(std::move(disturb)) {}
    const StoreInfo& info() const override { return of_->info(); }
    Traffic traffic() const override { return {}; }
    void read(int level, const SampleBox& box, std::span<std::byte> out,
              std::stop_token stop) const override {
        if (box.high[0] < 8 && reads_++ == at_) disturb_();  // not when its content is looked at
        of_->read(level, box, out, std::move(stop));
    }

  private:
    std::shared_ptr<const Store> of_;
    int at_;
    std::function<void()> disturb_;
    mutable int reads_ = 0;
};

TEST(OwnFiles, a_conversion_whose_folder_goes_meanwhile_ends_with_a_line) {
    const std::map<std::string, std::function<void(const fs::path&)>> disturbances = {
        {"removed", [](const fs::path& partial) { fs::remove_all(partial); }},
        {"renamed", [](const fs::path& partial) { fs::rename(partial, partial.string() + "2"); }},
        {"emptied", [](const fs::path& partial) { fs::remove_all(partial / "result"); }},
        {"chunks removed",
         [](const fs::path& partial) {
             for (const auto& chunk : fs::directory_iterator(partial / "result/0/c"))
                 fs::remove_all(chunk);
         }},
        {"replaced", [](const fs::path& partial) {
             fs::rename(partial, partial.string() + "2");
             fs::copy(partial.string() + "2", partial, fs::copy_options::recursive);
         }}};
    for (const auto& [name, disturb] : disturbances) {
        SCOPED_TRACE(name);
        const ScratchFolder folder;
        const fs::path out = folder / "v.zarr";
        const Disturbing store(store_of(noise(1), "v"), 7,
                               [&, disturb = disturb] { disturb(out.string() + ".partial"); });
        const std::string message = refusal(store, out);
        EXPECT_TRUE(contains(message, "run it again")) << message;
        EXPECT_FALSE(fs::exists(out));
    }
}

TEST(OwnFiles, a_conversion_whose_folder_is_moved_writes_nothing_into_the_one_in_its_place) {
    const ScratchFolder folder;
    const fs::path out = folder / "v.zarr", partial = folder / "v.zarr.partial";
    const auto disturb = [&] {
        fs::rename(partial, folder / "moved");
        fs::create_directories(partial / "result/0/c");
    };
    const std::string message = refusal(Disturbing(store_of(noise(1), "v"), 2, disturb), out);
    EXPECT_TRUE(contains(message, "run it again")) << message;
    EXPECT_TRUE(fs::is_empty(partial / "result/0/c"));
    EXPECT_TRUE(fs::exists(folder / "moved/result/0/c/0/0/0"));
}

TEST(OwnFiles, paths_that_are_not_utf8_are_written_and_read_again) {
    const ScratchFolder folder;
    const fs::path here = folder / "caf\xe9", there = folder / "th\xe9";
    fs::create_directory(here);
    const Volume volume = noise(1);
    io::write_volume(volume, here / "v\xff.raw");
    StoreOptions options;
    options.raw = io::RawLayout{{40, 30, 20}, SampleType::uint8};
    const std::string address = (here / "v\xff.raw").string();
    const auto original = open_store(address, options);
    const auto edits = edited(
        empty_samples(*original, volume, 0), edit::Fill{{{3, 3, 3}, {9, 9, 9}}, 7},
        [&](const SampleBox& box, std::span<std::byte> to) { original->read(0, box, to, {}); });
    save_edits(*original, {address, options}, 0, *edits.samples, here / "e\xfe.zarr", {});
    leave_behind(*original, here / "c\xfd.zarr");
    EXPECT_GT(convert_to_zarr(*original, 0, here / "c\xfd.zarr", small_chunks()).kept, 0U);
    fs::rename(here, there);
    const auto again = open_store(there / "e\xfe.zarr");
    EXPECT_EQ(read_box(*again, 0, {{5, 5, 5}, {5, 5, 5}})[0], std::byte{7});
    expect_same_boxes(*open_store(there / "c\xfd.zarr"), volume, 8);
}

TEST(OwnFiles, a_content_is_known_by_any_sample_and_by_the_grid) {
    const Volume volume = noise(1);
    const std::string content = content_of(*store_of(volume, "a"), 0);
    EXPECT_EQ(content, content_of(*store_of(volume, "b"), 0));
    EXPECT_NE(content, content_of(*store_of(noise(2), "a"), 0));
    Geometry grid = volume.geometry();
    grid.spacing[2] *= 2;
    const auto* const first = static_cast<const std::uint8_t*>(volume.data());
    const Volume longer(grid, std::vector<std::uint8_t>(first, first + volume.bytes()));
    EXPECT_NE(content, content_of(*store_of(longer, "a"), 0));
}

}  // namespace
}  // namespace palpate::stream::test

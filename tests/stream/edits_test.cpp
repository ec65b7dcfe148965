// What was edited of a store, saved and opened again.
#include "palpate/stream/edits.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "palpate/io/error.hpp"
#include "palpate/stream/convert.hpp"
#include "palpate/stream/growing_image.hpp"
#include "palpate/stream/loader.hpp"
#include "palpate/stream/read_files.hpp"
#include "stream/store_support.hpp"
#include "stream/writer/pyramid.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"

namespace palpate::stream::test {
namespace {

using namespace palpate::support;
namespace fs = std::filesystem;

ReadSamples reader_of(const Store& store, int level) {
    return [&store, level](const SampleBox& box, std::span<std::byte> out) {
        store.read(level, box, out, {});
    };
}

/// A grid with cut chunks, and edits of it.
struct Case {
    ScratchFolder folder;
    SampleType type;
    Volume volume;
    Random random;
    fs::path zarr = folder.path() / "original.zarr", out = folder.path() / "edits.zarr";

    Case(SampleType of, std::uint64_t seed)
        : type(of),
          volume(noise_of(of, grid({150, 90, 70}, {0.5, 0.5, 1}, {3, -4, 5}, oblique_direction()),
                          seed)),
          random(seed) {
        convert_to_zarr(*store_of(volume, "noise"), 0, zarr, {});
    }

    std::shared_ptr<const Samples> some_edits(const Store& store, int level,
                                              std::shared_ptr<const Samples>* plain = nullptr) {
        const Geometry& geometry = store.info().levels[static_cast<std::size_t>(level)].geometry;
        std::shared_ptr<const Samples> edits = empty_samples(store, volume, level);
        for (int i = 0; i < 6; ++i) {
            const Edit edit = random_edit(random, geometry, type);
            edits = edited(edits, edit, reader_of(store, level)).samples;
            if (plain) *plain = edited(*plain, edit).samples;
        }
        return edits;
    }
};

TEST(Edits, what_was_edited_opens_again_as_the_edited_volume) {
    for (const SampleType type : sample_types) {
        Case c(type, 3 + static_cast<std::uint64_t>(type));
        const auto original = open_store(c.zarr.string());
        auto plain = samples_of(c.volume);
        const auto edits = c.some_edits(*original, 0, &plain);
        save_edits(*original, {c.zarr.string(), {}}, 0, *edits, c.out, {});
        ASSERT_TRUE(is_store(c.out.string()));
        const auto again = open_store(c.out.string());
        const Volume whole = flattened(*plain);
        EXPECT_TRUE(same_bits(volume_of(*again), whole));
        EXPECT_EQ(again->info().levels.size(), original->info().levels.size());
        ASSERT_TRUE(again->info().range);
        EXPECT_LE(again->info().range->minimum, whole.minimum());
        // Boxes of any size.
        std::mt19937 random(9);
        for (int i = 0; i < 50; ++i) {
            const SampleBox box = random_box(random, c.volume.geometry().size);
            ASSERT_EQ(read_box(*again, 0, box), box_of(whole, box));
        }
        // A whole copy.
        const fs::path copy = c.folder.path() / "copy.zarr";
        convert_to_zarr(*again, 0, copy, {});
        fs::remove_all(c.zarr);
        EXPECT_TRUE(same_bits(volume_of(*open_store(copy.string())), whole));
        EXPECT_THROW(open_store(c.out.string()), io::InputError) << "the original is gone";
    }
}

TEST(Edits, coarser_levels_are_means_of_what_changed_and_else_as_they_were) {
    Case c(SampleType::int16, 5);
    const auto original = open_store(c.zarr.string());
    const auto edits = c.some_edits(*original, 0);
    save_edits(*original, {c.zarr.string(), {}}, 0, *edits, c.out, {});
    const auto again = open_store(c.out.string());
    ASSERT_GE(again->info().levels.size(), 2U);
    int changed = 0, same = 0;
    // The original's levels were means, so those of the edited volume are, too.
    const fs::path copy = c.folder.path() / "copy.zarr";
    convert_to_zarr(*again, 0, copy, {});
    const auto means = open_store(copy.string());
    for (std::size_t level = 1; level < again->info().levels.size(); ++level) {
        const int l = static_cast<int>(level);
        const Volume now = volume_of(*again, l), before = volume_of(*original, l);
        EXPECT_TRUE(same_bits(now, volume_of(*means, l)));
        for_each_sample(now.geometry(), [&](const Index3& at) {
            (now.sample(at) == before.sample(at) ? same : changed) += 1;
        });
    }
    EXPECT_GT(changed, 10);
    EXPECT_GT(same, 10);
}

/// Samples of a coarser level for each 2 x 2 x 2 samples of the finer one, which lies within the
/// grid.
template <class Value>
Volume halved(const Volume& finer, Value&& value_of) {
    std::vector<std::uint16_t> samples;
    Geometry grid = finer.geometry();
    grid.size /= 2;
    grid.spacing *= 2;
    for_each_sample(grid, [&](const Index3& at) {
        samples.push_back(static_cast<std::uint16_t>(value_of(finer, Index3(2 * at))));
    });
    return Volume(grid, std::move(samples));
}

/// Writes the levels of an image, in chunks of 16^3.
void put_image(const fs::path& folder, const std::vector<Volume>& levels) {
    std::vector<CoarserGrid> grids;
    for (const Volume& level : levels) grids.push_back({level.geometry(), Index3(2, 2, 2)});
    const GrowingImage image(folder, levels[0].type(), grids, {.chunk = 16, .progress = {}});
    image.write_metadata({});
    for (int l = 0; l < image.levels(); ++l) {
        for_each_index({Index3::Zero(), image.chunks(l) - Index3::Ones()}, [&](const Index3& at) {
            image.write(l, at, box_of(levels[static_cast<std::size_t>(l)], image.box(l, at)));
        });
    }
}

/// One way to make the samples of a coarser level.
struct Halving {
    const char* name;
    double (*value_of)(const Volume& finer, const Index3& first);
    double (*edited_value_of)(const Volume& finer, const Index3& first);
    const char* note;  // of the saved edits; empty: none
};

double sample_at(const Volume& finer, const Index3& at) {
    return finer.sample(at);
}
double sample_behind(const Volume& finer, const Index3& at) {
    return finer.sample(at + Index3::Ones());
}
double mean_at(const Volume& finer, const Index3& at) {
    double sum = 0;
    for_each_index({at, at + Index3::Ones()}, [&](const Index3& i) { sum += finer.sample(i); });
    return std::round(sum / 8);
}
double greatest_at(const Volume& finer, const Index3& at) {
    double greatest = 0;
    for_each_index({at, at + Index3::Ones()},
                   [&](const Index3& i) { greatest = std::max(greatest, finer.sample(i)); });
    return greatest;
}
double brighter_at(const Volume& finer, const Index3& at) {
    return mean_at(finer, at) + 3;
}

constexpr Halving halvings[] = {
    {"means", mean_at, mean_at, ""},
    {"the first", sample_at, sample_at, ""},
    {"the last", sample_behind, sample_behind, ""},
    {"the greatest", greatest_at, sample_at,
     "each sample above an edit is one of the finer samples"},
    {"no rule", brighter_at, mean_at, "each sample above an edit is the mean of finer samples"}};

/// Labels 7 and 300 in stripes.
Volume stripes() {
    std::vector<std::uint16_t> labels;
    const Geometry geometry = grid({56, 48, 40}, {0.5, 0.5, 0.5});
    for_each_sample(geometry,
                    [&](const Index3& at) { labels.push_back(at.sum() % 97 < 50 ? 7 : 300); });
    return Volume(geometry, std::move(labels));
}

TEST(Edits, only_coarse_samples_above_edited_ones_change_and_as_their_level_was_made) {
    const edit::Fill fill{{{1, 2, 3}, {9, 8, 7}}, 5};
    for (const Volume& finest :
         {noise_of(SampleType::uint16, stripes().geometry(), 31), stripes()}) {
        for (const Halving& halving : halvings) {
            SCOPED_TRACE(halving.name);
            ScratchFolder folder;
            const fs::path path = folder.path() / "original.zarr",
                           out = folder.path() / "edits.zarr";
            std::vector<Volume> levels = {finest};
            for (int l = 0; l < 2; ++l) levels.push_back(halved(levels.back(), halving.value_of));
            put_image(path, levels);
            const auto store = open_store(path.string());
            ASSERT_EQ(store->info().levels.size(), 3U);
            const auto edits =
                edited(empty_samples(*store, finest, 0), fill, reader_of(*store, 0)).samples;
            save_edits(*store, {path.string(), {}}, 0, *edits, out, {});

            const auto again = open_store(out.string());
            const std::string& note = again->info().notes.back();
            EXPECT_EQ(contains(note, "cannot be told"), halving.note[0] != '\0') << note;
            EXPECT_TRUE(contains(note, halving.note)) << note;
            for (std::size_t l = 1; l < 3; ++l) {
                const Volume now = volume_of(*again, static_cast<int>(l));
                const Volume finer = volume_of(*again, static_cast<int>(l) - 1);
                int wrong = 0;
                for_each_sample(now.geometry(), [&](const Index3& at) {
                    const SampleBox below{2 * at, 2 * at + Index3::Ones()};
                    const bool is_above_changes = any_index(below, [&](const Index3& i) {
                        return finer.sample(i) != levels[l - 1].sample(i);
                    });
                    const double right = is_above_changes
                                             ? halving.edited_value_of(finer, below.low)
                                             : levels[l].sample(at);
                    wrong += now.sample(at) == right ? 0 : 1;
                });
                EXPECT_EQ(wrong, 0) << "level " << l;
            }
        }
    }
}

TEST(Edits, edits_of_edits_name_the_first_original) {
    Case c(SampleType::uint8, 8);
    const auto original = open_store(c.zarr.string());
    auto plain = samples_of(c.volume);
    save_edits(*original, {c.zarr.string(), {}}, 0, *c.some_edits(*original, 0, &plain), c.out, {});
    const auto once = open_store(c.out.string());
    const fs::path second = c.folder.path() / "second.zarr";
    const auto edits = c.some_edits(*once, 0, &plain);
    EXPECT_THROW(save_edits(*once, {c.out.string(), {}}, 0, *edits, c.out, {}), io::OutputError)
        << "it is felt";
    save_edits(*once, {c.out.string(), {}}, 0, *edits, second, {});
    fs::remove_all(c.out);
    EXPECT_TRUE(same_bits(volume_of(*open_store(second.string())), flattened(*plain)));
}

TEST(Edits, of_a_level_are_a_volume_whose_finest_level_is_that_one) {
    Case c(SampleType::float32, 9);
    const auto original = open_store(c.zarr.string());
    const Volume before = volume_of(*original, 1);
    auto plain = samples_of(before);
    const auto edits = c.some_edits(*original, 1, &plain);
    save_edits(*original, {c.zarr.string(), {}}, 1, *edits, c.out, {});
    const auto again = open_store(c.out.string());
    EXPECT_TRUE(same_bits(volume_of(*again), flattened(*plain)));
    EXPECT_EQ(again->info().levels.size() + 1, original->info().levels.size());
}

TEST(Edits, a_raw_file_is_opened_again_with_its_layout_also_where_both_were_moved) {
    ScratchFolder folder;
    const Volume volume = noise_of(SampleType::uint16, grid({70, 66, 5}), 4);
    const fs::path here = folder.path() / "here", there = folder.path() / "there";
    fs::create_directories(here);
    io::write_volume(volume, here / "a.raw");
    StoreOptions options;
    options.raw = io::RawLayout{{70, 66, 5}, SampleType::uint16};
    const std::string address = (here / "a.raw").string();
    const auto original = open_store(address, options);
    auto plain = samples_of(volume);
    const edit::Fill fill{{{60, 60, 0}, {69, 65, 4}}, 77};
    const auto edits = edited(empty_samples(*original, volume, 0), fill, reader_of(*original, 0));
    save_edits(*original, {address, options}, 0, *edits.samples, here / "a-edits.zarr", {});
    EXPECT_TRUE(is_read_from(here / "a.raw", here / "a-edits.zarr"));
    fs::rename(here, there);
    EXPECT_TRUE(is_read_from(there / "a.raw", there / "a-edits.zarr"));
    EXPECT_TRUE(
        is_read_from(there / "a-edits.zarr" / "palpate-edits.json", there / "a-edits.zarr"));
    io::write_volume(volume, there / "b.raw");
    EXPECT_FALSE(is_read_from(there / "b.raw", there / "a-edits.zarr"));
    const auto again = open_store((there / "a-edits.zarr").string());
    EXPECT_TRUE(same_bits(volume_of(*again), flattened(*edited(plain, fill).samples)));
}

TEST(Edits, open_wherever_they_were_saved_and_whatever_lies_beside_them) {
    Case c(SampleType::uint8, 12);
    const auto original = open_store(c.zarr.string());
    auto plain = samples_of(c.volume);
    const auto edits = c.some_edits(*original, 0, &plain);
    const fs::path sub = c.folder.path() / "sub";
    fs::create_directory(sub);
    for (const fs::path& out : {sub / "../up.zarr", sub / "./down.zarr", sub / "slash.zarr/"}) {
        save_edits(*original, {c.zarr.string(), {}}, 0, *edits, out, {});
        EXPECT_TRUE(same_bits(volume_of(*open_store(out.string())), flattened(*plain))) << out;
    }
    // A copy elsewhere, beside another volume of the original's name.
    const fs::path other = c.folder.path() / "other";
    fs::create_directory(other);
    fs::copy(c.folder.path() / "up.zarr", other / "up.zarr", fs::copy_options::recursive);
    convert_to_zarr(*store_of(noise_of(c.type, c.volume.geometry(), 13), "other"), 0,
                    other / c.zarr.filename(), {});
    EXPECT_TRUE(same_bits(volume_of(*open_store((other / "up.zarr").string())), flattened(*plain)));
}

TEST(Edits, replace_older_ones_and_nothing_else) {
    Case c(SampleType::uint8, 2);
    const auto original = open_store(c.zarr.string());
    const Opened opened{c.zarr.string(), {}};
    auto plain = samples_of(c.volume);
    const auto edits = c.some_edits(*original, 0);
    save_edits(*original, opened, 0, *edits, c.out, {});
    const auto later = c.some_edits(*original, 0, &plain);
    save_edits(*original, opened, 0, *later, c.out, {});
    EXPECT_TRUE(same_bits(volume_of(*open_store(c.out.string())), flattened(*plain)));
    EXPECT_FALSE(fs::exists(c.out.string() + ".partial"));
    EXPECT_THROW(save_edits(*original, opened, 0, *edits, c.folder.path() / "a.nrrd", {}),
                 std::invalid_argument);
    const fs::path undone = c.folder.path() / "undone.zarr";
    save_edits(*original, opened, 0, *empty_samples(*original, c.volume, 0), undone, {});
    EXPECT_TRUE(same_bits(volume_of(*open_store(undone.string())), c.volume));
    const fs::path other = c.folder.path() / "other.zarr";
    fs::copy(c.zarr, other, fs::copy_options::recursive);
    EXPECT_THROW(save_edits(*original, opened, 0, *edits, other, {}), io::OutputError);
    EXPECT_TRUE(same_bits(volume_of(*open_store(other.string())), c.volume));
    // Cancelled: what was there stays.
    const auto stop = [](double) { throw Cancelled{}; };
    EXPECT_THROW(save_edits(*original, opened, 0, *edits, c.out, stop), Cancelled);
    EXPECT_TRUE(same_bits(volume_of(*open_store(c.out.string())), flattened(*plain)));
}

TEST(Edits, of_an_original_that_has_gone_are_rescued_and_open_when_it_is_back) {
    Case c(SampleType::int16, 17);
    const auto original = open_store(c.zarr.string());
    auto plain = samples_of(c.volume);
    const auto edits = c.some_edits(*original, 0, &plain);
    const fs::path away = c.folder / "gone.zarr", more = c.folder / "more.zarr";
    fs::rename(c.zarr, away);
    EXPECT_THROW((void)volume_of(*original), io::InputError);  // it is not all fill value
    Opened opened{c.zarr.string(), {}};
    const auto save = [&] { save_edits(*original, opened, 0, *edits, c.out, {}); };
    EXPECT_THROW(save(), io::InputError);
    opened.is_rescue = true;
    save();
    EXPECT_THROW((void)open_store(c.out.string()), io::InputError);
    fs::rename(away, c.zarr);
    const auto rescued = open_store(c.out.string());
    EXPECT_EQ(rescued->info().levels.size(), 1U);  // the coarser ones would be without edits
    EXPECT_TRUE(same_bits(volume_of(*rescued), flattened(*plain)));
    // Edits of them are saved as usual.
    const auto further = c.some_edits(*rescued, 0, &plain);
    save_edits(*rescued, {c.out.string(), {}}, 0, *further, more, {});
    EXPECT_TRUE(same_bits(volume_of(*open_store(more.string())), flattened(*plain)));
}

/// A store behind a server that has fallen silent.
class Silent : public Store {
  public:
    explicit Silent(const Store& store) : store_(store) {}
    const StoreInfo& info() const override { return store_.info(); }
    Traffic traffic() const override { return store_.traffic(); }
    void read(int, const SampleBox&, std::span<std::byte>, std::stop_token) const override {
        throw std::logic_error("is asked");
    }

  private:
    const Store& store_;
};

TEST(Edits, are_rescued_without_asking_for_the_original) {
    Case c(SampleType::uint8, 18);
    const auto original = open_store(c.zarr.string());
    ASSERT_GT(original->info().levels.size(), 1U);
    auto plain = samples_of(c.volume);
    const auto edits = c.some_edits(*original, 0, &plain);
    Opened opened{c.zarr.string(), {}};
    const Silent silent(*original);
    EXPECT_THROW(save_edits(silent, opened, 0, *edits, c.out, {}), std::logic_error);
    opened.is_rescue = true;
    save_edits(silent, opened, 0, *edits, c.out, {});
    EXPECT_TRUE(same_bits(volume_of(*open_store(c.out.string())), flattened(*plain)));
}

TEST(Edits, damaged_notes_are_refused_in_one_line) {
    Case c(SampleType::uint8, 6);
    const auto original = open_store(c.zarr.string());
    save_edits(*original, {c.zarr.string(), {}}, 0, *c.some_edits(*original, 0), c.out, {});
    const fs::path note = c.out / "palpate-edits.json";
    std::ifstream in(note, std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    int refused = 0;
    for (int i = 0; i < 300; ++i) {
        std::string bytes = whole;
        if (i % 3 == 0) {
            bytes.resize(static_cast<std::size_t>(c.random.below(int(bytes.size()))));
        } else {
            const auto at = static_cast<std::size_t>(c.random.below(int(bytes.size())));
            bytes[at] = "0-9,[]{}\"x"[c.random.below(10)];
        }
        std::ofstream(note, std::ios::binary | std::ios::trunc) << bytes;
        try {
            const auto again = open_store(c.out.string());
            read_box(*again, 0, whole_box(c.volume.geometry()));
        } catch (const io::InputError& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            ++refused;
        }
    }
    EXPECT_GT(refused, 100);
}

/// All that a store says and holds.
std::string all_of(const Store& store) {
    std::ostringstream all;
    const StoreInfo& info = store.info();
    all << name_of(info.type) << info.range->minimum << ' ' << info.range->maximum << ' '
        << info.fill;
    for (std::size_t l = 0; l < info.levels.size(); ++l) {
        const Geometry& grid = info.levels[l].geometry;
        all << grid.size.transpose() << grid.spacing.transpose() << grid.origin.transpose()
            << grid.direction << grid.oriented << grid.measured;
        const auto samples = read_box(store, static_cast<int>(l), whole_box(grid));
        all.write(reinterpret_cast<const char*>(samples.data()),
                  static_cast<std::streamsize>(samples.size()));
    }
    return all.str();
}

/// The same of the folder, or why it is refused.
std::string opened_or_refused(const fs::path& folder) {
    try {
        return all_of(*open_store(folder.string()));
    } catch (const io::InputError& e) {
        EXPECT_TRUE(io::test::one_line_about(e.what(), folder) ||
                    support::contains(e.what(), folder.string() + "/"))
            << e.what();
        return "refused";
    }
}

TEST(Edits, of_which_a_bit_has_turned_or_a_chunk_is_missing_are_refused_by_name) {
    Case c(SampleType::int16, 21);
    const auto original = open_store(c.zarr.string());
    // One chunk becomes 0.
    auto edits = c.some_edits(*original, 0);
    edits =
        edited(edits, edit::Fill{{{0, 0, 0}, {63, 63, 63}}, 0}, reader_of(*original, 0)).samples;
    save_edits(*original, {c.zarr.string(), {}}, 0, *edits, c.out, {});
    const std::string right = opened_or_refused(c.out);
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(c.out)) {
        if (entry.is_regular_file()) files.push_back(entry.path());
    }
    ASSERT_GT(files.size(), 6U);
    int refused = 0, tried = 0;
    for (const fs::path& file : files) {
        const std::string good = support::bytes_of(file);
        for (int i = 0; i < 12; ++i) {
            std::string bad = good;
            char& byte = bad[static_cast<std::size_t>(c.random.below(int(bad.size())))];
            byte = static_cast<char>(byte ^ (1 << c.random.below(8)));
            support::put_bytes(file, bad);
            const std::string now = opened_or_refused(c.out);
            refused += now == "refused";
            ++tried;
            // White space, members that change nothing, and bits that zstd does not use.
            EXPECT_TRUE(now == "refused" || now == right) << file;
        }
        if (file.filename() != "palpate-edits.json") {  // without it, it is an image of its own
            fs::remove(file);
            EXPECT_EQ(opened_or_refused(c.out), "refused") << file;
        }
        support::put_bytes(file, good);
    }
    EXPECT_GT(refused, tried / 2);
    EXPECT_EQ(opened_or_refused(c.out), right);
}

TEST(Edits, of_earlier_versions_open_without_a_checksum_and_without_chunks_of_zeros) {
    Case c(SampleType::uint8, 22);
    const auto original = open_store(c.zarr.string());
    const edit::Fill zeros{{{0, 0, 0}, {63, 63, 63}}, 0};
    auto plain = edited(samples_of(c.volume), zeros).samples;
    const auto edits =
        edited(empty_samples(*original, c.volume, 0), zeros, reader_of(*original, 0));
    save_edits(*original, {c.zarr.string(), {}}, 0, *edits.samples, c.out, {});
    auto note = nlohmann::json::parse(support::bytes_of(c.out / "palpate-edits.json"));
    ASSERT_EQ(note.erase("checksum"), 1U);
    support::put_bytes(c.out / "palpate-edits.json", note.dump(1));
    ASSERT_TRUE(fs::remove(c.out / "0/c/0/0/0"));
    EXPECT_TRUE(same_bits(volume_of(*open_store(c.out.string())), flattened(*plain)));
}

}  // namespace
}  // namespace palpate::stream::test

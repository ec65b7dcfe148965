// Conversions and saved edits at every kind of end: killed before a system call, on a full disk,
// with failing renames, two at once, where names cannot be exchanged. What is at OUT is the data of
// before or the new data, whole.
#include <cstdlib>

#include "io/system/growing_folder.hpp"
#include "palpate/io/error.hpp"
#include "palpate/stream/convert.hpp"
#include "palpate/stream/edits.hpp"
#include "palpate/stream/loader.hpp"
#include "stream/store_support.hpp"
#include "support/edits.hpp"
#include "support/traced_process.hpp"

namespace palpate::stream::test {
namespace {

namespace fs = std::filesystem;
using support::deny_exchange;
using support::end_of;
using support::Fate;
using support::FileCall;
using support::run_traced;
using support::ScratchFolder;
using support::start_process;

constexpr int killed = 1000 + 9;

Volume some_volume() {
    return support::noise_of(SampleType::uint8, support::grid({40, 30, 20}), 3);
}

void convert(const fs::path& out) {
    ConvertOptions options;
    options.chunk = 16;
    options.threads = 1;  // the same calls each time
    (void)convert_to_zarr(*store_of(some_volume(), "v"), 0, out, options);
}

/// In memory, where syncing takes no time: a kill, unlike a power cut, does not need it.
class Killed : public ::testing::Test {
  protected:
    Killed() {
        if (const char* folder = std::getenv("TMPDIR")) before_ = folder;
        if (fs::is_directory("/dev/shm")) ::setenv("TMPDIR", "/dev/shm", 1);
    }
    ~Killed() override {
        before_.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before_.c_str(), 1);
    }

  private:
    std::string before_;
};

/// In a new process: a process removes what killed ones have left when it first looks at a folder.
void done_elsewhere(const std::function<void()>& work) {
    EXPECT_EQ(end_of(start_process(work)), 0);
}

/// An original, and edits of it that put a number into a box.
struct Edits {
    ScratchFolder folder;
    fs::path original = folder / "v.zarr", out = folder / "e.zarr";

    Edits() {
        done_elsewhere([&] { convert(original); });
    }

    void save(int value) const {
        const auto store = open_store(original);
        const ReadSamples read = [&](const SampleBox& box, std::span<std::byte> to) {
            store->read(0, box, to, {});
        };
        const edit::Fill fill{{{3, 3, 3}, {9, 9, 9}}, double(value)};
        const auto samples = edited(empty_samples(*store, some_volume(), 0), fill, read).samples;
        save_edits(*store, {original, {}}, 0, *samples, out, {});
    }
    /// That, on a system that perhaps cannot exchange two names.
    std::function<void()> saving(int value, bool can_exchange) const {
        return [this, value, can_exchange] {
            if (!can_exchange) deny_exchange();
            save(value);
        };
    }
    void save_elsewhere(int value) const {
        done_elsewhere([&] { save(value); });
    }
    /// The number in a folder of edits, all of whose box must hold it.
    static int value_in(const fs::path& edits) {
        const auto samples = read_box(*open_store(edits), 0, {{3, 3, 3}, {9, 9, 9}});
        EXPECT_EQ(std::ranges::count(samples, samples[0]), std::ssize(samples));
        return static_cast<int>(samples[0]);
    }
};

/// How many calls `work` makes that `counts`.
template <class Counts>
int calls_of(const std::function<void()>& work, Counts&& counts) {
    int calls = 0;
    EXPECT_EQ(run_traced(work,
                         [&](const FileCall& call) {
                             calls += counts(call) ? 1 : 0;
                             return Fate::made;
                         }),
              0);
    EXPECT_GT(calls, 0);
    return calls;
}

bool any(const FileCall&) {
    return true;
}

/// The fate of the call number `at`, and of those after it, if they `count`.
template <class Counts>
std::function<Fate(const FileCall&)> from_call(int at, Fate fate, Counts counts,
                                               bool only_one = false) {
    return [=, seen = 0](const FileCall& call) mutable {
        if (!counts(call)) return Fate::made;
        const int number = seen++;
        return number == at || (number > at && !only_one) ? fate : Fate::made;
    };
}

TEST_F(Killed, a_conversion_leaves_nothing_or_all_and_the_next_one_completes_it) {
    const int calls = [] {
        const ScratchFolder folder;
        return calls_of([&] { convert(folder / "v.zarr"); }, any);
    }();
    const Volume volume = some_volume();
    std::mt19937 random(1);
    int unfinished = 0;
    for (int i = 0; i < 100; ++i) {
        const ScratchFolder folder;
        const fs::path out = folder / "v.zarr";
        const int at = static_cast<int>(random() % static_cast<unsigned>(calls));
        SCOPED_TRACE(at);
        ASSERT_EQ(run_traced([&] { convert(out); }, from_call(at, Fate::killed, any)), killed);
        if (fs::exists(out)) {
            expect_same_boxes(*open_store(out), volume, 1);
            continue;
        }
        ++unfinished;
        done_elsewhere([&] { convert(out); });
        expect_same_boxes(*open_store(out), volume, 1);
        EXPECT_EQ(folder.names(), std::vector<std::string>{"v.zarr"});
    }
    EXPECT_GT(unfinished, 50);
}

TEST_F(Killed, saving_edits_leaves_the_old_ones_or_the_new_ones) {
    const Edits edits;
    for (const bool can_exchange : {true, false}) {
        const auto save = [&](int value) { return edits.saving(value, can_exchange); };
        edits.save_elsewhere(1);
        const int calls = calls_of(save(1), any);
        std::mt19937 random(2);
        int before = 0, after = 0;
        for (int i = 0; i < 100; ++i) {
            const int at = static_cast<int>(random() % static_cast<unsigned>(calls));
            SCOPED_TRACE(at);
            const int old = Edits::value_in(edits.out), now = old % 200 + 1;
            ASSERT_EQ(run_traced(save(now), from_call(at, Fate::killed, any)), killed);
            // In the moment between two renames the old ones have another name.
            const fs::path aside = edits.out.string() + ".previous";
            if (!can_exchange && !fs::exists(edits.out)) fs::rename(aside, edits.out);
            fs::remove_all(aside);
            const int value = Edits::value_in(edits.out);
            EXPECT_TRUE(value == old || value == now) << value;
            (value == old ? before : after) += 1;
        }
        EXPECT_GT(before, 10);
        EXPECT_GT(after, 0);
        edits.save_elsewhere(7);  // removes what they left
        EXPECT_EQ(edits.folder.names(), (std::vector<std::string>{"e.zarr", "v.zarr"}));
    }
}

TEST_F(Killed, a_full_disk_is_an_error_and_the_old_edits_stay) {
    const Edits edits;
    edits.save_elsewhere(1);
    const auto takes_room = [](const FileCall& call) { return call.takes_room; };
    const int calls = calls_of([&] { edits.save(1); }, takes_room);
    for (int at = 0; at < calls; ++at) {
        SCOPED_TRACE(at);
        ASSERT_EQ(
            run_traced([&] { edits.save(2); }, from_call(at, Fate::fails_without_room, takes_room)),
            1);
        EXPECT_EQ(Edits::value_in(edits.out), 1);
        EXPECT_EQ(edits.folder.names(), (std::vector<std::string>{"e.zarr", "v.zarr"}));
    }
}

TEST_F(Killed, a_conversion_to_a_full_disk_is_an_error_and_completed_when_there_is_room) {
    const auto takes_room = [](const FileCall& call) { return call.takes_room; };
    const int calls = [&] {
        const ScratchFolder folder;
        return calls_of([&] { convert(folder / "v.zarr"); }, takes_room);
    }();
    for (int at = 0; at < calls; at += 3) {
        SCOPED_TRACE(at);
        const ScratchFolder folder;
        const fs::path out = folder / "v.zarr";
        ASSERT_EQ(
            run_traced([&] { convert(out); }, from_call(at, Fate::fails_without_room, takes_room)),
            1);
        EXPECT_FALSE(fs::exists(out));
        convert(out);
        expect_same_boxes(*open_store(out), some_volume(), 1);
        EXPECT_EQ(folder.names(), std::vector<std::string>{"v.zarr"});
    }
}

TEST_F(Killed, a_rename_that_fails_costs_neither_the_old_edits_nor_the_new_ones) {
    const auto renames = [](const FileCall& call) { return call.renames; };
    for (const bool can_exchange : {true, false}) {
        const Edits edits;
        const auto save = [&](int value) { return edits.saving(value, can_exchange); };
        edits.save_elsewhere(1);
        const int calls = calls_of(save(1), renames);
        int failed = 0, rescued = 0;
        for (const bool only_one : {true, false}) {
            for (int at = 0; at < calls; ++at) {
                SCOPED_TRACE(at);
                const int outcome =
                    run_traced(save(2), from_call(at, Fate::fails, renames, only_one));
                ASSERT_TRUE(outcome == 0 || outcome == 1) << outcome;
                failed += outcome;
                const fs::path aside = edits.out.string() + ".previous";
                if (!fs::exists(edits.out)) {  // the way back failed, too; the message names it
                    EXPECT_FALSE(only_one);
                    fs::rename(aside, edits.out);
                }
                EXPECT_EQ(Edits::value_in(edits.out), outcome == 0 ? 2 : 1);
                const fs::path kept = edits.out.string() + ".rescued";
                if (fs::exists(kept)) {
                    EXPECT_EQ(Edits::value_in(kept), 2);
                    ++rescued;
                }
                fs::remove_all(kept);
                fs::remove_all(aside);
                edits.save_elsewhere(1);
            }
        }
        EXPECT_GT(failed, calls);
        EXPECT_GT(rescued, 0);
    }
}

TEST_F(Killed, what_must_not_be_replaced_survives_every_rename_that_fails) {
    const auto renames = [](const FileCall& call) { return call.renames; };
    for (const bool exchanges : {true, false}) {
        for (int i = 0; i < 14; ++i) {
            SCOPED_TRACE(i);
            const int at = i % 7;  // the last one: none fails
            const bool only_one = i < 7;
            const ScratchFolder folder;
            const fs::path out = folder / "e.zarr";
            fs::create_directories(out / "0/c/0/0");
            support::put_bytes(out / "0/c/0/0/0", "years");  // looks like a chunk of ours
            const auto work = [&] {
                if (!exchanges) deny_exchange();
                io::GrowingFolder grown = io::GrowingFolder::alone(out);
                int looks = 0;
                grown.put_in_place([&](const fs::path&) {
                    if (++looks == 2) throw io::OutputError("is precious");
                });
            };
            EXPECT_EQ(run_traced(work, from_call(at, Fate::fails, renames, only_one)), 1);
            int kept = 0;
            for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
                kept += entry.is_regular_file() && support::bytes_of(entry.path()) == "years";
            }
            EXPECT_EQ(kept, 1);
            if (at == 6) {
                EXPECT_EQ(support::bytes_of(out / "0/c/0/0/0"), "years");
            }
        }
    }
}

TEST_F(Killed, what_is_replaced_is_looked_at_only_while_something_has_its_name) {
    for (const bool exchanges : {true, false}) {
        const ScratchFolder folder;
        const fs::path out = folder / "e.zarr";
        fs::create_directory(out);
        const auto work = [&] {
            if (!exchanges) deny_exchange();
            io::GrowingFolder grown = io::GrowingFolder::alone(out);
            int looks = 0;
            grown.put_in_place([&](const fs::path&) {
                if (!fs::exists(out)) throw io::InputError("nothing is there");
                ++looks;
            });
            if (looks < 2) throw io::InputError("what was moved away was not looked at");
        };
        EXPECT_EQ(end_of(start_process(work)), 0);
    }
}

TEST_F(Killed, two_that_save_edits_under_one_name_leave_those_of_one_of_them_whole) {
    const Edits edits;
    for (int i = 0; i < 20; ++i) {
        std::vector<int> processes;
        for (const int value : {11, 22}) {
            processes.push_back(start_process([&, i] {
                if (i % 2 == 1) deny_exchange();
                for (int n = 0; n < 3; ++n) edits.save(value);
            }));
        }
        for (const int process : processes) EXPECT_EQ(end_of(process), 0);
        const int value = Edits::value_in(edits.out);
        EXPECT_TRUE(value == 11 || value == 22) << value;
        EXPECT_EQ(edits.folder.names(), (std::vector<std::string>{"e.zarr", "v.zarr"}));
        if (i % 4 < 2) fs::remove_all(edits.out);  // also where there is nothing yet
    }
}

TEST_F(Killed, of_two_conversions_to_one_name_one_is_refused_and_the_other_whole) {
    for (int i = 0; i < 10; ++i) {
        const ScratchFolder folder;
        const fs::path out = folder / "v.zarr";
        const int one = start_process([&] { convert(out); });
        const int other = start_process([&] { convert(out); });
        const int ends = end_of(one) + 10 * end_of(other);
        EXPECT_TRUE(ends == 1 || ends == 10) << ends;
        expect_same_boxes(*open_store(out), some_volume(), 1);
        EXPECT_EQ(folder.names(), std::vector<std::string>{"v.zarr"});
    }
}

}  // namespace
}  // namespace palpate::stream::test

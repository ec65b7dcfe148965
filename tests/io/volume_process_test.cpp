// Whatever the helper process does (crash, hang, lie, vanish), the caller gets one plain error and
// nothing is left behind; and what it hands back is held in memory once.
#include <dirent.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include "io/system/leftovers.hpp"
#include "support/eventually.hpp"
#include "support/random.hpp"
#include "volume_support.hpp"

namespace palpate::io::test {
namespace {

/// A helper that is a shell script.
template <class Options = ReadOptions>
Options with_script(const ScratchFolder& folder, const std::string& commands) {
    const auto path = folder / "helper";
    put_bytes(path, "#!/bin/bash\n" + commands + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    Options options;
    options.helper = path;
    return options;
}

std::size_t open_descriptors() {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

bool has_children() {
    return waitpid(-1, nullptr, WNOHANG) != -1 || errno != ECHILD;
}

class HelperProcess : public testing::Test {
  protected:
    HelperProcess() { put_bytes(file_, "something"); }
    std::string refusal_with(const std::string& commands) {
        const std::size_t descriptors = open_descriptors();
        const std::string message = refusal(file_, with_script(folder_, commands));
        EXPECT_TRUE(one_line_about(message, file_)) << message;
        EXPECT_EQ(open_descriptors(), descriptors);
        EXPECT_FALSE(has_children());
        return message;
    }
    ScratchFolder folder_;
    std::filesystem::path file_ = folder_ / "a.nrrd";
};

TEST_F(HelperProcess, a_crash_is_one_line_that_says_where_and_why) {
    const std::string message = refusal_with(
        "echo '{\"doing\":\"slice7.dcm\"}' >&4\necho noise >&2\n"
        "echo 'gdcm.cxx:12: Assertion failed' >&2\nkill -ABRT $$");
    EXPECT_TRUE(contains(message, "crashed at slice7.dcm")) << message;
    EXPECT_TRUE(contains(message, "Assertion failed")) << message;
    EXPECT_FALSE(contains(message, "noise")) << message;
    EXPECT_TRUE(contains(refusal_with("kill -SEGV $$"), "crashed"));
}

TEST_F(HelperProcess, being_killed_and_interrupted_are_told_apart) {
    EXPECT_TRUE(contains(refusal_with("kill -KILL $$"), "out of memory"));
    EXPECT_TRUE(contains(refusal_with("trap - INT; kill -INT $$"), "interrupted"));
}

TEST_F(HelperProcess, an_answer_that_makes_no_sense_is_refused) {
    refusal_with("exit 0");
    refusal_with("exit 3");
    refusal_with("head -c 300000 /dev/urandom >&4");
    refusal_with("head -c 3000000 /dev/zero >&2");
    refusal_with("echo '{\"done\":{}}' >&4");
    refusal_with("echo '{\"progress\":\"x\"}' >&4");
    refusal_with("echo '{\"done\":{\"geometry\":7,\"type\":\"uint8\"}}' >&4");
    const std::string geometry =
        "\"geometry\":{\"size\":[2,2,2],\"spacing\":[1,1,1],\"origin\":[0,0,0],\"axes\":"
        "[[1,0,0],[0,1,0],[0,0,1]],\"oriented\":true,\"measured\":true}";
    const std::string rest = ",\"format\":\"x\",\"time_steps\":1,\"notes\":[]";
    EXPECT_TRUE(contains(
        refusal_with("echo '{\"done\":{" + geometry + ",\"type\":\"uint8\"" + rest + "}}' >&4"),
        "too few samples"));
    refusal_with("echo '{\"done\":{" + geometry + ",\"type\":\"int99\"" + rest + "}}' >&4");
}

TEST_F(HelperProcess, a_hang_ends_at_the_time_limit) {
    for (const char* commands : {"exec sleep 1000000", "exec 1>&- 2>&- 4>&-\nexec sleep 1000000"}) {
        ReadOptions options = with_script(folder_, commands);
        options.time_limit_s = 0.3;
        refusal(file_, options);
        EXPECT_FALSE(has_children());
    }
}

TEST_F(HelperProcess, one_that_computes_for_ever_ends_at_the_limit_of_its_processor_time) {
    ReadOptions options = with_script(folder_, "while :; do :; done");
    options.time_limit_s = 1;
    const std::string message = refusal(file_, options);
    EXPECT_TRUE(one_line_about(message, file_)) << message;
    // On a busy machine the limit of the time on the wall comes first.
    EXPECT_TRUE(contains(message, "it took more than 1 s of processor time") ||
                contains(message, "no answer after 1 s"))
        << message;
    EXPECT_FALSE(has_children());
    // Without being asked for, there is a limit by the size of the file, as the child sees it.
    const std::string limit = refusal_with(
        "until grep 'Max cpu time  *[0-9]' /proc/self/limits >&2; do sleep 0.01; done\n"
        "kill -ABRT $$");
    EXPECT_TRUE(contains(limit, "Max cpu time 121")) << limit;
    const std::string ended = refusal_with("echo '{\"doing\":\"slice7.dcm\"}' >&4; kill -XCPU $$");
    EXPECT_TRUE(contains(ended, "took more than 121 s of processor time at slice7.dcm")) << ended;
}

TEST_F(HelperProcess, words_of_a_library_come_without_its_sources_and_pointers) {
    const std::string message = refusal_with(
        "echo 'palpate-io-helper: /build/gdcm-3.0/Source/gdcmFoo.cxx:12: bool Foo::bar(int): "
        "Assertion (0x55d0c8a2b010) failed, see /usr/src/itk/a.h' >&2; kill -ABRT $$");
    EXPECT_TRUE(contains(message, "bool Foo::bar(int): Assertion failed, see")) << message;
    for (const char* inside : {"/build", "cxx", "0x55", "/usr/src"}) {
        EXPECT_FALSE(contains(message, inside)) << message;
    }
}

TEST_F(HelperProcess, a_missing_helper_is_said) {
    ReadOptions options;
    options.helper = folder_ / "nothing";
    EXPECT_TRUE(contains(refusal(file_, options), "reinstall Palpate"));
    put_bytes(folder_ / "nothing", "not a program");
    EXPECT_TRUE(contains(refusal(file_, options), "reinstall Palpate"));
}

TEST_F(HelperProcess, a_file_that_has_got_its_name_is_written_and_not_cancelled) {
    const auto written = folder_ / "b.nrrd", ended = folder_ / "ended";
    auto options = with_script<WriteOptions>(
        folder_, "echo '{\"placing\":true}' >&4\n: > \"$2\"\necho '{\"done\":{}}' >&4\n: > '" +
                     ended.string() + "'");
    struct Cancelled {};
    int calls = 0;
    options.progress = [&](double) {
        if (++calls > 1) throw Cancelled();
        EXPECT_TRUE(support::comes_true([&] { return std::filesystem::exists(ended); }));
    };
    const Volume volume(Geometry{Index3(2, 2, 2)}, std::vector<std::uint8_t>(8));
    EXPECT_NO_THROW(write_volume(volume, written, options));
    EXPECT_TRUE(std::filesystem::exists(written));
}

TEST_F(HelperProcess, of_palpate_says_before_the_end_that_a_file_gets_its_name) {
    if (!std::filesystem::exists("/proc/self/exe")) GTEST_SKIP() << "needs /proc";
    const Volume volume(Geometry{Index3(2, 2, 2)}, std::vector<std::uint8_t>(8));
    for (const char* name : {"b.nrrd", "b.mha", "b.nii.gz", "b.tif"}) {
        const auto reports = folder_ / (std::string(name) + ".reports");
        const auto options = with_script<WriteOptions>(folder_, "exec '" + real_helper().string() +
                                                                    "' \"$@\" 4> >(exec tee '" +
                                                                    reports.string() + "' >&4)");
        write_volume(volume, folder_ / name, options);
        EXPECT_TRUE(std::filesystem::exists(folder_ / name));
        const auto at = [&](const char* report) { return bytes_of(reports).find(report); };
        constexpr auto none = std::string::npos;
        ASSERT_TRUE(support::comes_true([&] { return at("{\"done\":") != none; })) << name;
        EXPECT_LT(at("{\"placing\":true}"), at("{\"done\":")) << name;
    }
}

TEST_F(HelperProcess, an_exception_from_progress_ends_the_helper) {
    ReadOptions options = with_script(folder_, "exec sleep 100");
    struct Cancelled {};
    int calls = 0;
    options.progress = [&](double) {
        if (++calls == 3) throw Cancelled();
    };
    EXPECT_THROW((void)read_volume(file_, options), Cancelled);
    EXPECT_FALSE(has_children());
}

TEST_F(HelperProcess, progress_is_told_in_the_calling_thread_and_never_goes_back) {
    std::mt19937 random(31);
    write_volume(random_volume<std::uint8_t>(random, random_geometry(random, true, false)), file_);
    ReadOptions options;
    double last = 0;
    int calls = 0;
    const auto thread = std::this_thread::get_id();
    options.progress = [&](double fraction) {
        EXPECT_EQ(std::this_thread::get_id(), thread);
        EXPECT_GE(fraction, last);
        EXPECT_LE(fraction, 1);
        last = fraction;
        ++calls;
    };
    (void)read_volume(file_, options);
    EXPECT_GT(calls, 0);
}

TEST_F(HelperProcess, works_where_interrupts_are_blocked_and_descriptors_are_many) {
    std::mt19937 random(32);
    const Volume volume = random_volume<std::uint8_t>(random, random_geometry(random, true, false));
    write_volume(volume, file_);
    sigset_t blocked, before;
    sigfillset(&blocked);
    pthread_sigmask(SIG_BLOCK, &blocked, &before);
    EXPECT_TRUE(same_samples(read_volume(file_).volume, volume));
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST_F(HelperProcess, several_threads_may_read_at_once) {
    std::mt19937 random(33);
    const Volume volume = random_volume<std::int16_t>(random, random_geometry(random, true, false));
    write_volume(volume, file_);
    std::vector<std::thread> threads;
    std::array<bool, 4> same{};
    for (bool& result : same) {
        threads.emplace_back([&] { result = same_samples(read_volume(file_).volume, volume); });
    }
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(same, (std::array{true, true, true, true}));
}

TEST_F(HelperProcess, ends_with_its_caller_and_takes_its_unfinished_file_along) {
    // A caller that is killed while the helper starts or writes.
    Geometry g;
    g.size = Index3(400, 400, 200);
    const Volume volume(g, std::vector<std::uint8_t>(32000000, 7));
    const pid_t caller = fork();
    if (caller == 0) {
        WriteOptions options;
        int calls = 0;
        options.progress = [&](double) {
            if (++calls == 2) kill(getpid(), SIGKILL);
        };
        options.compress = true;
        try {
            write_volume(volume, folder_ / "big.nrrd", options);
        } catch (...) {
        }
        _exit(0);
    }
    waitpid(caller, nullptr, 0);
    EXPECT_TRUE(support::comes_true([&] {
        const auto names = folder_.names();
        return std::none_of(names.begin(), names.end(),
                            [](const auto& name) { return name.rfind(".palpate", 0) == 0; });
    })) << "something is left: "
        << folder_.names().front();
}

TEST_F(HelperProcess, what_it_left_when_it_was_killed_goes_with_the_next_volume_written_there) {
    const pid_t dead = fork();
    if (dead == 0) _exit(0);
    waitpid(dead, nullptr, 0);
    const ScratchFolder folder;
    const auto left = folder / (".palpate-" + std::to_string(dead) + "-0.part");
    std::filesystem::create_directory(left);
    put_bytes(left / temporary_marker, std::string(temporary_marker_text));
    put_bytes(left / "big.raw", "half");
    std::mt19937 random(35);
    write_volume(random_volume<std::uint8_t>(random, random_geometry(random, true, false)),
                 folder / "b.nrrd");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"b.nrrd"});
}

TEST_F(HelperProcess, ctrl_c_at_any_moment_of_writing_leaves_the_whole_file_or_nothing) {
    Geometry g;
    g.size = Index3(200, 200, 100);
    const Volume volume(g, std::vector<std::uint8_t>(4000000, 7));
    int interrupted = 0;
    for (int round = 0; round < 12; ++round) {
        std::filesystem::remove(folder_ / "big.nrrd");
        const pid_t caller = fork();
        if (caller == 0) {
            setsid();  // a terminal's Ctrl-C goes to the whole group, so to the helper too
            signal(SIGINT, SIG_DFL);  // which a program that a script started behind itself ignores
            WriteOptions options;
            options.compress = true;
            write_volume(volume, folder_ / "big.nrrd", options);
            _exit(0);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2 + 8 * round));
        kill(-caller, SIGINT);
        int status = 0;
        waitpid(caller, &status, 0);
        interrupted += WIFSIGNALED(status) ? 1 : 0;
        // The helper is not ours to wait for; it has moments to clean up.
        EXPECT_TRUE(support::comes_true([&] { return folder_.names().front()[0] != '.'; }));
        for (const std::string& name : folder_.names()) {
            ASSERT_TRUE(name == "a.nrrd" || name == "big.nrrd") << name << " in round " << round;
        }
        if (std::filesystem::exists(folder_ / "big.nrrd")) {
            EXPECT_TRUE(same_samples(read_volume(folder_ / "big.nrrd").volume, volume));
        }
    }
    EXPECT_GT(interrupted, 0);
}

TEST_F(HelperProcess, the_memory_limit_is_kept_and_said) {
    std::mt19937 random(34);
    Geometry g;
    g.size = Index3(100, 100, 100);
    write_volume(random_volume<std::uint8_t>(random, g), file_);
    ReadOptions options;
    options.memory_limit_bytes = 900000;
    EXPECT_TRUE(contains(refusal(file_, options), "0.001 GB"));
    options.memory_limit_bytes = 1100000;
    EXPECT_EQ(read_volume(file_, options).volume.bytes(), 1000000U);
}

/// Resident memory of this process, shared pages included [bytes].
double resident() {
    std::ifstream statm("/proc/self/statm");
    double size = 0, pages = 0;
    statm >> size >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

TEST_F(HelperProcess, a_loaded_volume_takes_the_memory_of_its_samples_once) {
    if (support::is_slow_build) GTEST_SKIP() << "sanitizers keep bytes of their own for ours";
    Geometry g;
    g.size = Index3(256, 256, 512);
    const double bytes = 2.0 * 256 * 256 * 512;
    {
        std::vector<std::int16_t> samples(256 * 256 * 512);
        for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::int16_t>(i);
        const Volume volume(g, std::move(samples));
        write_volume(volume, file_);
        std::ofstream(folder_ / "a.raw", std::ios::binary)
            .write(static_cast<const char*>(volume.data()), static_cast<long>(volume.bytes()));
    }
    ReadOptions raw;
    raw.raw = RawLayout{g.size, SampleType::int16, Vec3::Ones(), 0};
    for (const auto& [path, options] :
         {std::pair(file_, ReadOptions()), std::pair(folder_ / "a.raw", raw)}) {
        const double before = resident();
        const VolumeFile file = read_volume(path, options);
        const double grown = resident() - before;
        EXPECT_LE(grown, 1.05 * bytes) << path;
        EXPECT_GE(grown, 0.95 * bytes) << path;  // or this would measure nothing
    }
}

}  // namespace
}  // namespace palpate::io::test

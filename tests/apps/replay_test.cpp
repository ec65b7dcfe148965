// palpate replay: the trace that others' scripts read.
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "palpate/io/trace.hpp"
#include "palpate/io/trajectory.hpp"

namespace palpate::app::test {
namespace {

constexpr const char* contract_header =
    "t,hip_x,hip_y,hip_z,scp_x,scp_y,scp_z,force_x,force_y,force_z,density,isovalue,mode,"
    "tetrahedra,update_ns";
const std::string on_sphere = "replay synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv ";

std::vector<std::string> table(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) {
        if (line[0] != '#') lines.push_back(line);
    }
    return lines;
}

std::vector<io::TraceRow> replay(const ScratchFolder& folder, const std::string& options = {}) {
    const Outcome outcome = palpate(folder, on_sphere + options);
    EXPECT_EQ(outcome.status, 0) << options << ": " << outcome.err;
    return io::read_trace(folder / "a.csv");
}

bool same_but_for_time(const io::TraceRow& a, const io::TraceRow& b) {
    return a.t == b.t && a.hip == b.hip && a.scp == b.scp && a.force == b.force &&
           a.density == b.density && a.isovalue == b.isovalue && a.constrained == b.constrained &&
           a.tetrahedra == b.tetrahedra;
}

bool same_but_for_time(const std::vector<io::TraceRow>& a, const std::vector<io::TraceRow>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return same_but_for_time(x, y); });
}

/// With `palpate demo`'s own motion, 1001 rows, as t.csv.
struct DemoFolder : ScratchFolder {
    DemoFolder() {
        succeeds(
            *this,
            "demo synthetic:sphere:24x24x24 --duration 1 --motion press --picture 120 -o demo -q");
        std::filesystem::copy(*this / "demo/trajectory.csv", *this / "t.csv");
    }
};

TEST(Replay, in_real_time_gives_the_same_ticks_of_a_volume_in_memory_and_marks_those_of_a_store) {
    const MotionFolder folder;
    const auto rows = replay(folder, "--wait");
    EXPECT_TRUE(same_but_for_time(rows, replay(folder, "--live")));
    succeeds(folder, "convert -q synthetic:sphere:24x24x24 s.zarr");
    const Outcome live =
        succeeds(folder, "replay s.zarr --trajectory t.csv -o a.csv -i 50% --live");
    const auto lines = table(folder / "a.csv");
    EXPECT_EQ(lines.size(), rows.size() + 1);
    EXPECT_TRUE(contains(lines[0], ",waiting,level"));
    EXPECT_EQ(palpate(folder, on_sphere + "--live --wait").status, 2);
}

TEST(Replay, writes_the_columns_of_the_contract_one_row_per_input_row) {
    const MotionFolder folder;
    replay(folder);
    const auto lines = table(folder / "a.csv");
    ASSERT_EQ(lines.size(), 7U);
    EXPECT_EQ(lines[0], contract_header);
    for (std::size_t i = 1; i < lines.size(); ++i) {
        EXPECT_EQ(std::count(lines[i].begin(), lines[i].end(), ','), 14);
        EXPECT_TRUE(contains(lines[i], ",free,") != contains(lines[i], ",constrained,"));
    }
    EXPECT_TRUE(contains(lines[1], ",free,"));
    EXPECT_TRUE(contains(lines[4], ",constrained,"));
}

TEST(Replay, repeats_the_positions_of_the_hand_bit_for_bit) {
    const DemoFolder folder;
    const auto in = io::read_trajectory(folder / "t.csv");
    const auto out = replay(folder);
    ASSERT_EQ(in.time.size(), 1001U);
    ASSERT_EQ(out.size(), in.time.size());
    int in_contact = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        ASSERT_EQ(out[i].t, in.time[i]);
        ASSERT_EQ(out[i].hip, in.position[i]);
        ASSERT_TRUE(out[i].constrained || out[i].scp == out[i].hip);
        ASSERT_GE(out[i].update_ns, 0);
        in_contact += out[i].constrained;
    }
    EXPECT_GT(in_contact, 100);
    // A replay gives the forces of the demo.
    const auto demo = io::read_trace(folder / "demo/trace.csv");
    ASSERT_EQ(demo.size(), out.size());
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_EQ(demo[i].scp, out[i].scp);
}

TEST(Replay, gives_the_same_twice_but_for_the_times) {
    const DemoFolder folder;
    const auto once = replay(folder, "--path p.csv");
    const std::string path = support::bytes_of(folder / "p.csv");
    const auto twice = replay(folder, "--path q.csv");
    EXPECT_TRUE(same_but_for_time(once, twice));
    EXPECT_EQ(support::bytes_of(folder / "q.csv"), path);
    // A path file changes nothing, and a trace serves as a trajectory.
    EXPECT_TRUE(same_but_for_time(once, replay(folder)));
    std::filesystem::rename(folder / "a.csv", folder / "t.csv");
    EXPECT_TRUE(same_but_for_time(once, replay(folder)));
}

TEST(Replay, force_is_stiffness_times_depth_within_the_limit_from_the_first_tick) {
    const DemoFolder folder;
    for (const auto& [options, stiffness, limit] :
         {std::tuple{"", 0.5, 3.3}, std::tuple{"-k 2", 2.0, 3.3},
          std::tuple{"-k 4 --force-limit 20", 4.0, 20.0},
          std::tuple{"--force-limit 0.25", 0.5, 0.25}, std::tuple{"--force-limit 0", 0.5, 0.0}}) {
        int limited = 0;
        int within = 0;
        for (const io::TraceRow& row : replay(folder, options)) {
            const Vec3 spring = stiffness * (row.scp - row.hip);
            const double length = row.constrained ? spring.norm() : 0;
            const bool too_strong = length > limit;
            const Vec3 wanted = too_strong ? Vec3(spring * (limit / length)) : spring;
            ASSERT_LE((row.force - wanted).norm(), 1e-9) << options << " at " << row.t;
            ASSERT_LE(row.force.norm(), limit * (1 + 1e-12));
            limited += too_strong;
            within += row.constrained && !too_strong;
        }
        EXPECT_GT(limited + within, 100) << options;
        EXPECT_TRUE(limited > 0 || limit >= 1 || limit == 0) << options;
    }
}

TEST(Replay, ramps_the_force_if_asked_to) {
    const ScratchFolder folder;
    support::put_bytes(folder / "t.csv",
                       "t,x,y,z\n0,-20,0,0\n0.001,-6,0,0\n0.002,-6,0,0\n1,-6,0,0\n");
    const auto soft = replay(folder, "--ramp 0.5");
    const auto hard = replay(folder);
    EXPECT_LT(soft[1].force.norm(), 0.1 * hard[1].force.norm());
    EXPECT_EQ(soft[3].force, hard[3].force);
}

TEST(Replay, every_method_and_penetrability_gives_finite_rows) {
    const DemoFolder folder;
    for (const std::string method : {"exact", "paper", "gradient", "gradient-improved"}) {
        for (const std::string giving :
             {"off", "threshold --threshold 0.3", "threshold --threshold 0.3 --minimum 50%",
              "ranges --range 20%:40% --range 60%:70%"}) {
            const auto rows = replay(folder, "--method " + method + " --penetrability " + giving);
            ASSERT_EQ(rows.size(), 1001U);
            for (const io::TraceRow& row : rows) {
                ASSERT_TRUE(row.scp.allFinite() && row.force.allFinite() &&
                            std::isfinite(row.density));
            }
        }
    }
}

TEST(Replay, a_penetrable_surface_gives_way_at_the_threshold) {
    const DemoFolder folder;
    double deepest = 0;
    for (const auto& row : replay(folder)) deepest = std::max(deepest, (row.scp - row.hip).norm());
    EXPECT_GT(deepest, 1.5);
    bool other_level = false;
    for (const auto& row : replay(folder, "--penetrability threshold --threshold 0.5")) {
        ASSERT_LE((row.scp - row.hip).norm(), 0.5 + 1e-9);
        other_level = other_level || row.isovalue != 76.5;
    }
    EXPECT_TRUE(other_level);
}

TEST(Replay, accepts_all_options_of_force_and_method_together) {
    const DemoFolder folder;
    const auto rows = replay(folder,
                             "--friction 0.5,0.3 --magnet 1,0.2 --texture 0.1,2 --damping 0.0005 "
                             "--viscosity 0.0005 --force-rate 1000 --rate 2000 --scale 2 --json");
    EXPECT_EQ(rows.size(), 1001U);
}

TEST(Replay, solid_below_and_a_background_turn_the_body_inside_out) {
    const ScratchFolder folder;
    support::put_bytes(folder / "t.csv",
                       "t,x,y,z\n0,0,0,0\n0.1,-6,0,0\n0.2,-11,0,0\n0.3,-30,0,0\n");
    const auto below = replay(folder, "--solid below");
    EXPECT_FALSE(below[0].constrained);  // the bright inside is free now
    EXPECT_TRUE(below[2].constrained);
    EXPECT_TRUE(below[3].constrained);
    EXPECT_GT(below[3].scp[0], -11);
    // With a dark background a free hand that starts outside stays there.
    const auto walled = replay(folder, "--background 100%");
    EXPECT_TRUE(walled[3].constrained);
    EXPECT_GT(walled[3].scp[0], -13);
}

TEST(Replay, isovalues_in_units_and_in_percent_are_the_same) {
    const MotionFolder folder;
    const auto info =
        nlohmann::json::parse(palpate(folder, "info synthetic:sphere:24x24x24 --json").out);
    const double half = 0.5 * (info["minimum"].get<double>() + info["maximum"].get<double>());
    const auto percent = replay(folder, "--isovalue 50%");
    EXPECT_EQ(percent[0].isovalue, half);
    EXPECT_TRUE(same_but_for_time(percent, replay(folder, "-i " + std::to_string(half))));
}

TEST(Replay, reads_trajectories_with_comments_blank_lines_and_further_columns) {
    const MotionFolder folder;
    const auto plain = replay(folder);
    for (const std::string text :
         {"\xEF\xBB\xBF# by hand\r\nt,x,y,z\r\n0,-20,0.1,0.2\r\n0.001,-12,0.1,0.2\r\n\r\n"
          "0.002,-9,0.3,0.1\r\n# half\r\n0.003,-8,1.5,0.7\r\n0.004,-8,2.5,1.7\r\n"
          "0.005,-20,2.5,1.7",
          "z, grip ,x,t,y\n0.2,1,-20,0,0.1\n0.2,1,-12,1e-3,0.1\n0.1,0,-9,.002,0.3\n"
          "0.7,,-8,3e-3,1.5\n1.7,a,-8,0.004,+2.5\n1.7,b,-20,0.005,2.5\n"}) {
        support::put_bytes(folder / "t.csv", text);
        EXPECT_TRUE(same_but_for_time(plain, replay(folder))) << text;
    }
}

TEST(Replay, accepts_times_of_any_size_and_start) {
    const MotionFolder folder;
    const auto plain = replay(folder);
    const std::vector<std::vector<double>> clocks{
        {1e9, 1e9 + 1, 1e9 + 2, 1e9 + 3, 1e9 + 4, 1e9 + 5}, {-5, -1, 0, 1e-9, 0.5, 1e4}};
    for (const auto& clock : clocks) {
        const auto in = io::read_trajectory(folder / "t.csv");
        std::ostringstream text;
        text.precision(17);
        text << "t,x,y,z\n";
        for (std::size_t i = 0; i < 6; ++i) {
            const Vec3& p = in.position[i];
            text << clock[i] << ',' << p[0] << ',' << p[1] << ',' << p[2] << '\n';
        }
        support::put_bytes(folder / "t.csv", text.str());
        const auto rows = replay(folder);
        ASSERT_EQ(rows.size(), 6U);
        for (std::size_t i = 0; i < 6; ++i) {
            EXPECT_EQ(rows[i].t, clock[i]);
            EXPECT_EQ(rows[i].force, plain[i].force);  // no pause cuts it off
        }
    }
}

TEST(Replay, a_volume_one_voxel_thin_is_felt) {
    const ScratchFolder folder;
    support::put_bytes(folder / "t.csv", "t,x,y,z\n0,-5,0,0\n0.1,0,0,0\n");
    for (const std::string size : {"1x16x16", "16x1x16", "16x16x1", "1x1x16"}) {
        succeeds(folder, "replay synthetic:sphere:" + size + " --trajectory t.csv -o a.csv -i 1%");
        EXPECT_EQ(io::read_trace(folder / "a.csv").size(), 2U);
    }
}

TEST(Replay, the_summary_is_json_for_scripts_and_silent_when_quiet) {
    const MotionFolder folder;
    const auto j = nlohmann::json::parse(palpate(folder, on_sphere + "--json").out);
    EXPECT_EQ(j["ticks"], 6);
    EXPECT_EQ(j["constrained"], 1);
    EXPECT_LE(j["worst_surface_error"], 1e-9);
    EXPECT_EQ(palpate(folder, on_sphere + "--quiet").out, "");
    EXPECT_TRUE(contains(palpate(folder, on_sphere).out, "ticks 6, in contact 1"));
}

TEST(Replay, prints_nothing_else_where_a_table_goes_to_standard_output) {
    const MotionFolder folder;
    const std::string line = "replay synthetic:sphere:24x24x24 --trajectory t.csv ";
    const Outcome trace = palpate(folder, line + "-o -");
    EXPECT_EQ(io::parse_trace(trace.out, "stdout").size(), 6U);
    const Outcome path = palpate(folder, line + "-o a.csv --path -");
    EXPECT_FALSE(contains(path.out, "ticks"));
    EXPECT_TRUE(contains(path.out, "tick,x,y,z\n0,-20,"));
    expect_failure(palpate(folder, line + "-o - --json"), 2, "standard output");
    expect_failure(palpate(folder, line + "-o - --path -"), 2, "two outputs");
    // Standard output is no file that is read.
    expect_failure(palpate(folder, "replay synthetic:sphere:24x24x24 --trajectory - -i 50 -o -"), 3,
                   "-:");
    succeeds(folder, line + "-o /dev/null --path /dev/null");
}

TEST(Replay, an_input_is_never_replaced) {
    const MotionFolder folder;
    const std::string before = support::bytes_of(folder / "t.csv");
    std::filesystem::create_symlink("t.csv", folder / "link.csv");
    std::filesystem::create_hard_link(folder / "t.csv", folder / "hard.csv");
    support::put_bytes(folder / "v.raw", std::string(8, '\7'));
    const std::string line = "replay synthetic:sphere:24x24x24 --trajectory t.csv -o ";
    for (const std::string path : {"a.csv", "./a.csv"}) {
        expect_failure(palpate(folder, line + "a.csv --path " + path), 2, "two outputs");
    }
    for (const std::string name : {"t.csv", "./t.csv", "link.csv", "hard.csv"}) {
        expect_failure(palpate(folder, line + name), 2, "would be replaced");
        expect_failure(palpate(folder, line + "a.csv --path " + name), 2, "would be replaced");
    }
    expect_failure(palpate(folder,
                           "replay v.raw --dims 2x2x2 --type uint8 --trajectory t.csv "
                           "-o v.raw -i 1"),
                   2, "would be replaced");
    EXPECT_EQ(support::bytes_of(folder / "t.csv"), before);
}

TEST(Replay, accepts_file_names_with_blanks_and_quotes) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "it's a \"folder\"");
    put_trajectory(folder, "it's a \"folder\"/my hand.csv");
    succeeds(folder, Words{"replay", "synthetic:sphere:24x24x24", "--trajectory",
                           "it's a \"folder\"/my hand.csv", "--output",
                           "it's a \"folder\"/what it felt.csv"});
    EXPECT_EQ(io::read_trace(folder / "it's a \"folder\"/what it felt.csv").size(), 6U);
}

}  // namespace
}  // namespace palpate::app::test

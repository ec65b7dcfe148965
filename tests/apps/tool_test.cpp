// palpate tool, and replay with a tool: the tables that others' scripts read.
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "palpate/io/csv.hpp"

namespace palpate::app::test {
namespace {

std::vector<std::vector<double>> numbers(const std::filesystem::path& path,
                                         const std::vector<std::string>& names) {
    const std::string text = io::read_text(path);
    io::CsvReader rows(text, path.string());
    std::vector<std::vector<double>> table;
    while (rows.next()) {
        auto& row = table.emplace_back();
        for (const std::string& name : names) row.push_back(rows.number(rows.column(name)));
    }
    return table;
}

/// Presses a turning hand into the ball from above and off its axis.
void put_poses(const ScratchFolder& folder) {
    std::ofstream out(folder / "t.csv");
    out << "t,x,y,z,qw,qx,qy,qz\n";
    for (int i = 0; i < 400; ++i) {
        const double half = 0.2 * std::sin(0.01 * i);
        out << i / 1000.0 << ",1,0," << 12 - 0.02 * i << ',' << std::cos(half) << ",0,"
            << std::sin(half) << ",0\n";
    }
}

TEST(ToolCommand, writes_the_points_of_a_tool_and_says_what_it_is) {
    const ScratchFolder folder;
    const Outcome made = succeeds(folder, "tool sphere:3 --spacing 1 --points p.csv --json");
    const auto json = nlohmann::json::parse(made.out);
    const auto points = numbers(folder / "p.csv", {"x", "y", "z"});
    EXPECT_EQ(json["points"], points.size());
    for (const auto& p : points) EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), 3, 1e-12);
    // The table is a tool again.
    succeeds(folder, "tool p.csv --points q.csv -q");
    EXPECT_EQ(numbers(folder / "q.csv", {"x", "y", "z"}), points);
    expect_failure(palpate(folder, "tool spoon"), 2, "sphere:RADIUS");
    EXPECT_EQ(palpate(folder, "tool missing.csv").status, 3);
}

TEST(ToolReplay, gives_poses_wrenches_and_contacts) {
    const ScratchFolder folder;
    put_poses(folder);
    const Outcome outcome = succeeds(
        folder,
        "replay synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv --tool box:6,2,2 --poses "
        "poses.csv --json");
    const auto trace = numbers(folder / "a.csv",
                               {"scp_x", "scp_y", "scp_z", "proxy_qw", "proxy_qx", "proxy_qy",
                                "proxy_qz", "torque_x", "torque_y", "torque_z", "contacts", "qw"});
    const auto poses = numbers(folder / "poses.csv", {"x", "y", "z", "qw", "qx", "qy", "qz"});
    const auto ticks = numbers(folder / "poses.csv", {"tick"});
    ASSERT_EQ(trace.size(), 400U);
    std::vector<std::vector<double>> last(400);  // pose of each tick
    for (std::size_t i = 0; i < poses.size(); ++i) {
        EXPECT_TRUE(i == 0 || ticks[i][0] >= ticks[i - 1][0]);
        last[static_cast<std::size_t>(ticks[i][0])] = poses[i];
    }
    int touching = 0, twisted = 0;
    for (std::size_t i = 0; i < trace.size(); ++i) {
        EXPECT_EQ(last[i], std::vector(trace[i].begin(), trace[i].begin() + 7)) << i;
        touching += trace[i][10] > 0;
        twisted += std::abs(trace[i][8]) > 1e-3;
    }
    EXPECT_GT(touching, 100);
    EXPECT_GT(twisted, 100);
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_GT(json["largest_torque_nmm"], 0);
    EXPECT_LT(json["worst_surface_error"], 1e-6);

    // The trace is a trajectory again, orientation included.
    succeeds(folder,
             "replay synthetic:sphere:24x24x24 --trajectory a.csv -o b.csv --tool box:6,2,2 -q");
    const auto turns = numbers(folder / "b.csv", {"proxy_qw", "proxy_qy"});
    ASSERT_EQ(turns.size(), trace.size());
    for (std::size_t i = 0; i < turns.size(); ++i) {
        EXPECT_NEAR(turns[i][0], trace[i][3], 1e-6) << i;
        EXPECT_NEAR(turns[i][1], trace[i][5], 1e-6) << i;
    }
}

TEST(ToolReplay, refuses_what_a_tool_cannot_do_and_what_does_nothing) {
    const ScratchFolder folder;
    put_poses(folder);
    const std::string replay = "replay synthetic:sphere:24x24x24 --trajectory t.csv -o a.csv ";
    const auto expect = [&](const std::string& options, int status, const std::string& words) {
        const Outcome outcome = palpate(folder, replay + options);
        EXPECT_EQ(outcome.status, status) << options;
        EXPECT_TRUE(contains(outcome.err, words)) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "a.csv")) << options;
    };
    expect("--tool rod:4 --field linear", 2, "cubic");
    expect("--tool rod:4 --penetrability threshold", 2, "penetrability");
    expect("--tool sphere:9 --tool-spacing 0.01", 2, "--tool-spacing");
    expect("--poses p.csv", 2, "--tool");
    std::ofstream(folder / "t.csv") << "t,x,y,z,qw,qx,qy,qz\n0,0,0,20,2,0,0,0\n";
    expect("--tool rod:4", 3, "quaternion");
    std::ofstream(folder / "t.csv") << "t,x,y,z,qw\n0,0,0,20,1\n";
    expect("--tool rod:4", 3, "qx");
}

}  // namespace
}  // namespace palpate::app::test

// Traces and paths: the contract's columns, and the same doubles when read back.
#include "palpate/io/trace.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "palpate/io/trajectory.hpp"
#include "support/scratch_folder.hpp"

using namespace palpate;
using namespace palpate::io;
using namespace palpate::support;

namespace {

constexpr const char* header =
    "t,hip_x,hip_y,hip_z,scp_x,scp_y,scp_z,force_x,force_y,force_z,"
    "density,isovalue,mode,tetrahedra,update_ns\n";

std::vector<double> numbers_of(const TraceRow& r) {
    return {r.t,      r.hip[0],   r.hip[1],   r.hip[2],   r.scp[0],  r.scp[1],
            r.scp[2], r.force[0], r.force[1], r.force[2], r.density, r.isovalue};
}

/// Any finite double, every exponent alike.
double any_double(std::mt19937_64& random) {
    for (;;) {
        const auto value = std::bit_cast<double>(random());
        if (std::isfinite(value)) return value;
    }
}

std::vector<TraceRow> written_and_read(const std::vector<TraceRow>& rows) {
    const ScratchFolder folder;
    TraceWriter writer(folder / "trace.csv");
    for (const TraceRow& row : rows) writer.add(row);
    writer.commit();
    return read_trace(folder / "trace.csv");
}

}  // namespace

TEST(Trace, has_the_columns_of_the_contract_after_its_comments) {
    const ScratchFolder folder;
    TraceWriter writer(folder / "trace.csv", {"palpate 0.1\nvolume synthetic:cylinder", "k 1"});
    writer.add({.t = 0.001,
                .hip = {1, 2, 3},
                .scp = {4, 5, 6.5},
                .force = {-0.25, 0, 1e-9},
                .density = 300,
                .isovalue = 300.5,
                .constrained = true,
                .tetrahedra = 7,
                .update_ns = 152});
    writer.add({});
    EXPECT_FALSE(std::filesystem::exists(folder / "trace.csv"));
    writer.commit();
    EXPECT_EQ(bytes_of(folder / "trace.csv"),
              "# palpate 0.1\n# volume synthetic:cylinder\n# k 1\n" + std::string(header) +
                  "0.001,1,2,3,4,5,6.5,-0.25,0,1e-09,300,300.5,constrained,7,152\n"
                  "0,0,0,0,0,0,0,0,0,0,0,0,free,0,0\n");
}

TEST(Trace, reads_back_bit_for_bit) {
    std::mt19937_64 random(1);
    std::vector<TraceRow> rows;
    for (int i = 0; i < 2000; ++i) {
        TraceRow row;
        row.t = any_double(random);
        for (Vec3* v : {&row.hip, &row.scp, &row.force}) {
            for (int a = 0; a < 3; ++a) (*v)[a] = any_double(random);
        }
        row.density = any_double(random);
        row.isovalue = -0.0;
        row.constrained = random() & 1;
        row.tetrahedra = static_cast<int>(random() >> 40);
        row.update_ns = static_cast<std::int64_t>(random() >> 1);
        rows.push_back(row);
    }
    const auto read = written_and_read(rows);
    ASSERT_EQ(read.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto expected = numbers_of(rows[i]);
        const auto found = numbers_of(read[i]);
        for (std::size_t n = 0; n < expected.size(); ++n) {
            ASSERT_EQ(std::bit_cast<std::uint64_t>(found[n]),
                      std::bit_cast<std::uint64_t>(expected[n]));
        }
        ASSERT_EQ(read[i].constrained, rows[i].constrained);
        ASSERT_EQ(read[i].tetrahedra, rows[i].tetrahedra);
        ASSERT_EQ(read[i].update_ns, rows[i].update_ns);
    }
}

TEST(Trace, keeps_what_is_not_finite_for_whoever_looks_into_it) {
    TraceRow row;
    row.hip = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
               -std::numeric_limits<double>::infinity()};
    const auto read = written_and_read({row});
    EXPECT_TRUE(std::isnan(read[0].hip[0]));
    EXPECT_EQ(read[0].hip[1], row.hip[1]);
    EXPECT_EQ(read[0].hip[2], row.hip[2]);
}

TEST(Trace, can_be_replayed_as_a_trajectory) {
    const ScratchFolder folder;
    TraceWriter writer(folder / "trace.csv", {"a recording"});
    for (int i = 0; i < 3; ++i) writer.add({.t = i * 1e-3, .hip = {i / 3.0, 1, 2}});
    writer.commit();
    const Trajectory trajectory = read_trajectory(folder / "trace.csv");
    ASSERT_EQ(trajectory.time.size(), 3U);
    EXPECT_EQ(trajectory.time[2], 2e-3);
    EXPECT_EQ(trajectory.position[1], Vec3(1 / 3.0, 1, 2));
}

TEST(Trace, without_rows_reads_back_as_none) {
    EXPECT_TRUE(written_and_read({}).empty());
}

TEST(Trace, that_is_damaged_is_refused_with_its_line) {
    const std::string row = "0,1,2,3,4,5,6,7,8,9,10,11,";
    const auto refusal = [&](const std::string& text) {
        return message_of<InputError>([&] { parse_trace(text, "trace.csv"); });
    };
    EXPECT_TRUE(contains(refusal("t,x,y,z\n"), "no column 'hip_x'"));
    EXPECT_TRUE(contains(refusal(header + row + "stuck,1,2\n"), "line 2: 'stuck' is no mode"));
    EXPECT_TRUE(contains(refusal(header + row + "free,-1,2\n"), "'-1' is no count"));
    EXPECT_TRUE(contains(refusal(header + row + "free,1,2.5\n"), "is not a whole number"));
    EXPECT_TRUE(contains(refusal(header + row + "free,1\n"), "14 cells where the header has 15"));
    EXPECT_EQ(parse_trace(header + row + "free,1,2\n", "trace.csv").size(), 1U);
}

TEST(Trace, path_has_one_row_for_each_corner_in_order) {
    const ScratchFolder folder;
    PathWriter writer(folder / "path.csv", {"millimetres"});
    writer.add(0, {1, 2, 3});
    writer.add(2, {0.1, 1.0 / 3, -1e22});
    writer.add(2, {0, 0, 0});
    writer.commit();
    EXPECT_EQ(bytes_of(folder / "path.csv"),
              "# millimetres\ntick,x,y,z\n0,1,2,3\n2,0.1,0.3333333333333333,-1e+22\n2,0,0,0\n");
}

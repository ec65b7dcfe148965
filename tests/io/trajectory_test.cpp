// Trajectories: forms that people and programs write are read, others are refused with their line.
#include "palpate/io/trajectory.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <limits>

#include "support/scratch_folder.hpp"

using namespace palpate;
using namespace palpate::io;
using namespace palpate::support;

namespace {

Trajectory parse(const std::string& text) {
    return parse_trajectory(text, "hand.csv");
}

std::string why_not_parsed(const std::string& text) {
    const std::string message = message_of<InputError>([&] { parse(text); });
    EXPECT_EQ(message.rfind("hand.csv", 0), 0U) << message;
    for (const char c : message) EXPECT_TRUE(c >= ' ' && c <= '~') << message;
    EXPECT_LT(message.size(), 700U);
    return message;
}

void expect_refusal(const std::string& text, const std::string& part) {
    const std::string message = why_not_parsed(text);
    EXPECT_TRUE(contains(message, part)) << message;
}

}  // namespace

TEST(Trajectory, is_read_by_the_names_of_its_columns) {
    const Trajectory read = parse("z,note,t,y,x\n3,a,0,2,1\n6,,0.001,5,4\n");
    EXPECT_EQ(read.time, (std::vector<double>{0, 0.001}));
    EXPECT_EQ(read.position, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
}

TEST(Trajectory, may_have_comments_blank_lines_spaces_crlf_and_a_byte_order_mark) {
    const Trajectory read = parse(
        "\xEF\xBB\xBF# a hand\r\n\r\n t , x,\ty ,z\r\n#0,0,0,0\r\n -1 , +1.5 ,2e-3, -.5 \r\n   \r\n"
        "0,1,2,3");
    EXPECT_EQ(read.time, (std::vector<double>{-1, 0}));
    EXPECT_EQ(read.position, (std::vector<Vec3>{{1.5, 2e-3, -0.5}, {1, 2, 3}}));
}

TEST(Trajectory, may_have_the_line_ends_of_old_macintoshes) {
    const Trajectory read = parse("# a hand\rt,x,y,z\r\r0,1,2,3\r1,4,5,6\r");
    EXPECT_EQ(read.time, (std::vector<double>{0, 1}));
    EXPECT_EQ(read.position, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
    expect_refusal("t,x,y,z\r\r0,1,2\r", "line 3");
    expect_refusal("t,x,y,z\r\n\r\n0,1,2\r\n", "line 3");
}

TEST(Trajectory, may_have_cells_in_quotes) {
    const Trajectory read = parse("\"\",\"t\" , \"x\",y,\"z\"\n\"a, b\",\"0\",1,\"2\",3\n");
    EXPECT_EQ(read.time, (std::vector<double>{0}));
    EXPECT_EQ(read.position, (std::vector<Vec3>{{1, 2, 3}}));
    for (const std::string row : {"0,1,2,\"3", "0,1,2,\"", "0,\"1,2\",3", "\"0,1,2,3"}) {
        expect_refusal("t,x,y,z\n" + row + "\n", "line 2");
    }
}

TEST(Trajectory, is_read_from_a_trace_by_its_hip) {
    const Trajectory read = parse("t,hip_x,hip_y,hip_z,scp_x,mode\n0,1,2,3,9,free\n");
    EXPECT_EQ(read.position, (std::vector<Vec3>{{1, 2, 3}}));
    // If both are there, the plain names count.
    EXPECT_EQ(parse("t,hip_x,hip_y,hip_z,x,y,z\n0,1,2,3,4,5,6\n").position[0], Vec3(4, 5, 6));
}

TEST(Trajectory, is_read_the_same_in_every_locale) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    std::setlocale(LC_ALL, "de_DE.UTF-8");  // where it is not installed the test shows nothing
    EXPECT_EQ(parse("t,x,y,z\n0.5,1.25,2,3\n").position[0], Vec3(1.25, 2, 3));
    std::setlocale(LC_ALL, before.c_str());
}

TEST(Trajectory, without_a_column_or_rows_says_which_and_where) {
    expect_refusal("", "is empty");
    expect_refusal("\n# only a comment\n", "is empty");
    expect_refusal("t,x,y,z\n", "no rows");
    expect_refusal("t,x,y\n0,1,2\n", "line 1: there is no column 'z'");
    expect_refusal("x,y,z\n0,1,2\n", "there is no column 't'");
    expect_refusal("t;x;y;z\n0;1;2;3\n", "with commas in between");
    expect_refusal("t,hip_x,hip_y\n0,1,2\n", "there is no column 'hip_z'");
    expect_refusal("t,x,y,z,x\n0,1,2,3,4\n", "two columns are named 'x'");
    expect_refusal("0,1,2,3\n1,1,2,3\n", "there is no column 't'");
}

TEST(Trajectory, with_a_bad_cell_names_the_line_and_the_cell) {
    const std::string start = "# c\nt,x,y,z\n0,0,0,0\n";
    expect_refusal(start + "1,two,0,0\n", "line 4: 'two' in column 'x' is not a number");
    expect_refusal(start + "1,,0,0\n", "line 4: '' in column 'x' is not a number");
    expect_refusal(start + "1,0x10,0,0\n", "is not a number");
    expect_refusal(start + "1,1e999,0,0\n", "is not a number");
    expect_refusal(start + "1,+-1,0,0\n", "is not a number");
    expect_refusal(start + "1,0,nan,0\n", "'nan' in column 'y' is not finite");
    expect_refusal(start + "inf,0,0,0\n", "'inf' in column 't' is not finite");
    expect_refusal(start + "1,0,0\n", "line 4: there are 3 cells where the header has 4");
    expect_refusal(start + "1,0,5,0,5,0,5\n", "write decimals with a point");
}

TEST(Trajectory, whose_time_does_not_increase_is_refused) {
    expect_refusal("t,x,y,z\n0,0,0,0\n0.5,0,0,0\n0.5,0,0,0\n",
                   "line 4: the time '0.5' does not come after 0.5");
    expect_refusal("t,x,y,z\n1,0,0,0\n0,0,0,0\n", "line 3: the time '0' does not come after 1");
}

TEST(Trajectory, of_garbage_is_refused_in_one_printable_line) {
    expect_refusal(std::string("\x1f\x8b\x08\0\0\0\0", 7), "is not a text file");
    why_not_parsed("\xff\xfe\xfa\n\x01\x02,\x7f\n");
    why_not_parsed(std::string(3'000'000, 'x'));
    why_not_parsed(std::string(300'000, ','));
    why_not_parsed("t,x,y,z\n0,0,0," + std::string(1'000'000, '9') + "\n");
}

TEST(Trajectory, from_numbers_in_memory_is_checked_as_one_from_text) {
    const std::vector<Vec3> two(2, Vec3(1, 2, 3));
    const auto why = [](std::vector<double> time, std::vector<Vec3> at,
                        std::vector<Quaternion> turns = {}) -> std::string {
        try {
            checked_trajectory(std::move(time), std::move(at), std::move(turns));
        } catch (const std::invalid_argument& e) {
            return e.what();
        }
        return "accepted";
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(why({0, 1}, two), "accepted");
    EXPECT_TRUE(contains(why({}, {}), "at least one"));
    EXPECT_TRUE(contains(why({0}, two), "as many"));
    EXPECT_TRUE(contains(why({0, 0}, two), "row 1: the time does not come after"));
    EXPECT_TRUE(contains(why({0, nan}, two), "row 1: the time is not finite"));
    EXPECT_TRUE(contains(why({0}, {Vec3(nan, 0, 0)}), "row 0: the position"));
    EXPECT_TRUE(contains(why({0}, {Vec3::Zero()}, {Quaternion(2, 0, 0, 0)}), "row 0: qw"));
    const auto unit = checked_trajectory({0}, {Vec3::Zero()}, {Quaternion(1.0001, 0, 0, 0)});
    EXPECT_EQ(unit.orientation[0].w(), 1);
}

TEST(Trajectory, file_that_is_not_there_or_is_a_folder_says_so) {
    const ScratchFolder folder;
    const auto missing = message_of<InputError>([&] { read_trajectory(folder / "none.csv"); });
    EXPECT_TRUE(contains(missing, "cannot be opened: No such file")) << missing;
    const auto is_folder = message_of<InputError>([&] { read_trajectory(folder.path()); });
    EXPECT_TRUE(contains(is_folder, "is a folder")) << is_folder;
    put_bytes(folder / "a.csv", "t,x,y,z\n0,1,2,3\n");
    EXPECT_EQ(read_trajectory(folder / "a.csv").position[0], Vec3(1, 2, 3));
}

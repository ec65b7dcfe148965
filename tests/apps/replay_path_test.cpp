// The path file of palpate replay, checked from the outside: continuous, free all along (G1), and
// on the surface where the trace says so (G2), by values of the field that the test reads itself.
#include "apps/program.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/trace.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/proxy.hpp"
#include "palpate/scenes/motions.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::app::test {
namespace {

constexpr double granted = 1e-9;  // of the range, proxy.hpp
constexpr double samples_per_voxel = 8;

struct Corner {
    std::int64_t tick;
    Vec3 point;
};

std::vector<Corner> read_path(const std::filesystem::path& path) {
    const std::string text = io::read_text(path);
    io::CsvReader rows(text, path.string());
    const std::size_t tick = rows.column("tick");
    const std::size_t x = rows.column("x");
    const std::size_t y = rows.column("y");
    const std::size_t z = rows.column("z");
    std::vector<Corner> corners;
    while (rows.next()) {
        corners.push_back({rows.integer(tick), {rows.number(x), rows.number(y), rows.number(z)}});
    }
    return corners;
}

class PathCheck {
  public:
    PathCheck(const Field& field, double isovalue) : field_(field), isovalue_(isovalue) {}

    void check(const std::vector<io::TraceRow>& trace, const std::vector<Corner>& path) {
        ASSERT_FALSE(path.empty());
        ASSERT_EQ(path.front().tick, 0);
        Vec3 at = path.front().point;  // where the SCP was placed
        std::size_t next = 0;
        for (std::size_t tick = 0; tick < trace.size(); ++tick) {
            for (; next < path.size() && path[next].tick == std::int64_t(tick); ++next) {
                check_segment(at, path[next].point);
                at = path[next].point;
                if (testing::Test::HasFatalFailure()) return;
            }
            ASSERT_EQ(at, trace[tick].scp) << "tick " << tick << " does not end at its SCP";
            check_row(trace[tick]);
            if (testing::Test::HasFatalFailure()) return;
        }
        ASSERT_EQ(next, path.size()) << "ticks out of order, or more than the trace has";
    }

    void expect_was_worth_it() const {
        EXPECT_GT(constrained_, 50);
        EXPECT_GT(samples_, 1000);
    }

  private:
    double excess(const Vec3& p) const {
        return field_.sign() * (value_at(field_, p) - isovalue_) / field_.range();
    }
    void check_segment(const Vec3& a, const Vec3& b) {
        const double voxels = (b - a).norm() / field_.geometry().spacing.minCoeff();
        const int count = 2 + static_cast<int>(voxels * samples_per_voxel);
        for (int i = 0; i <= count; ++i) {
            ASSERT_LE(excess(a + (b - a) * (double(i) / count)), granted) << "G1: in the solid";
        }
        samples_ += count;
    }
    void check_row(const io::TraceRow& row) {
        ASSERT_EQ(row.isovalue, isovalue_);
        ASSERT_NEAR(row.density, value_at(field_, row.scp), granted * field_.range());
        if (!row.constrained) return;
        ASSERT_LE(std::abs(row.density - isovalue_) / field_.range(), granted) << "G2";
        ++constrained_;
    }

    const Field& field_;
    double isovalue_;
    int constrained_ = 0;
    std::int64_t samples_ = 0;
};

struct PathCase {
    std::string volume;
    double isovalue;
    std::string method;
    std::string options = {};
    friend std::ostream& operator<<(std::ostream& out, const PathCase& c) {
        return out << c.volume << " at " << c.isovalue << ", " << c.method << ' ' << c.options;
    }
};

Volume volume_of(const std::string& name) {
    if (name.starts_with("synthetic:")) return scenes::make_volume(name).volume;
    return io::read_volume(data_file(name)).volume;
}

void put_motion(const ScratchFolder& folder, const Field& field, double isovalue) {
    scenes::MotionSettings hand;
    hand.duration_s = 3;
    hand.rate_hz = 500;
    std::ofstream out(folder / "t.csv");
    out.precision(17);
    out << "t,x,y,z\n";
    for (const auto& s : scenes::make_motion("explore", field, isovalue, hand)) {
        out << s.t << ',' << s.position[0] << ',' << s.position[1] << ',' << s.position[2] << '\n';
    }
}

class Path : public testing::TestWithParam<PathCase> {};

TEST_P(Path, is_free_all_along_and_ends_on_the_surface) {
    const PathCase& c = GetParam();
    const bool synthetic = c.volume.starts_with("synthetic:");
    if (!synthetic) SKIP_WITHOUT(c.volume);
    const ScratchFolder folder;
    const Field field(volume_of(c.volume),
                      contains(c.options, "below") ? Solid::below : Solid::above, std::nullopt,
                      c.method == "paper" || contains(c.options, "linear") ? Interpolation::linear
                                                                           : Interpolation::cubic);
    put_motion(folder, field, c.isovalue);
    succeeds(folder, Words{"replay", synthetic ? c.volume : data_file(c.volume).string(), "-i",
                           std::to_string(c.isovalue), "--method", c.method} +
                         words_of("--trajectory t.csv -o a.csv --path p.csv " + c.options));
    PathCheck check(field, c.isovalue);
    check.check(io::read_trace(folder / "a.csv"), read_path(folder / "p.csv"));
    check.expect_was_worth_it();
}

INSTANTIATE_TEST_SUITE_P(
    Replay, Path,
    testing::Values(
        PathCase{"synthetic:noise:48x48x48", 127.5, "exact", "--field linear"},
        PathCase{"synthetic:noise:48x48x48", 127.5, "paper"},
        PathCase{"synthetic:noise:48x48x48", 127.5, "exact", "--field linear --step-budget 2"},
        PathCase{"synthetic:noise:48x48x48", 127.5, "exact", "--field linear --friction 0.6,0.4"},
        PathCase{"synthetic:sphere:32x32x32", 76.5, "exact", "--field linear --solid below"},
        PathCase{"synthetic:noise:48x48x48", 127.5, "exact"},
        PathCase{"synthetic:noise:48x48x48", 127.5, "exact", "--step-budget 2"},
        PathCase{"synthetic:noise:48x48x48", 127.5, "exact", "--friction 0.6,0.4"},
        PathCase{"synthetic:sphere:32x32x32", 76.5, "exact", "--solid below"},
        PathCase{"lobster.nrrd", 35, "exact", "--field linear"},
        PathCase{"lobster.nrrd", 35, "exact"}, PathCase{"lobster.nrrd", 35, "paper"},
        PathCase{"orange.nrrd", 15, "exact", "--field linear"},
        PathCase{"orange.nrrd", 15, "exact"}, PathCase{"orange.nrrd", 15, "paper"},
        PathCase{"daisy_pollen.nrrd", 40, "exact", "--field linear"},
        PathCase{"daisy_pollen.nrrd", 40, "exact"}, PathCase{"daisy_pollen.nrrd", 40, "paper"},
        PathCase{"cthead_unc.nrrd", 500, "exact", "--field linear"},
        PathCase{"cthead_unc.nrrd", 500, "exact"}, PathCase{"cthead_unc.nrrd", 500, "paper"}));

TEST(Path, starts_at_the_recovered_point_of_a_hand_inside_the_body) {
    const ScratchFolder folder;
    support::put_bytes(folder / "t.csv", "t,x,y,z\n0,1,2,0.5\n0.001,1,2,0.5\n");
    succeeds(folder, "replay synthetic:sphere:32x32x32 --trajectory t.csv -o a.csv --path p.csv");
    const Field field(scenes::make_volume("synthetic:sphere:32x32x32").volume, Solid::above,
                      std::nullopt, Interpolation::cubic);
    PathCheck check(field, 76.5);
    const auto trace = io::read_trace(folder / "a.csv");
    check.check(trace, read_path(folder / "p.csv"));
    EXPECT_TRUE(trace[0].constrained);
}

}  // namespace
}  // namespace palpate::app::test

// Files that every demo writes.
#include "apps/palpate/demo_parts.hpp"

#include <fmt/format.h>

#include "io/plot.hpp"
#include "palpate/io/output.hpp"

namespace palpate::app {

namespace fs = std::filesystem;

void add_motion_options(CLI::App& command, std::string& motion, scenes::MotionSettings& hand) {
    command.add_option("--motion", motion, "Motion of the hand")
        ->check(CLI::IsMember(scenes::motion_names()))
        ->capture_default_str();
    command.add_option("--duration", hand.duration_s, "Length [s]")->capture_default_str();
}

io::Trajectory trajectory_of(const std::vector<scenes::HandSample>& samples) {
    io::Trajectory trajectory;
    for (const scenes::HandSample& sample : samples) {
        trajectory.time.push_back(sample.t);
        trajectory.position.push_back(sample.position);
    }
    return trajectory;
}

void write_trajectory(const io::Trajectory& trajectory, const fs::path& path) {
    io::PendingFile file(path);
    file.write("t,x,y,z\n");
    for (std::size_t i = 0; i < trajectory.time.size(); ++i) {
        const Vec3& p = trajectory.position[i];
        file.write(fmt::format("{},{},{},{}\n", trajectory.time[i], p[0], p[1], p[2]));
    }
    file.commit();
}

bool plot_trace(const fs::path& folder, const fs::path& figure, std::size_t rows) {
    constexpr std::size_t most_points = 20'000;  // gnuplot takes a minute for a million
    std::string trace = (folder / "trace.csv").string();
    for (std::size_t at = 0; (at = trace.find('\'', at)) != std::string::npos; at += 2) {
        trace.insert(at, 1, '\'');
    }
    const std::string problem = io::plot(
        fmt::format(
            "set datafile separator ','\nset datafile commentschars '#'\nf = '{}'\nn = {}\n"
            "set multiplot layout 3,1\nset lmargin 12\nset grid\nset key off\n"
            "set ylabel 'depth |SCP - HIP| [mm]'\n"
            "plot f every n using (column('t')):(sqrt((column('scp_x')-column('hip_x'))**2+"
            "(column('scp_y')-column('hip_y'))**2+(column('scp_z')-column('hip_z'))**2)) "
            "with lines lc rgb '#0072B2'\n"
            "set ylabel 'force [N]'\n"
            "plot f every n using (column('t')):(sqrt(column('force_x')**2+column('force_y')**2+"
            "column('force_z')**2)) with lines lc rgb '#D55E00'\n"
            "set ylabel 'density at the SCP'\nset xlabel 'time [s]'\nset key bottom right\n"
            "plot f every n using (column('t')):(column('density')) with lines lc rgb '#009E73' "
            "title "
            "'density', f every n using (column('t')):(column('isovalue')) with lines dt 2 lc rgb "
            "'#000000' title 'isovalue'\nunset multiplot\n",
            trace, 1 + rows / most_points),
        figure);
    return problem.empty();
}

}  // namespace palpate::app

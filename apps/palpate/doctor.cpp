// palpate doctor: the faults of this machine that disturb haptics, and their remedies.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "doctor/report.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/devices/error.hpp"
#include "palpate/io/output.hpp"

namespace palpate::app {
namespace {

struct Options {
    std::string device, report;
    std::optional<double> seconds;
    bool json = false, quiet = false;

    /// A certificate wants ten minutes, a glance ten seconds.
    double duration() const { return seconds.value_or(report.empty() ? 10 : 600); }
};

/// Throws devices::DeviceError with the names of what is missing: exit status 4.
void require_essential(const std::vector<doctor::Fault>& faults) {
    std::string names;
    for (const doctor::Fault& fault : faults) {
        if (fault.essential) names += (names.empty() ? "" : ", ") + fault.name;
    }
    if (!names.empty()) throw devices::DeviceError("essential and missing: " + names);
}

void examine(const Options& options) {
    check_outputs({}, {options.report});
    std::optional<io::PendingFile> file;
    if (!options.report.empty()) file.emplace(options.report);
    doctor::Facts facts = doctor::survey(options.device, stop_if_interrupted);
    if (options.duration() > 0) {
        ProgressBar bar("measuring", options.quiet || options.json);
        facts.latency =
            doctor::measure_latency({options.duration(), !options.report.empty(), [&](double part) {
                                         stop_if_interrupted();
                                         bar.at(part);
                                     }});
    }
    const std::vector<doctor::Fault> faults = doctor::faults_of(facts);
    if (file) {
        const auto date = fmt::format("{:%Y-%m-%dT%H:%MZ}", fmt::gmtime(std::time(nullptr)));
        file->write(doctor::report_of(facts, faults, date));
        file->commit();
    }
    if (options.json) {
        print_json(doctor::json_of(facts, faults));
    } else if (!options.quiet && !is_standard_output(options.report)) {
        fmt::print("{}", doctor::summary_of(facts, faults));
    }
    require_essential(faults);
}

}  // namespace

void add_doctor(CLI::App& app) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(
        "doctor", "Examine this machine, and report its faults with their remedies");
    command->footer(
        "Looks at kernel, priorities, locked memory, processors, clock, graphics, helpers and "
        "devices, and runs the servo\nwith a simulated hand to measure how late it is woken. No "
        "device moves. The exit status is 4 if something essential is\nmissing. With --report the "
        "servo runs for ten minutes under load. Send the report along with a bug "
        "report.\n\nExamples:\n  palpate doctor\n  palpate doctor --device haply\n  palpate doctor "
        "--report report.md");
    command
        ->add_option("--seconds", options->seconds,
                     "Duration of the measurement [s] (default: 10, with --report 600). 0 skips it")
        ->check(from_to(0.0, 86400.0));
    command->add_option("--device", options->device, "This device has to work")
        ->type_name(fmt::format("{{{}}}", fmt::join(devices::device_names(), ",")));
    command
        ->add_option("--report", options->report,
                     "Write a report with a real-time certificate, as Markdown")
        ->type_name("FILE.md");
    command->add_flag("--json", options->json, "Print everything that was found as JSON");
    command->add_flag("--quiet", options->quiet, "Print nothing. The exit status has the result");
    command->callback([options] { examine(*options); });
}

}  // namespace palpate::app

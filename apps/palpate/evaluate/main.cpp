// palpate-evaluate, the program of palpate evaluate: experiments, each with a table, figures, a
// paragraph and checked claims.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/options/source_options.hpp"
#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/evaluation.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/program.hpp"
#include "apps/palpate/progress.hpp"
#include "apps/palpate/result_folder.hpp"
#include "evaluation/machine.hpp"
#include "evaluation/report.hpp"
#include "io/recording/plot.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/io/error.hpp"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

struct EvaluateOptions {
    std::string name;
    std::string output = "palpate-evaluation";
    std::vector<std::string> volumes;
    std::string data;
    evaluation::Options experiment;
    bool json = false;
    bool quiet = false;
};

std::vector<evaluation::Experiment> chosen(const std::string& name) {
    std::vector<evaluation::Experiment> all;
    for (const auto& experiment : evaluation::experiments()) {
        if (name == "all" || name == experiment.name) all.push_back(experiment);
    }
    return all;
}

std::vector<std::string> experiment_names() {
    std::vector<std::string> names;
    for (const auto& experiment : evaluation::experiments()) names.emplace_back(experiment.name);
    names.emplace_back("all");
    return names;
}

void print(const evaluation::Report& report) {
    fmt::print("{}: {}\n{}\n", report.experiment.name, report.experiment.title,
               report.result.paragraph);
    for (const auto& claim : report.result.claims) {
        fmt::print("  {} {} ({})\n", claim.held ? "holds:" : "DOES NOT HOLD:", claim.statement,
                   claim.measured);
    }
    fmt::print("\n");
}

nlohmann::ordered_json json_from(const std::vector<evaluation::Report>& reports) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const auto& report : reports) {
        nlohmann::ordered_json claims = nlohmann::ordered_json::array();
        for (const auto& claim : report.result.claims) {
            claims.push_back({{"statement", claim.statement},
                              {"holds", claim.held},
                              {"measured", claim.measured}});
        }
        json.push_back({{"experiment", report.experiment.name},
                        {"paragraph", report.result.paragraph},
                        {"claims", claims},
                        {"circumstances", report.circumstances}});
    }
    return json;
}

/// The volumes asked for; each experiment gets the same.
void load_subjects(EvaluateOptions& options) {
    for (const std::string& text : options.volumes) {
        options.experiment.subjects.push_back(evaluation::subject_from(text));
    }
    options.experiment.data = options.data;
    if (options.data.empty()) {
        if (const char* data = std::getenv("PALPATE_DATA")) options.experiment.data = data;
    } else if (!fs::is_directory(options.data)) {
        throw std::invalid_argument("--data " + options.data + ": there is no such folder");
    }
}

evaluation::Report run(const evaluation::Experiment& experiment, const EvaluateOptions& options) {
    evaluation::Options chosen_options = options.experiment;
    ProgressBar bar(experiment.name, options.quiet || options.json);
    chosen_options.progress = [&](double fraction) {
        bar.at(fraction);
        stop_if_interrupted();
    };
    chosen_options.note = [&](const std::string& text) {
        if (!options.quiet) fmt::print(stderr, "palpate: note: {}\n", text);
    };
    evaluation::Report report{experiment, experiment.run(chosen_options), ""};
    report.circumstances = fmt::format(
        "{}; seed {}; {}", evaluation::machine_and_date(), chosen_options.seed,
        chosen_options.quick ? "quick mode: too short for the times to mean anything" : "full run");
    return report;
}

void evaluate(EvaluateOptions& options) {
    const auto experiments = chosen(options.name);
    if (!io::can_plot()) {
        throw io::OutputError("figures need gnuplot: install it (apt install gnuplot-nox)");
    }
    load_subjects(options);
    ResultFolder results(options.output);
    std::vector<evaluation::Report> reports;
    std::size_t broken = 0;
    for (const auto& experiment : experiments) {
        try {
            reports.push_back(run(experiment, options));
        } catch (const std::invalid_argument& e) {
            if (experiments.size() == 1) throw;  // of all, the others can still be done
            fmt::print(stderr, "palpate: note: {} is left out: {}\n", experiment.name, e.what());
            continue;
        }
        try {
            write_files(reports.back(), results.part());
        } catch (const io::OutputError&) {
            stop_if_interrupted();  // Ctrl-C reaches gnuplot as well, and its end may be seen first
            throw;
        }
        results.complete();
        if (!options.quiet && !options.json) print(reports.back());
        for (const auto& claim : reports.back().result.claims) broken += !claim.held;
    }
    if (options.name == "all") {
        write_html(reports, options.output, results.part() / "report.html");
        results.complete();
    }
    if (options.json) print_json(json_from(reports));
    if (!options.quiet && !options.json) {
        fmt::print("Results: {}{}\n", options.output,
                   options.name == "all" ? " (open report.html)" : "");
    }
    if (broken > 0) throw ClaimsDoNotHold{broken};
}

}  // namespace

static void add_evaluate(CLI::App& app) {
    auto options = std::make_shared<EvaluateOptions>();
    CLI::App* command = app.add_subcommand(std::string(evaluation_command), evaluation_description);
    command->footer(
        "all runs every experiment and adds report.html, which needs no other file.\n"
        "Exit status 1: a claim does not hold.\n\n"
        "Examples:\n  palpate evaluate drift --output results\n"
        "  palpate evaluate fall-through --volume head.nrrd@34.5 --volume synthetic:torus\n"
        "  palpate evaluate all --quick");
    command->add_option("EXPERIMENT", options->name, "Which experiment, or all")
        ->required()
        ->check(one_of(experiment_names()));
    command->add_option("-o,--output", options->output, "Folder for the results")
        ->type_name("FOLDER")
        ->capture_default_str();
    command
        ->add_option("--volume", options->volumes,
                     "Volume to use instead of the experiment's own; may be given again")
        ->type_name("VOLUME@ISOVALUE")
        ->allow_extra_args(false);
    command
        ->add_option("--data", options->data,
                     "Folder with the real volumes that some experiments use, such as "
                     "lobster.nrrd (default: environment PALPATE_DATA)")
        ->type_name("FOLDER");
    command
        ->add_option("--method", options->experiment.method,
                     "Proxy method, for experiments that show one")
        ->check(one_of(baselines::method_names()))
        ->capture_default_str();
    command->add_option("--seed", options->experiment.seed, "Seed of everything random")
        ->check(count(largest_count))
        ->capture_default_str();
    command->add_flag("--quick", options->experiment.quick,
                      "Seconds instead of minutes; every claim is checked all the same");
    command->add_flag("--json", options->json, "Print paragraphs and claims as JSON");
    command->add_flag("-q,--quiet", options->quiet, "Print nothing");
    command->callback([options] { evaluate(*options); });
}

}  // namespace palpate::app

int main(int argc, char** argv) {
    return palpate::app::run_program(argc, argv, palpate::app::add_evaluate);
}

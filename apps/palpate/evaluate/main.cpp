// palpate-evaluate: the experiments in C++. The Python package palpate.evaluate (`palpate
// evaluate`) starts this program and makes pages from its results.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "apps/options/say.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/evaluation.hpp"
#include "apps/palpate/program.hpp"
#include "evaluation/report.hpp"
#include "io/recording/plot.hpp"
#include "palpate/io/error.hpp"

namespace palpate::app {
namespace {

struct EvaluateOptions {
    std::string name, output, data;
    std::vector<std::string> volumes;
    evaluation::Options experiment;
};

void evaluate(EvaluateOptions& options) {
    if (!io::can_plot()) {
        throw io::OutputError("figures need gnuplot: install it (apt install gnuplot-nox)");
    }
    evaluation::Options& chosen = options.experiment;
    for (const std::string& text : options.volumes) {
        chosen.subjects.push_back(evaluation::subject_from(text));
    }
    chosen.data = options.data;
    chosen.progress = [](double) { stop_if_interrupted(); };
    chosen.note = [](const std::string& text) { say("palpate: note: {}\n", text); };
    const auto found =
        std::ranges::find(evaluation::experiments(), options.name, &evaluation::Experiment::name);
    if (found == evaluation::experiments().end()) {
        throw std::invalid_argument("no experiment in C++ is named " + options.name);
    }
    try {
        write_files(options.name, found->run(chosen), options.output);
    } catch (const io::OutputError&) {
        stop_if_interrupted();  // Ctrl-C reaches gnuplot as well, and its end may be seen first
        throw;
    }
}

}  // namespace

static void add_evaluate(CLI::App& app) {
    auto options = std::make_shared<EvaluateOptions>();
    CLI::App* command = app.add_subcommand(std::string(evaluation_command), evaluation_description);
    command->add_option("EXPERIMENT", options->name)->required();
    command->add_option("--output", options->output)->required();
    command->add_option("--volume", options->volumes)->allow_extra_args(false);
    command->add_option("--data", options->data);
    command->add_option("--method", options->experiment.method);
    command->add_option("--seed", options->experiment.seed);
    command->add_flag("--quick", options->experiment.quick);
    command->callback([options] { evaluate(*options); });
}

}  // namespace palpate::app

int main(int argc, char** argv) {
    return palpate::app::run_program(argc, argv, palpate::app::add_evaluate);
}

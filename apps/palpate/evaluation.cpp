// Finds the program of the experiments.
#include "apps/palpate/evaluation.hpp"

#include <unistd.h>

#include <stdexcept>
#include <string>

#include "io/process/helper_folders.hpp"

namespace palpate::app {

void become_evaluation(char** argv) {
    for (const auto& folder : io::helper_folders()) {
        ::execv((folder / "palpate-evaluate").c_str(), argv);
    }
}

void add_missing_evaluation(CLI::App& app) {
    CLI::App* command = app.add_subcommand(std::string(evaluation_command), evaluation_description);
    command->prefix_command();
    command->callback([] {
        throw std::invalid_argument(
            "palpate evaluate needs the program palpate-evaluate, which is not beside this one: "
            "build all targets, or install Palpate again");
    });
}

}  // namespace palpate::app

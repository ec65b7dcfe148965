// The program `palpate` on Windows: the commands that need neither window nor pictures.
#include <algorithm>

#include "apps/palpate/commands.hpp"
#include "apps/palpate/program.hpp"
#include "apps/palpate/window.hpp"

int main(int argc, char** argv) {
    using namespace palpate::app;
    const Words words{std::max(argc - 2, 0), argv + std::min(argc, 2)};
    return run_program(argc, argv, [&words](CLI::App& app) {
        add_info(app);
        add_replay(app);
        add_extract(app);
        add_touch(app, words);
        add_record(app);
        add_devices(app);
    });
}

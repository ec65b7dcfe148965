// The program `palpate`.
#include <algorithm>
#include <string_view>
#include <utility>

#include "apps/palpate/commands.hpp"
#include "apps/palpate/program.hpp"
#include "apps/palpate/python_commands.hpp"
#include "apps/palpate/window.hpp"
#include "io/system/system.hpp"

int main(int argc, char** argv) {
    palpate::io::return_large_blocks();  // dropped bricks and pieces
    using namespace palpate::app;
    // In `palpate -- info`, the hyphens end the options, of which there are none.
    if (argc > 1 && argv[1] == std::string_view("--")) {
        std::swap(argv[0], argv[1]);
        ++argv, --argc;
    }
    become_python(argc, argv);
    // The words after the command's name, for a command that becomes another program.
    const Words words{std::max(argc - 2, 0), argv + std::min(argc, 2)};
    return run_program(argc, argv, [&words](CLI::App& app) {
        add_demo(app);
        add_info(app);
        add_view(app, words);
        add_touch(app, words);
        add_record(app);
        add_replay(app);
        add_render(app);
        add_extract(app);
        add_convert(app);
        add_tool(app);
        add_devices(app);
        add_doctor(app);
        add_missing_python(app);
    });
}

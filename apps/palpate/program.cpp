// Turns every failure into one clear line and the exit status of the contract.
#include "apps/palpate/program.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <string>

#include "apps/options/exit_status.hpp"
#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/ends.hpp"
#include "palpate/io/output.hpp"

namespace {

using namespace palpate::app;

constexpr int broken_pipe = 13;  // SIGPIPE, which Windows lacks

int finish_output() {
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return done;
    if (reader_has_gone()) return done;  // it has all that it wanted
    return fail("standard output: could not be written", bad_output);
}

/// Help from which the manual is made.
class HelpFormatter : public CLI::Formatter {
  public:
    /// At least two spaces stand between an option and its text.
    std::string make_option(const CLI::Option* option, bool is_positional) const override {
        std::string entry =
            "  " + make_option_name(option, is_positional) + make_option_opts(option);
        const std::size_t width = get_column_width();
        entry += entry.size() + 2 > width ? "\n" + std::string(width, ' ')
                                          : std::string(width - entry.size(), ' ');
        return entry + make_option_desc(option) + "\n";
    }
    /// CLI11 writes a flag that may have a value as --flag{default}.
    std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
        std::string name = CLI::Formatter::make_option_name(option, is_positional);
        if (const auto at = name.find('{'); at != std::string::npos) {
            name = name.substr(0, at) + "[=" + name.substr(at + 1, name.size() - at - 2) + "]";
        }
        return name;
    }
};

int read_and_run(int argc, char** argv, const std::function<void(CLI::App&)>& add_commands) {
    CLI::App app(
        "Touch the surfaces inside volumetric data.\n\nVOLUME is a file (NRRD, MetaImage, NIfTI, "
        "TIFF, VTI, DICOM, raw), a folder with a DICOM series or a TIFF stack,\nor "
        "synthetic:NAME[:WxHxD].",
        "palpate");
    app.formatter(std::make_shared<HelpFormatter>());  // also of the commands that are added
    app.allow_windows_style_options(false);            // a path may begin with a slash there, too
    app.set_version_flag("--version", "palpate " PALPATE_VERSION);
    app.require_subcommand(1);
    app.footer(
        "First steps:\n"
        "  palpate demo                             a simulated hand explores a CT of a head\n"
        "  palpate info head.nrrd                   describes a volume and suggests isovalues\n"
        "  palpate COMMAND --help                   options and an example of each command");
    add_commands(app);
    for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        command->set_version_flag("--version", "palpate " PALPATE_VERSION);
    }
    try {
        refuse_impossible_values(app, argc, argv);
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {  // --help, --version
        (void)app.exit(e);
        std::cout.flush();
        return finish_output();
    } catch (const CLI::ParseError& e) {
        return fail(complaint(app, e), wrong_use);
    }
    return finish_output();
}

}  // namespace

namespace palpate::app {

int run_program(int argc, char** argv, const std::function<void(CLI::App&)>& add_commands) {
    occupy_closed_streams();
    handle_ends(count_interruption);
    try {
        return read_and_run(argc, argv, add_commands);
    } catch (const Interrupted&) {
        return fail("interrupted", status_of_signal(last_interruption()));
    } catch (const palpate::io::ReaderGone&) {
        return status_of_signal(broken_pipe);
    } catch (const std::exception& e) {
        const Failure failure = failure_of(e);
        // Ctrl-C reaches the helper process as well, and its end may be seen first.
        const bool has_ended = dynamic_cast<const palpate::io::WaitEnded*>(&e) != nullptr;
        if ((failure.status == bad_input || has_ended) && interrupted())
            return fail("interrupted", status_of_signal(last_interruption()));
        if (std::ferror(stdout) != 0) {
            return reader_has_gone() ? status_of_signal(broken_pipe) : finish_output();
        }
        return fail(failure.text, failure.status);
    }
}

}  // namespace palpate::app

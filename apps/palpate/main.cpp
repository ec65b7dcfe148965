// The program `palpate`: reads the command line, turns every failure into one clear line and the
// exit status of the contract.
#include <csignal>
#include <cstdio>
#include <new>
#include <stdexcept>

#include "apps/palpate/commands.hpp"
#include "io/error.hpp"

namespace {

enum ExitStatus { done = 0, wrong_use = 2, bad_input = 3, bad_output = 5, stopped = 130 };

volatile std::sig_atomic_t stop_signal = 0;

void on_signal(int number) {
    stop_signal = number;
}

int fail(const char* what, int status) {
    std::fprintf(stderr, "palpate: %s\n", what);
    return status;
}

int run(int argc, char** argv) {
    CLI::App app(
        "Feel the surfaces inside volumetric data.\n\n"
        "VOLUME is a file (NRRD, MetaImage, NIfTI, TIFF, VTI, DICOM, raw), a folder with a DICOM "
        "series or a TIFF stack,\nor synthetic:NAME[:WxHxD].",
        "palpate");
    app.set_version_flag("--version", "palpate " PALPATE_VERSION);
    app.require_subcommand(1);
    app.footer(
        "First steps:\n"
        "  palpate demo                             a simulated hand explores a built-in volume\n"
        "  palpate info head.nrrd                   what a volume is, and which levels to feel\n"
        "  palpate COMMAND --help                   options and an example of each command");
    palpate::app::add_info(app);
    palpate::app::add_replay(app);
    palpate::app::add_extract(app);
    palpate::app::add_demo(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(e);
        std::fprintf(stderr, "palpate: %s (see palpate --help)\n", e.what());
        return wrong_use;
    }
    if (std::fflush(stdout) != 0) return fail("standard output: could not be written", bad_output);
    return done;
}

}  // namespace

namespace palpate::app {

bool interrupted() {
    return stop_signal != 0;
}

void stop_if_interrupted() {
    if (interrupted()) throw Interrupted{};
}

}  // namespace palpate::app

int main(int argc, char** argv) {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    try {
        return run(argc, argv);
    } catch (const palpate::io::InputError& e) {
        return fail(e.what(), bad_input);
    } catch (const palpate::io::OutputError& e) {
        return fail(e.what(), bad_output);
    } catch (const std::invalid_argument& e) {
        return fail(e.what(), wrong_use);
    } catch (const palpate::app::Interrupted&) {
        return fail("interrupted", stopped);
    } catch (const std::bad_alloc&) {
        return fail("not enough memory: use a smaller volume, or one of fewer bits", bad_input);
    } catch (const std::exception& e) {
        return fail(e.what(), bad_input);
    }
}

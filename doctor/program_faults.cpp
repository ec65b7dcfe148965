// Helper programs and graphics.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "doctor/access.hpp"
#include "doctor/faults.hpp"

namespace palpate::doctor {
namespace {

struct Use {
    const char* program;
    const char* fault;
    bool essential;
    const char* without;  ///< what does not work
};
constexpr std::array<Use, 3> uses{{
    {"palpate-io-helper", "helper-io", true, "only synthetic volumes can be used"},
    {"palpate-picture-helper", "helper-pictures", false, "no picture can be drawn"},
    {"palpate-explicit-helper", "helper-explicit", false,
     "the experiment `palpate evaluate scaling` does not run"},
}};

bool draws_by_processor(const std::string& renderer) {
    return std::ranges::any_of(
        std::array{"llvmpipe", "softpipe", "swrast", "Software"},
        [&](const char* word) { return renderer.find(word) != std::string::npos; });
}

void judge_graphics(const Facts& facts, std::vector<Fault>& faults) {
    const Graphics& graphics = facts.graphics;
    if (graphics.pictures.empty()) {
        faults.push_back(
            {"graphics-missing", false,
             "OpenGL without a display does not work (" + graphics.problem + "): no pictures",
             "sudo apt install libegl1 libgl1-mesa-dri"});
    }
    const bool by_card = !graphics.machine.empty() && !draws_by_processor(graphics.machine);
    if (by_card || !facts.machine.has_graphics_card) return;
    for (const Node& node : facts.machine.render_nodes) {
        if (may_open(node, facts.account)) continue;
        faults.push_back({"graphics-permission", false,
                          fmt::format("you may not use the graphics card ({}): the viewer draws "
                                      "with the processors, which delays the servo",
                                      node.path),
                          way_to_node(node, facts)});
        return;
    }
    faults.push_back(
        {"graphics-software", false,
         "there is a graphics card, but no driver draws with it: the viewer uses the processors, "
         "which delays the servo",
         "sudo apt install libgl1-mesa-dri firmware-amd-graphics firmware-misc-nonfree "
         "(or nvidia-driver); reboot"});
}

}  // namespace

std::vector<Fault> program_faults(const Facts& facts) {
    std::vector<Fault> faults;
    for (const Program& program : facts.programs) {
        if (program.problem.empty()) continue;
        const auto* const use =
            std::ranges::find_if(uses, [&](const Use& one) { return program.name == one.program; });
        if (use == uses.end()) continue;
        faults.push_back({use->fault, use->essential,
                          fmt::format("{}: {}; {}", program.name, program.problem, use->without),
                          "install Palpate again, all packages in the same version; in a build "
                          "folder, build all targets"});
    }
    judge_graphics(facts, faults);
    return faults;
}

}  // namespace palpate::doctor

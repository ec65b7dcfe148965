// Summaries of offline rendering as text and JSON.
#include "apps/palpate/offline_summary.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace palpate::app {

std::string summary_text(const run::OfflineSummary& s) {
    return fmt::format(
        "ticks {}, in contact {} ({:.1f} %), out of step budget {}, recovering {}, refused {}\n"
        "largest |density - isovalue| in contact {:.2g} of the data's range\n"
        "largest force {:.3g} N{}\n"
        "tetrahedra per update {:.2f}\n"
        "proxy update [ns]: mean {:.0f}, p50 {}, p99 {}, p99.9 {}, max {}\n",
        s.ticks, s.constrained,
        100.0 * static_cast<double>(s.constrained) / static_cast<double>(s.ticks), s.out_of_budget,
        s.recovering, s.refused, s.worst_surface_error, s.largest_force,
        s.most_contacts == 0 ? std::string()
                             : fmt::format(", torque {:.3g} N mm, most contacts {}",
                                           s.largest_torque, s.most_contacts),
        s.mean_tetrahedra, s.mean_ns, s.p50_ns, s.p99_ns, s.p999_ns, s.max_ns);
}

nlohmann::ordered_json summary_json(const run::OfflineSummary& s) {
    return {{"ticks", s.ticks},
            {"constrained", s.constrained},
            {"out_of_budget", s.out_of_budget},
            {"recovering", s.recovering},
            {"refused", s.refused},
            {"worst_surface_error", s.worst_surface_error},
            {"largest_force_n", s.largest_force},
            {"largest_torque_nmm", s.largest_torque},
            {"most_contacts", s.most_contacts},
            {"mean_tetrahedra", s.mean_tetrahedra},
            {"update_ns",
             {{"mean", s.mean_ns},
              {"p50", s.p50_ns},
              {"p99", s.p99_ns},
              {"p99.9", s.p999_ns},
              {"max", s.max_ns}}}};
}

}  // namespace palpate::app

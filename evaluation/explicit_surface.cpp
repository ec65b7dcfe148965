// Sends the samples and the segments to the helper program, and reads its answer.
#include "evaluation/explicit_surface.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "io/process/helper_process.hpp"

namespace palpate::evaluation {
namespace {

constexpr io::HelperProgram explicit_helper{
    "palpate-explicit-helper", "VTK", "use a smaller volume",
    "close other programs, or use a smaller volume", "use a smaller volume"};

/// [mm] in the grid's axes, from sample (0, 0, 0).
Vec3 in_grid(const Geometry& geometry, const Vec3& physical) {
    return grid_axes_from_physical(geometry, physical - geometry.origin);
}

}  // namespace

ExplicitAnswer explicit_surface(const Subject& subject, const std::vector<Segment>& segments,
                                int repeats, const std::function<void(double)>& progress) {
    const Volume& volume = subject.field.volume();
    const ExplicitRequest request{volume.geometry(), volume.type(), subject.isovalue, repeats,
                                  segments.size()};
    const io::Descriptor memory = io::shared_memory(request.bytes());
    const auto shared = io::map_shared(memory, request.bytes());
    auto* const bytes = static_cast<char*>(shared.get());
    std::memcpy(bytes, volume.data(), volume.bytes());
    auto* const ends = reinterpret_cast<double*>(bytes + request.segments_at());
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Vec3 from = in_grid(request.geometry, segments[i].from);
        const Vec3 to = in_grid(request.geometry, segments[i].to);
        std::copy_n(from.data(), 3, ends + 6 * i);
        std::copy_n(to.data(), 3, ends + 6 * i + 3);
    }
    nlohmann::json asked = json_from(request);
    asked["caller"] = getpid();
    const io::HelperResult result =
        io::run_helper({explicit_helper, {}, {"extract", asked.dump()}, &memory, progress, 600});
    ExplicitAnswer answer;
    answer.failure = result.failure;
    if (!answer.failure.empty()) return answer;
    answer.cost = result.done.get<ExplicitCost>();
    const auto* const hits = reinterpret_cast<const double*>(bytes + request.hits_at());
    answer.hits.assign(hits, hits + segments.size());
    return answer;
}

}  // namespace palpate::evaluation

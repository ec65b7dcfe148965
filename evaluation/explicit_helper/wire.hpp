// How a volume and segments are passed to palpate-explicit-helper, for both sides of the pipe:
//   palpate-explicit-helper extract REQUEST
// REQUEST is JSON of ExplicitRequest. The shared memory (descriptor 3) holds the samples, then
// `segments` times two points of three doubles [mm, grid axes, from sample (0, 0, 0)]. One double
// per segment follows, in which the helper writes how far along it hit the mesh (NaN: not at all).
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/helper/protocol.hpp"

namespace palpate::evaluation {

struct ExplicitRequest {
    Geometry geometry;
    SampleType type = SampleType::uint8;
    double isovalue = 0;
    int repeats = 1;  ///< how often the surface is extracted and the hierarchy built
    std::size_t segments = 0;

    std::size_t samples_bytes() const {
        return static_cast<std::size_t>(sample_count(geometry)) * size_of(type);
    }
    std::size_t segments_at() const { return (samples_bytes() + 15) / 16 * 16; }
    std::size_t hits_at() const { return segments_at() + segments * 6 * sizeof(double); }
    std::size_t bytes() const { return hits_at() + segments * sizeof(double); }
};

inline nlohmann::json json_from(const ExplicitRequest& request) {
    return {{"geometry", io::json_from(request.geometry)},
            {"type", name_of(request.type)},
            {"isovalue", request.isovalue},
            {"repeats", request.repeats},
            {"segments", request.segments}};
}

inline ExplicitRequest request_from(const nlohmann::json& json) {
    return {io::geometry_from(json.at("geometry")),
            sample_type_from(json.at("type").get<std::string>()), json.at("isovalue").get<double>(),
            json.at("repeats").get<int>(), json.at("segments").get<std::size_t>()};
}

/// What the helper answers. NaN: not measured.
struct ExplicitCost {
    double extraction_s = std::nan(""), tree_s = std::nan("");  ///< the least of the repeats
    double cpu_s = std::nan("");  ///< of both, all threads together: the least of the repeats
    double vertices = std::nan(""), triangles = std::nan("");
    double mesh_bytes = std::nan("");  ///< 12 a vertex and 12 a triangle
    double tree_bytes = std::nan("");  ///< of Embree's hierarchy
    double peak_bytes = std::nan("");  ///< growth of the process while it extracts and builds,
                                       ///< without the samples
    double query_ns = std::nan("");    ///< mean over the segments, the least of the passes
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExplicitCost, extraction_s, tree_s, cpu_s, vertices, triangles,
                                   mesh_bytes, tree_bytes, peak_bytes, query_ns)

}  // namespace palpate::evaluation

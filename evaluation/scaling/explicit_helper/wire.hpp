// How a volume and segments cross to palpate-explicit-helper, in one place so that both agree:
//   palpate-explicit-helper extract REQUEST
// REQUEST is JSON of what Request holds. The shared memory (descriptor 3) holds the samples, then
// `segments` times two points of three doubles [mm, grid axes, from sample (0, 0, 0)], then as many
// doubles for how far along each the mesh was hit (NaN: not at all), which the helper writes.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "io/helper/protocol.hpp"

namespace palpate::evaluation {

struct ExplicitRequest {
    Geometry geometry;
    SampleType type = SampleType::uint8;
    double isovalue = 0;
    int repeats = 1;  ///< so often it is extracted and built anew
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

/// What comes back.
struct ExplicitCost {
    double extraction_s = 0, tree_s = 0;  ///< the least of the repeats
    double cpu_s = 0;  ///< of both, all threads together: the least of the repeats
    std::int64_t vertices = 0, triangles = 0;
    double mesh_bytes = 0;  ///< 12 a vertex and 12 a triangle
    double tree_bytes = 0;
    double peak_bytes = 0;  ///< growth of the process while it extracts and builds, samples not
                            ///< counted
    double query_ns = 0;    ///< mean over the segments, the least of the passes
};

inline nlohmann::json json_from(const ExplicitCost& cost) {
    return {{"extraction_s", cost.extraction_s},
            {"tree_s", cost.tree_s},
            {"cpu_s", cost.cpu_s},
            {"vertices", cost.vertices},
            {"triangles", cost.triangles},
            {"mesh_bytes", cost.mesh_bytes},
            {"tree_bytes", cost.tree_bytes},
            {"peak_bytes", cost.peak_bytes},
            {"query_ns", cost.query_ns}};
}

inline ExplicitCost cost_from(const nlohmann::json& json) {
    return {json.at("extraction_s").get<double>(),    json.at("tree_s").get<double>(),
            json.at("cpu_s").get<double>(),           json.at("vertices").get<std::int64_t>(),
            json.at("triangles").get<std::int64_t>(), json.at("mesh_bytes").get<double>(),
            json.at("tree_bytes").get<double>(),      json.at("peak_bytes").get<double>(),
            json.at("query_ns").get<double>()};
}

}  // namespace palpate::evaluation

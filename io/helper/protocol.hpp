// The protocol between the library and its helper, a program that becomes another where it needs a
// library (own_program.cpp).
//   palpate-io-helper read PATH REQUEST       samples come back in descriptor 3
//   palpate-io-helper locate PATH REQUEST     says where the samples lie in their file, or, of the
//                                             "headers" in the REQUEST, which files they name
//   palpate-io-helper explore PATH REQUEST    answers questions about a file of chunks
//   palpate-io-helper read-mesh PATH REQUEST  vertices and triangles come back in descriptor 3
//   palpate-io-helper write PATH REQUEST FOLDER   samples are given in descriptor 3; FOLDER, beside
//                                             PATH, is created for the unfinished file and removed
// REQUEST is JSON, with "own_memory": the bytes that the helper may allocate for itself.
// Lines of JSON come back on descriptor 4: {"progress":0.5}, {"doing":"a file"},
// and at the end {"error":"..."} or {"done":{...}}. Doubles in JSON survive to the bit.
// {"placing":true} comes before the written file gets its name. After that, the caller waits for
// the end.
// Who explores lives until descriptor 3, a socket, is closed. From there it reads lines of JSON:
// {"channel":0,"time":0} asks what image is in the file,
// {"array":"...","first":[...],"count":[...]} where chunks lie. With "size" in the REQUEST the file
// lies elsewhere: {"read":[offset,length]} asks for at most a page of it, whose bytes then come
// from descriptor 3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "palpate/io/orientation.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

constexpr int samples_descriptor = 3;
constexpr int report_descriptor = 4;
constexpr std::uint64_t far_page = std::uint64_t{256} << 10;  // [bytes]

inline nlohmann::json json_from(const Vec3& v) {
    return {v[0], v[1], v[2]};
}

inline Vec3 vec3_from(const nlohmann::json& j) {
    return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

inline nlohmann::json json_from(const Geometry& g) {
    return {{"size", {g.size[0], g.size[1], g.size[2]}},
            {"spacing", json_from(g.spacing)},
            {"origin", json_from(g.origin)},
            {"oriented", g.oriented},
            {"measured", g.measured},
            {"axes",
             {json_from(Vec3(g.direction.col(0))), json_from(Vec3(g.direction.col(1))),
              json_from(Vec3(g.direction.col(2)))}}};
}

inline Geometry geometry_from(const nlohmann::json& j) {
    Geometry g;
    for (int i = 0; i < 3; ++i) {
        g.size[i] = j.at("size").at(static_cast<std::size_t>(i)).get<int>();
        g.direction.col(i) = vec3_from(j.at("axes").at(static_cast<std::size_t>(i)));
    }
    g.spacing = vec3_from(j.at("spacing"));
    g.origin = vec3_from(j.at("origin"));
    g.oriented = j.at("oriented").get<bool>();
    g.measured = j.at("measured").get<bool>();
    return g;
}

/// Puts into a request what is used instead of the file's, and takes it out again.
inline void add_to(nlohmann::json& request, const GivenGrid& given) {
    if (given.spacing) request["spacing"] = json_from(*given.spacing);
    if (!given.orientation.empty()) request["orientation"] = given.orientation;
}
inline GivenGrid grid_from(const nlohmann::json& request) {
    GivenGrid given{{}, request.value("orientation", std::string())};
    if (request.contains("spacing")) given.spacing = vec3_from(request["spacing"]);
    return given;
}

/// Bytes of a mesh in shared memory: vertices of three doubles, triangles of three 32-bit numbers.
constexpr std::size_t mesh_bytes(std::int64_t vertices, std::int64_t triangles) {
    return static_cast<std::size_t>(vertices) * 24 + static_cast<std::size_t>(triangles) * 12;
}

/// One line, whatever bytes a file's name or a library's message has.
inline std::string line_from(const nlohmann::json& j) {
    return j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace palpate::io

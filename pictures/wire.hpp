// How a scene is passed to the helper program and the picture comes back, for both sides. The
// shared memory (descriptor 3) holds:
//   8 bytes      length of the JSON text that follows
//   JSON         the scene; a surface's arrays are {"at": byte offset, "count": elements}
//   arrays       each at a multiple of 16: positions and normals 3 x float32 a vertex, positions
//                relative to the camera's focus; triangles 3 x uint32
//   PNG          appended by the helper, which reports {"done": {"at": ..., "bytes": ...}}
// The job `graphics` draws nothing and needs no memory; it reports {"done": {"renderer": ...}}.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "io/helper/protocol.hpp"
#include "pictures/scene.hpp"

namespace palpate::pictures {

/// Where an array lies in the shared memory.
struct Extent {
    std::size_t at = 0, count = 0;
};
struct SurfaceArrays {
    Extent positions, normals, triangles;
};

constexpr std::size_t array_alignment = 16;
constexpr std::size_t element_bytes = 12;  // of each of the three arrays

inline std::size_t aligned(std::size_t at) {
    return (at + array_alignment - 1) / array_alignment * array_alignment;
}

using nlohmann::json;

inline json json_from(const Colour& c) {
    return {c.red, c.green, c.blue};
}
inline Colour colour_from(const json& j) {
    return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}
inline json json_from(const Extent& e) {
    return {{"at", e.at}, {"count", e.count}};
}
inline Extent extent_from(const json& j) {
    return {j.at("at").get<std::size_t>(), j.at("count").get<std::size_t>()};
}
inline json json_from(const std::vector<Vec3>& points) {
    json list = json::array();
    for (const Vec3& p : points) list.push_back(io::json_from(p));
    return list;
}
inline std::vector<Vec3> points_from(const json& j) {
    std::vector<Vec3> points;
    for (const json& p : j) points.push_back(io::vec3_from(p));
    return points;
}

/// Everything but the meshes, whose arrays are told by where they lie.
inline json json_from(const PictureScene& scene, const std::vector<SurfaceArrays>& arrays) {
    json surfaces = json::array(), balls = json::array(), lines = json::array();
    json springs = json::array(), arrows = json::array();
    for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
        const Surface& s = scene.surfaces[i];
        surfaces.push_back({{"colour", json_from(s.colour)},
                            {"opacity", s.opacity},
                            {"label", s.label},
                            {"positions", json_from(arrays[i].positions)},
                            {"normals", json_from(arrays[i].normals)},
                            {"triangles", json_from(arrays[i].triangles)}});
    }
    for (const Ball& b : scene.balls) {
        balls.push_back({{"centre", io::json_from(b.centre)},
                         {"radius", b.radius},
                         {"colour", json_from(b.colour)},
                         {"label", b.label}});
    }
    for (const Line& l : scene.lines) {
        lines.push_back({{"points", json_from(l.points)},
                         {"radius", l.radius},
                         {"colour", json_from(l.colour)},
                         {"label", l.label}});
    }
    const auto stretched = [](const auto& s) {
        return json{{"from", io::json_from(s.from)},
                    {"to", io::json_from(s.to)},
                    {"radius", s.radius},
                    {"colour", json_from(s.colour)},
                    {"label", s.label}};
    };
    for (const Spring& s : scene.springs) springs.push_back(stretched(s));
    for (const Arrow& a : scene.arrows) arrows.push_back(stretched(a));
    return {{"surfaces", surfaces},
            {"balls", balls},
            {"lines", lines},
            {"springs", springs},
            {"arrows", arrows},
            {"focus", io::json_from(scene.camera.focus)},
            {"towards_viewer", io::json_from(scene.camera.towards_viewer)},
            {"up", io::json_from(scene.camera.up)},
            {"half_height", scene.camera.half_height},
            {"width", scene.width},
            {"height", scene.height},
            {"title", scene.title},
            {"legend", scene.legend},
            {"orientation", scene.orientation},
            {"oriented", scene.oriented},
            {"scale_bar", scene.scale_bar}};
}

/// The inverse; the surfaces come without meshes, their arrays in the same order.
inline PictureScene scene_from(const json& j, std::vector<SurfaceArrays>& arrays) {
    PictureScene scene;
    for (const json& s : j.at("surfaces")) {
        scene.surfaces.push_back({{},
                                  {},
                                  colour_from(s.at("colour")),
                                  s.at("opacity").get<double>(),
                                  s.at("label").get<std::string>()});
        arrays.push_back({extent_from(s.at("positions")), extent_from(s.at("normals")),
                          extent_from(s.at("triangles"))});
    }
    const auto radius = [](const json& o) { return o.at("radius").get<double>(); };
    const auto colour = [](const json& o) { return colour_from(o.at("colour")); };
    const auto label = [](const json& o) { return o.at("label").get<std::string>(); };
    for (const json& b : j.at("balls")) {
        scene.balls.push_back({io::vec3_from(b.at("centre")), radius(b), colour(b), label(b)});
    }
    for (const json& l : j.at("lines")) {
        scene.lines.push_back({points_from(l.at("points")), radius(l), colour(l), label(l)});
    }
    for (const json& s : j.at("springs")) {
        scene.springs.push_back({io::vec3_from(s.at("from")), io::vec3_from(s.at("to")), radius(s),
                                 colour(s), label(s)});
    }
    for (const json& a : j.at("arrows")) {
        scene.arrows.push_back({io::vec3_from(a.at("from")), io::vec3_from(a.at("to")), radius(a),
                                colour(a), label(a)});
    }
    scene.camera = {io::vec3_from(j.at("focus")), io::vec3_from(j.at("towards_viewer")),
                    io::vec3_from(j.at("up")), j.at("half_height").get<double>()};
    scene.width = j.at("width").get<int>();
    scene.height = j.at("height").get<int>();
    scene.title = j.at("title").get<std::string>();
    scene.legend = j.at("legend").get<bool>();
    scene.orientation = j.at("orientation").get<bool>();
    scene.oriented = j.at("oriented").get<bool>();
    scene.scale_bar = j.at("scale_bar").get<bool>();
    return scene;
}

}  // namespace palpate::pictures

// Passes a scene to the helper in shared memory and reads the PNG from it.
#include "pictures/picture.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <stdexcept>
#include <system_error>

#include "io/process/helper_process.hpp"
#include "palpate/io/output.hpp"
#include "pictures/surface.hpp"
#include "pictures/wire.hpp"

namespace palpate::pictures {
namespace {

constexpr io::HelperProgram picture_helper{
    "palpate-picture-helper", "OpenGL or VTK",
    "install libegl1 and libgl1-mesa-dri, or draw a smaller picture",
    "close other programs, or draw a smaller picture of a smaller volume",
    "draw a smaller picture of a smaller volume"};

[[noreturn]] void fail(const std::string& why) {
    throw io::OutputError("the picture could not be drawn: " + why);
}

bool finite(const Vec3& v) {
    return v.allFinite();
}

void check(const Surface& surface) {
    const std::size_t vertices = surface.mesh.vertices.size();
    if (!surface.normals.empty() && surface.normals.size() != vertices) {
        throw std::invalid_argument("a picture's surface needs a normal a vertex, or none");
    }
    if (!(surface.opacity > 0 && surface.opacity <= 1)) {
        throw std::invalid_argument("an opacity is above 0 and at most 1");
    }
    for (const Vec3& v : surface.mesh.vertices) {
        if (!finite(v)) throw std::invalid_argument("a vertex of the picture is not finite");
    }
    for (const auto& triangle : surface.mesh.triangles) {
        for (const std::uint32_t v : triangle) {
            if (v >= vertices) throw std::invalid_argument("a triangle has no such vertex");
        }
    }
}

/// `of` gives the points of one of the scene's objects; `size` its radius.
void check_object(std::span<const Vec3> points, double radius) {
    for (const Vec3& p : points) {
        if (!finite(p)) throw std::invalid_argument("a point of the picture is not finite");
    }
    if (!(radius > 0) || !std::isfinite(radius)) {
        throw std::invalid_argument("a radius in the picture has to be above 0");
    }
}

void check(const PictureScene& scene) {
    if (scene.width < 16 || scene.height < 16 || scene.width > 8192 || scene.height > 8192) {
        throw std::invalid_argument("a picture is 16 to 8192 pixels wide and high");
    }
    const Camera& c = scene.camera;
    if (!finite(c.focus) || !finite(c.towards_viewer) || !finite(c.up) ||
        !(c.towards_viewer.cross(c.up).norm() > 1e-6 * c.towards_viewer.norm() * c.up.norm()) ||
        !(c.half_height > 0) || !std::isfinite(c.half_height)) {
        throw std::invalid_argument("the picture's camera looks nowhere");
    }
    std::size_t triangles = 0;
    for (const Surface& surface : scene.surfaces) {
        check(surface);
        triangles += surface.mesh.triangles.size();
    }
    if (triangles > most_triangles) {
        throw std::invalid_argument("the picture has " + std::to_string(triangles) +
                                    " triangles; at most " + std::to_string(most_triangles) +
                                    " can be drawn");
    }
    for (const Ball& b : scene.balls) check_object({&b.centre, 1}, b.radius);
    for (const Line& l : scene.lines) check_object(l.points, l.radius);
    for (const Spring& s : scene.springs) check_object(std::array{s.from, s.to}, s.radius);
    for (const Arrow& a : scene.arrows) check_object(std::array{a.from, a.to}, a.radius);
}

/// Lays out the arrays behind a text of `text` bytes, and returns their end.
std::size_t lay_out(const PictureScene& scene, std::size_t text,
                    std::vector<SurfaceArrays>& arrays) {
    std::size_t at = sizeof(std::uint64_t) + text;
    const auto place = [&](std::size_t count) {
        const Extent extent{aligned(at), count};
        at = extent.at + count * element_bytes;
        return extent;
    };
    arrays.clear();
    for (const Surface& s : scene.surfaces) {
        const std::size_t vertices = s.mesh.vertices.size();
        arrays.push_back({place(vertices), place(vertices), place(s.mesh.triangles.size())});
    }
    return at;
}

/// The text's length decides where the arrays begin, and where they begin is in the text: so room
/// is left for the longest numbers.
io::Descriptor packed(const PictureScene& scene) {
    std::vector<SurfaceArrays> arrays;
    lay_out(scene, 0, arrays);
    const std::size_t room = io::line_from(json_from(scene, arrays)).size() + 4096 +
                             arrays.size() * 3 * std::numeric_limits<std::size_t>::digits10;
    const std::size_t bytes = lay_out(scene, room, arrays);
    std::string text = io::line_from(json_from(scene, arrays));
    text.resize(room, ' ');
    io::Descriptor memory = io::shared_memory(bytes);
    const auto mapped = io::map_shared(memory, bytes);
    auto* const to = static_cast<char*>(mapped.get());
    const std::uint64_t length = room;
    std::memcpy(to, &length, sizeof length);
    std::memcpy(to + sizeof length, text.data(), room);
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        const Surface& s = scene.surfaces[i];
        auto* position = reinterpret_cast<Eigen::Vector3f*>(to + arrays[i].positions.at);
        for (const Vec3& v : s.mesh.vertices) {
            *position++ = (v - scene.camera.focus).cast<float>();
        }
        const auto put = [to](const Extent& where, const auto& elements) {
            static_assert(sizeof elements[0] == element_bytes);
            if (elements.empty()) return;  // of which memcpy may not be told
            std::memcpy(to + where.at, elements.data(), elements.size() * element_bytes);
        };
        put(arrays[i].normals, s.normals.empty() ? mesh_normals(s.mesh) : s.normals);
        put(arrays[i].triangles, s.mesh.triangles);
    }
    return memory;
}

std::string png_from(const io::Descriptor& memory, const json& done) {
    const auto at = done.at("at").get<std::size_t>();
    const auto bytes = done.at("bytes").get<std::size_t>();
    struct stat status {};
    if (fstat(memory.number(), &status) != 0 || bytes == 0 ||
        static_cast<std::size_t>(status.st_size) < bytes ||
        static_cast<std::size_t>(status.st_size) - bytes < at) {
        fail("the helper process gave no picture");
    }
    std::string png(bytes, '\0');
    std::size_t got = 0;
    while (got < bytes) {
        const ssize_t n =
            pread(memory.number(), png.data() + got, bytes - got, static_cast<off_t>(at + got));
        if (n <= 0) fail("the helper's picture could not be read");
        got += static_cast<std::size_t>(n);
    }
    return png;
}

/// `read` turns the helper's answer into the result.
template <class Read>
std::string answer_to(const char* job, json asked, const io::Descriptor* memory,
                      const DrawOptions& options, const Read& read) {
    asked["caller"] = getpid();
    const io::HelperResult result = io::run_helper({picture_helper,
                                                    options.helper,
                                                    {job, io::line_from(asked)},
                                                    memory,
                                                    [&](double) { options.waiting(); },
                                                    options.time_limit_s});
    if (!result.failure.empty()) fail(result.failure);
    try {
        return read(result.done);
    } catch (const nlohmann::json::exception&) {
        fail(
            "the helper process gave no sensible answer; check that palpate-picture-helper belongs "
            "to this version of Palpate");
    }
}

}  // namespace

std::string png_of(const PictureScene& scene, const DrawOptions& options) {
    check(scene);
    try {
        const io::Descriptor memory = packed(scene);
        return answer_to("draw", json::object(), &memory, options,
                         [&](const json& done) { return png_from(memory, done); });
    } catch (const std::system_error& e) {
        fail(e.what());
    }
}

std::string renderer_name(bool machine, const DrawOptions& options) {
    return answer_to("graphics", {{"machine", machine}}, nullptr, options,
                     [](const json& done) { return done.at("renderer").get<std::string>(); });
}

void draw_picture(const PictureScene& scene, const std::filesystem::path& png,
                  const DrawOptions& options) {
    io::PendingFile file(png);
    file.write(png_of(scene, options));
    file.commit();
}

}  // namespace palpate::pictures

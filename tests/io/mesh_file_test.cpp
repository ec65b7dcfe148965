// Mesh files hold the mesh, byte for byte, and fail loudly.
#include "palpate/io/mesh_file.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <limits>
#include <sstream>

#include "palpate/io/error.hpp"
#include "support/scratch_folder.hpp"

using namespace palpate;
using namespace palpate::io;
using namespace palpate::support;

namespace {

/// A tetrahedron at places that 32-bit floats cannot hold.
SurfaceMesh example() {
    SurfaceMesh mesh;
    mesh.vertices = {{1.0 / 3, -1e-7, 123.456789012345}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e3}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return mesh;
}

std::string written(const SurfaceMesh& mesh, const std::string& name) {
    const ScratchFolder folder;
    write_mesh(mesh, folder / name);
    EXPECT_EQ(folder.names(), std::vector<std::string>{name});
    return bytes_of(folder / name);
}

template <class T>
T take(std::string_view& bytes) {
    T value{};
    EXPECT_GE(bytes.size(), sizeof value);
    if (bytes.size() < sizeof value) return value;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes.remove_prefix(sizeof value);
    return value;
}

Vec3 take_vec3(std::string_view& bytes) {
    Vec3 v;
    for (int a = 0; a < 3; ++a) v[a] = take<double>(bytes);
    return v;
}

}  // namespace

TEST(MeshFile, writing_reports_progress_and_leaves_nothing_where_it_is_stopped) {
    SurfaceMesh mesh = example();
    mesh.vertices.resize(200'000, Vec3::Ones());
    mesh.triangles.resize(200'000, {0, 1, 2});
    for (const char* name : {"a.ply", "a.stl", "a.obj", "a.vtp"}) {
        const ScratchFolder folder;
        double last = 0;
        write_mesh(mesh, folder / name, [&](double fraction) {
            EXPECT_GT(fraction, 0) << name;
            EXPECT_LE(fraction, 1) << name;
            last = fraction;
        });
        EXPECT_GT(last, 0.25) << name;  // lines of an OBJ are short here
        const auto stop = [](double) { throw std::runtime_error("stopped"); };
        EXPECT_THROW(write_mesh(mesh, folder / (std::string("b") + name), stop), std::runtime_error)
            << name;
        EXPECT_EQ(folder.names(), std::vector<std::string>{name});
    }
}

TEST(MeshFile, ply_holds_every_double_and_index) {
    const SurfaceMesh mesh = example();
    const std::string file = written(mesh, "a.ply");
    const std::string end = "end_header\n";
    const auto header = file.substr(0, file.find(end) + end.size());
    EXPECT_EQ(header.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0U);
    EXPECT_TRUE(contains(header, "element vertex 4\nproperty double x\n"));
    EXPECT_TRUE(contains(header, "element face 4\nproperty list uchar uint vertex_indices\n"));
    std::string_view rest = std::string_view(file).substr(header.size());
    for (const Vec3& v : mesh.vertices) EXPECT_EQ(take_vec3(rest), v);
    for (const auto& triangle : mesh.triangles) {
        EXPECT_EQ(take<std::uint8_t>(rest), 3);
        for (const auto index : triangle) EXPECT_EQ(take<std::uint32_t>(rest), index);
    }
    EXPECT_TRUE(rest.empty());
}

TEST(MeshFile, stl_holds_each_triangle_with_its_outward_normal) {
    const SurfaceMesh mesh = example();
    const std::string file = written(mesh, "a.STL");
    EXPECT_EQ(file.size(), 84 + 50 * mesh.triangles.size());
    EXPECT_NE(file.substr(0, 5), "solid");
    std::string_view rest = std::string_view(file).substr(80);
    EXPECT_EQ(take<std::uint32_t>(rest), 4U);
    for (const auto& triangle : mesh.triangles) {
        Vec3 normal;
        for (int a = 0; a < 3; ++a) normal[a] = take<float>(rest);
        EXPECT_NEAR(normal.norm(), 1, 1e-6);
        for (const auto index : triangle) {
            for (int a = 0; a < 3; ++a) {
                EXPECT_EQ(take<float>(rest), static_cast<float>(mesh.vertices[index][a]));
            }
        }
        EXPECT_EQ(take<std::uint16_t>(rest), 0);
        const Vec3& p = mesh.vertices[triangle[0]];
        const Vec3 n = (mesh.vertices[triangle[1]] - p).cross(mesh.vertices[triangle[2]] - p);
        EXPECT_GT(n.dot(normal), 0);
    }
}

TEST(MeshFile, obj_reads_back_as_the_same_doubles) {
    const SurfaceMesh mesh = example();
    std::istringstream lines(written(mesh, "a.obj"));
    std::string line;
    SurfaceMesh read;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            std::array<std::string, 3> number;
            words >> number[0] >> number[1] >> number[2];
            read.vertices.emplace_back(std::stod(number[0]), std::stod(number[1]),
                                       std::stod(number[2]));
        } else if (kind == "f") {
            std::array<std::uint32_t, 3> t{};
            words >> t[0] >> t[1] >> t[2];
            read.triangles.push_back({t[0] - 1, t[1] - 1, t[2] - 1});
        }
    }
    EXPECT_EQ(read.vertices, mesh.vertices);
    EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(MeshFile, vtp_holds_every_array_where_its_header_says) {
    const SurfaceMesh mesh = example();
    const std::string file = written(mesh, "a.vtp");
    EXPECT_TRUE(contains(file, "NumberOfPoints=\"4\""));
    EXPECT_TRUE(contains(file, "NumberOfPolys=\"4\""));
    EXPECT_TRUE(contains(file, "offset=\"0\""));
    EXPECT_TRUE(contains(file, "offset=\"104\""));  // 8 + 4 vertices of 24 bytes
    EXPECT_TRUE(contains(file, "offset=\"160\""));  // and 8 + 12 corners of 4 bytes
    const std::string start = "<AppendedData encoding=\"raw\">\n_";
    std::string_view rest = std::string_view(file).substr(file.find(start) + start.size());
    EXPECT_EQ(take<std::uint64_t>(rest), 96U);
    for (const Vec3& v : mesh.vertices) EXPECT_EQ(take_vec3(rest), v);
    EXPECT_EQ(take<std::uint64_t>(rest), 48U);
    for (const auto& triangle : mesh.triangles) {
        for (const auto index : triangle) EXPECT_EQ(take<std::int32_t>(rest), std::int32_t(index));
    }
    EXPECT_EQ(take<std::uint64_t>(rest), 16U);
    for (const int end : {3, 6, 9, 12}) EXPECT_EQ(take<std::int32_t>(rest), end);
    EXPECT_EQ(rest, "\n</AppendedData>\n</VTKFile>\n");
}

TEST(MeshFile, holds_normals_where_the_mesh_has_them) {
    SurfaceMesh mesh = example();
    for (const Vec3& v : mesh.vertices) mesh.normals.push_back(v.normalized());
    const std::string ply = written(mesh, "a.ply"), end = "end_header\n";
    EXPECT_TRUE(contains(ply, "property double z\nproperty double nx\n"));
    std::string_view rest = std::string_view(ply).substr(ply.find(end) + end.size());
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(take_vec3(rest), mesh.vertices[i]);
        EXPECT_EQ(take_vec3(rest), mesh.normals[i]);
    }
    const std::string obj = written(mesh, "a.obj");
    EXPECT_TRUE(contains(obj, "vn 1 0 0\n"));
    EXPECT_TRUE(contains(obj, "f 1//1 3//3 2//2\n"));
    const std::string vtp = written(mesh, "a.vtp");
    const std::string start = "<AppendedData encoding=\"raw\">\n_";
    EXPECT_TRUE(contains(vtp, "<PointData Normals=\"Normals\">"));
    rest = std::string_view(vtp).substr(vtp.find(start) + start.size());
    EXPECT_EQ(take<std::uint64_t>(rest), 96U);
    for (const Vec3& v : mesh.vertices) EXPECT_EQ(take_vec3(rest), v);
    EXPECT_EQ(take<std::uint64_t>(rest), 96U);
    for (const Vec3& n : mesh.normals) EXPECT_EQ(take_vec3(rest), n);
    EXPECT_EQ(take<std::uint64_t>(rest), 48U);
    EXPECT_EQ(written(mesh, "a.stl"), written(example(), "a.stl"));
}

TEST(MeshFile, of_an_empty_mesh_is_a_valid_file) {
    EXPECT_TRUE(contains(written({}, "a.ply"), "element vertex 0\n"));
    EXPECT_EQ(written({}, "a.stl").size(), 84U);
    EXPECT_EQ(written({}, "a.obj")[0], '#');
    EXPECT_TRUE(contains(written({}, "a.vtp"), "NumberOfPolys=\"0\""));
}

TEST(MeshFile, in_any_other_format_is_refused_with_the_four_that_are) {
    const ScratchFolder folder;
    for (const std::string name : {"a.stp", "a", "a.ply.gz", ".ply"}) {
        const std::string message =
            message_of<std::invalid_argument>([&] { write_mesh(example(), folder / name); });
        EXPECT_TRUE(contains(message, "use one of .ply, .stl, .obj, .vtp")) << message;
    }
    EXPECT_TRUE(folder.names().empty());
}

TEST(MeshFile, that_cannot_be_written_is_an_error_in_every_format) {
    const ScratchFolder folder;
    for (const std::string extension : {"ply", "stl", "obj", "vtp"}) {
        EXPECT_THROW(write_mesh(example(), folder / "none" / ("a." + extension)), OutputError);
        std::filesystem::create_symlink("/dev/full", folder / ("full." + extension));
        EXPECT_THROW(write_mesh(example(), folder / ("full." + extension)), OutputError);
    }
    EXPECT_EQ(folder.names().size(), 4U);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

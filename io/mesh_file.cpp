// Writes meshes. Binary formats are little-endian, like every machine this runs on.
#include "palpate/io/mesh_file.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "io/system/number.hpp"
#include "palpate/io/output.hpp"
#include "palpate/names.hpp"

namespace palpate::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary writers copy bytes as is");

constexpr const char* made_by = "isosurface by Palpate, millimetres, LPS";

/// The file, and how much of it is written. Progress counts the bytes of a PLY; others differ
/// little.
struct MeshOutput {
    MeshOutput(const std::filesystem::path& path, const SurfaceMesh& mesh, OnProgress progress)
        : file(path),
          written(std::move(progress),
                  24 * (mesh.vertices.size() + mesh.normals.size()) + 13 * mesh.triangles.size(),
                  std::size_t{1} << 20) {}
    void write(std::string_view bytes) {
        file.write(bytes);
        written.done(bytes.size());
    }

    PendingFile file;
    ReportedItems written;
};

template <class T>
void put(MeshOutput& file, const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    file.write({reinterpret_cast<const char*>(&value), sizeof value});
}

void put(MeshOutput& file, const Vec3& v) {
    for (int a = 0; a < 3; ++a) put(file, v[a]);
}

void write_ply(const SurfaceMesh& mesh, MeshOutput& file) {
    file.write("ply\nformat binary_little_endian 1.0\ncomment " + std::string(made_by) +
               "\nelement vertex " + std::to_string(mesh.vertices.size()) +
               "\nproperty double x\nproperty double y\nproperty double z\n" +
               (mesh.normals.empty()
                    ? ""
                    : "property double nx\nproperty double ny\nproperty double nz\n") +
               "element face " + std::to_string(mesh.triangles.size()) +
               "\nproperty list uchar uint vertex_indices\nend_header\n");
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        put(file, mesh.vertices[i]);
        if (!mesh.normals.empty()) put(file, mesh.normals[i]);
    }
    for (const auto& triangle : mesh.triangles) {
        put(file, std::uint8_t{3});
        for (const std::uint32_t index : triangle) put(file, index);
    }
}

void put_stl_vector(MeshOutput& file, const Vec3& v) {
    for (int a = 0; a < 3; ++a) put(file, static_cast<float>(v[a]));
}

void write_stl(const SurfaceMesh& mesh, MeshOutput& file) {
    if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw OutputError("an STL file holds 4294967295 triangles, this isosurface has " +
                          std::to_string(mesh.triangles.size()) + ": write a PLY or VTP");
    }
    std::string header = "binary STL, " + std::string(made_by);  // must not begin with "solid"
    header.resize(80, ' ');
    file.write(header);
    put(file, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3& p = mesh.vertices[a];
        const Vec3& q = mesh.vertices[b];
        const Vec3& r = mesh.vertices[c];
        put_stl_vector(file, (q - p).cross(r - p).stableNormalized());
        put_stl_vector(file, p);
        put_stl_vector(file, q);
        put_stl_vector(file, r);
        put(file, std::uint16_t{0});
    }
}

void write_obj(const SurfaceMesh& mesh, MeshOutput& file) {
    file.write("# " + std::string(made_by) + "\n");
    std::string line;
    const auto write_vectors = [&](const char* what, const std::vector<Vec3>& vectors) {
        for (const Vec3& v : vectors) {
            line = what;
            for (int a = 0; a < 3; ++a) {
                line += ' ';
                append_number(line, v[a]);
            }
            line += '\n';
            file.write(line);
        }
    };
    write_vectors("v", mesh.vertices);
    write_vectors("vn", mesh.normals);
    for (const auto& triangle : mesh.triangles) {
        line.assign(1, 'f');
        for (const std::uint32_t index : triangle) {
            line += ' ';
            append_number(line, std::int64_t{index} + 1);
            if (mesh.normals.empty()) continue;
            line += "//";
            append_number(line, std::int64_t{index} + 1);
        }
        line += '\n';
        file.write(line);
    }
}

/// One array of a VTP file: its XML element, and where its data will lie.
std::string vtp_array(const std::string& type, const std::string& attributes, std::uint64_t& offset,
                      std::uint64_t bytes) {
    std::string element = "<DataArray type=\"" + type + "\" " + attributes +
                          " format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
    offset += sizeof bytes + bytes;
    return element;
}

template <class Id>
void write_vtp(const SurfaceMesh& mesh, MeshOutput& file) {
    const std::string id = sizeof(Id) == 4 ? "Int32" : "Int64";
    const std::uint64_t corners = 3 * std::uint64_t{mesh.triangles.size()};
    const std::uint64_t vertex_bytes = mesh.vertices.size() * 3 * sizeof(double);
    const std::uint64_t corner_bytes = corners * sizeof(Id);
    const std::uint64_t offset_bytes = mesh.triangles.size() * sizeof(Id);
    const bool has_normals = !mesh.normals.empty();
    std::uint64_t offset = 0;
    std::string xml =
        "<?xml version=\"1.0\"?>\n<!-- " + std::string(made_by) +
        " -->\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"" +
        std::to_string(mesh.vertices.size()) +
        "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
        std::to_string(mesh.triangles.size()) + "\">\n<Points>\n";
    xml += vtp_array("Float64", "Name=\"Points\" NumberOfComponents=\"3\"", offset, vertex_bytes);
    xml += "</Points>\n";
    if (has_normals) {
        xml += "<PointData Normals=\"Normals\">\n";
        xml +=
            vtp_array("Float64", "Name=\"Normals\" NumberOfComponents=\"3\"", offset, vertex_bytes);
        xml += "</PointData>\n";
    }
    xml += "<Polys>\n";
    xml += vtp_array(id, "Name=\"connectivity\"", offset, corner_bytes);
    xml += vtp_array(id, "Name=\"offsets\"", offset, offset_bytes);
    xml += "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
    file.write(xml);
    put(file, vertex_bytes);
    for (const Vec3& v : mesh.vertices) put(file, v);
    if (has_normals) {
        put(file, vertex_bytes);
        for (const Vec3& n : mesh.normals) put(file, n);
    }
    put(file, corner_bytes);
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t index : triangle) put(file, static_cast<Id>(index));
    }
    put(file, offset_bytes);
    for (std::uint64_t end = 3; end <= corners; end += 3) put(file, static_cast<Id>(end));
    file.write("\n</AppendedData>\n</VTKFile>\n");
}

std::optional<MeshFormat> format_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (extension == ".ply") return MeshFormat::ply;
    if (extension == ".stl") return MeshFormat::stl;
    if (extension == ".obj") return MeshFormat::obj;
    if (extension == ".vtp") return MeshFormat::vtp;
    return {};
}

/// Throws OutputError for vertices that a reader would refuse.
void check_vertices(const SurfaceMesh& mesh, MeshFormat format) {
    const double most = format == MeshFormat::stl ? std::numeric_limits<float>::max()
                                                  : std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (mesh.vertices[i].cwiseAbs().maxCoeff() <= most && mesh.vertices[i].allFinite())
            continue;
        throw OutputError("vertex " + std::to_string(i) +
                          (mesh.vertices[i].allFinite()
                               ? " is too far away for the 32-bit numbers of an STL file: write a "
                                 "PLY or VTP"
                               : " is not finite"));
    }
}

}  // namespace

MeshFormat mesh_format_from(const std::filesystem::path& path) {
    if (const auto format = format_of(path)) return *format;
    const std::string names[] = {".ply", ".stl", ".obj", ".vtp"};
    throw std::invalid_argument(path.string() + ": its extension names no mesh format: " +
                                use_one_of(names, path.extension().string()));
}

bool names_a_mesh(const std::filesystem::path& path) {
    return format_of(path).has_value();
}

void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path,
                const OnProgress& progress) {
    write_mesh(mesh, path, mesh_format_from(path), progress);
}

void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, MeshFormat format,
                const OnProgress& progress) {
    check_vertices(mesh, format);
    MeshOutput file(path, mesh, progress);
    switch (format) {
        case MeshFormat::ply:
            write_ply(mesh, file);
            break;
        case MeshFormat::stl:
            write_stl(mesh, file);
            break;
        case MeshFormat::obj:
            write_obj(mesh, file);
            break;
        case MeshFormat::vtp: {
            // 32 bits where they suffice: half the size, and older readers read them, too.
            const bool small =
                mesh.triangles.size() * 3 <= std::numeric_limits<std::int32_t>::max();
            small ? write_vtp<std::int32_t>(mesh, file) : write_vtp<std::int64_t>(mesh, file);
            break;
        }
    }
    file.file.commit();
}

}  // namespace palpate::io

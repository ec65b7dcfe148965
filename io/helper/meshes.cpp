// Reads the triangles of meshes: VTP by VTK, other formats by parsers of our own.
#include <vtkCellArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolygon.h>
#include <vtkXMLPolyDataReader.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <new>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/helper/ear_clip.hpp"
#include "io/helper/ply_mesh.hpp"
#include "io/helper/protocol.hpp"
#include "io/helper/readers.hpp"
#include "io/helper/stl_mesh.hpp"
#include "io/helper/text_lines.hpp"
#include "io/helper/vtk_errors.hpp"
#include "io/system/number.hpp"
#include "io/units.hpp"
#include "io/words.hpp"

namespace palpate::io {
namespace {

PolygonMesh read_vtp(const std::filesystem::path& path) {
    const vtkNew<ErrorKeeper> errors;
    vtkOutputWindow::SetInstance(errors);
    const vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    vtkOutputWindow::SetInstance(nullptr);
    if (!errors->first().empty()) {
        throw Failure("is damaged or not what its name says (" + errors->first() +
                      "); export it again");
    }
    PolygonMesh mesh;
    vtkPolyData& read = *reader->GetOutput();
    for (vtkIdType i = 0; i < read.GetNumberOfPoints(); ++i) {
        read.GetPoint(i, mesh.vertices.emplace_back().data());
    }
    const auto for_each = [](vtkCellArray& cells, const auto& use) {
        vtkIdType count = 0;
        const vtkIdType* ids = nullptr;
        for (cells.InitTraversal(); cells.GetNextCell(count, ids) != 0;) {
            use(std::vector<std::int64_t>(ids, ids + count));
        }
    };
    for_each(*read.GetPolys(), [&](auto face) { mesh.faces.push_back(std::move(face)); });
    for_each(*read.GetStrips(), [&](const auto& strip) {
        for (std::size_t i = 0; i + 2 < strip.size(); ++i) {  // every second one is turned
            mesh.faces.push_back({strip[i], strip[i + 1 + i % 2], strip[i + 2 - i % 2]});
        }
    });
    return mesh;
}

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The vertex that a corner of an OBJ face names ("3", "3/1/2", from 1, or backwards from -1). It
/// may come later in the file.
std::int64_t vertex_of(std::string_view corner, std::int64_t vertices, const std::string& line) {
    const auto number = number_from<std::int64_t>(corner.substr(0, corner.find('/')));
    const std::int64_t index = number.value_or(0);
    if (index > 0) return index - 1;
    if (index < 0 && index >= -vertices) return vertices + index;
    throw Failure("'" + line.substr(0, 60) + "' names a vertex that is not there; export it again");
}

/// Whether a line of OBJ goes on in the next one, by a backslash at its end, which is taken off.
/// Blanks may follow it in lines of numbers. In others it may belong to a path of Windows.
bool goes_on(std::string& line) {
    const std::size_t end = line.find_last_not_of(" \t");
    if (end == std::string::npos || line[end] != '\\') return false;
    std::string word;
    std::istringstream(line) >> word;
    const bool has_numbers = word == "v" || word == "vt" || word == "vn" || word == "f";
    if (!has_numbers && end + 1 != line.size()) return false;
    line.resize(end);
    line += ' ';
    return true;
}

/// The length [mm] of a unit in a comment, which other words may follow. Nothing if the comment
/// says that it is not known.
std::optional<double> length_in_comment(const std::string& text) {
    const char* const marks = " \t,;:.()[]\"'";
    const std::size_t begin = std::min(text.find_first_not_of(marks), text.size());
    const std::string unit = text.substr(begin, text.find_first_of(marks, begin) - begin);
    for (const char* const none : {"", "unknown", "none", "unitless", "unspecified"}) {
        if (unit == none) return std::nullopt;
    }
    if (const auto length = millimetres_in(unit)) return length;
    throw Failure("its comment gives the unit of length '" + unit.substr(0, 40) +
                  "', which is not known; write mm, cm, m or inches, or remove the comment");
}

/// The length [mm] of the unit that a comment names, as SketchUp and Onshape write it ("File units
/// = meters"), or Mimics ("where 1 unit = 1000.0 mm"). Nothing of other comments.
std::optional<double> unit_of(const std::string& comment) {
    std::string text = lower(comment);
    text.erase(0, text.find_first_not_of("# \t(*-"));
    const std::string_view file_units = "file units =", one_unit = "where 1 unit =";
    if (text.starts_with(file_units)) {
        return length_in_comment(text.substr(file_units.size()));
    }
    const std::size_t at = text.find(one_unit);
    const bool is_word =
        at == 0 || (at != text.npos && !std::isalnum(static_cast<unsigned char>(text[at - 1])));
    if (!is_word) return std::nullopt;
    text = trimmed(text.substr(at + one_unit.size()));
    double times = 0;
    const auto [unit, error] = read_number(text.data(), text.data() + text.size(), times);
    if (error != std::errc{} || !std::isfinite(times) || !(times > 0)) return std::nullopt;
    const auto length = length_in_comment(unit);
    return length ? std::optional(times * *length) : std::nullopt;
}

/// Vertices and faces. Not by VTK, whose reader loses faces that count their vertices backwards.
PolygonMesh read_obj(const std::filesystem::path& path) {
    std::istringstream in(plain_text(bytes_of(path)));
    PolygonMesh mesh;
    std::optional<double> unit;
    for (std::string line, comment; next_line(in, line, &comment);) {
        if (const auto told = unit_of(comment)) {
            for (auto& vertex : mesh.vertices) {  // those before it, too
                for (double& coordinate : vertex) coordinate *= unit ? 1 : *told;
            }
            unit = told;
        }
        for (std::string more; goes_on(line) && next_line(in, more);) line += more;
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            for (double& coordinate : mesh.vertices.emplace_back()) {
                words >> word;
                const auto number = number_from<double>(word);
                if (!words || !number) {
                    throw Failure("'" + line.substr(0, 60) +
                                  "' is no vertex of three numbers; export it again");
                }
                coordinate = unit.value_or(1) * *number;
            }
        } else if (word == "f") {
            auto& face = mesh.faces.emplace_back();
            while (words >> word) face.push_back(vertex_of(word, std::ssize(mesh.vertices), line));
        }
    }
    return mesh;
}

/// Corners at one place become one vertex. Triangles of which two do are left out.
PolygonMesh read_stl(const std::filesystem::path& path) {
    using Corner = std::array<double, 3>;
    struct Hash {
        std::size_t operator()(const Corner& corner) const {
            std::size_t hash = 0;
            for (const double c : corner) hash = hash * 31 + std::hash<double>()(c);
            return hash;
        }
    };
    const auto corners = stl_corners(bytes_of(path));
    PolygonMesh mesh;
    std::unordered_map<Corner, std::int64_t, Hash> known;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        std::vector<std::int64_t> ids;
        for (std::size_t c = i; c < i + 3; ++c) {
            const auto [at, is_new] = known.emplace(corners[c], std::ssize(mesh.vertices));
            if (is_new) mesh.vertices.push_back(corners[c]);
            ids.push_back(at->second);
        }
        if (ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0]) {
            mesh.faces.push_back(std::move(ids));
        }
    }
    return mesh;
}

PolygonMesh read_polygons(const std::filesystem::path& path, const std::string& extension) {
    if (extension == ".stl") return read_stl(path);
    if (extension == ".ply") return ply_mesh(path);
    if (extension == ".obj") return read_obj(path);
    if (extension == ".vtp") return read_vtp(path);
    throw Failure("has no extension of a known mesh format (stl, ply, obj, vtp)");
}

/// Refuses faces that name a vertex the file has not, and vertices that are nowhere.
void check_mesh(const PolygonMesh& mesh) {
    const std::int64_t vertices = std::ssize(mesh.vertices);
    for (const auto& face : mesh.faces) {
        for (const std::int64_t id : face) {
            if (id >= 0 && id < vertices) continue;
            throw Failure("a face names vertex " + std::to_string(id) + " of " +
                          std::to_string(vertices) + "; export it again");
        }
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const auto& [x, y, z] = mesh.vertices[i];
        if (std::isfinite(x + y + z)) continue;
        throw Failure("vertex " + std::to_string(i) + " is not finite; export it again");
    }
    if (vertices > std::numeric_limits<std::uint32_t>::max()) {
        throw Failure("has more vertices than can be read; simplify it");
    }
}

/// A face without corners at the place of the one before, for which VTK drops it.
struct Face {
    std::vector<std::int64_t> ids;
    std::vector<Vec3> corners;

    Face(const PolygonMesh& mesh, std::span<const std::int64_t> all) {
        for (const std::int64_t id : all) {
            const Vec3 corner(mesh.vertices[static_cast<std::size_t>(id)].data());
            if (!corners.empty() && corner == corners.back()) continue;
            ids.push_back(id);
            corners.push_back(corner);
        }
        while (corners.size() > 1 && corners.back() == corners.front()) {
            ids.pop_back();
            corners.pop_back();
        }
    }
    /// Twice the area of a triangle as a vector.
    Vec3 area(std::size_t a, std::size_t b, std::size_t c) const {
        return (corners[b] - corners[a]).cross(corners[c] - corners[a]);
    }
    /// The same of all, which is that of its triangles together.
    Vec3 area() const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 2; i < corners.size(); ++i) sum += area(0, i - 1, i);
        return sum;
    }
    /// The part of the area that triangles do not have.
    double left_by(const Triangles& triangles) const {
        Vec3 left = area();
        for (const auto& [a, b, c] : triangles) left -= area(a, b, c);
        return left.norm();
    }
};

Triangles divided_by_vtk(const Face& face) {
    const vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Vec3& corner : face.corners) points->InsertNextPoint(corner.data());
    std::vector<vtkIdType> ids(face.corners.size());
    std::iota(ids.begin(), ids.end(), vtkIdType{0});
    const vtkNew<vtkPolygon> polygon;
    const vtkNew<vtkIdList> found;
    polygon->Initialize(static_cast<int>(ids.size()), ids.data(), points);
    polygon->Triangulate(found);
    Triangles triangles;
    for (vtkIdType t = 0; t + 2 < found->GetNumberOfIds(); t += 3) {
        auto& triangle = triangles.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            triangle[c] = static_cast<std::size_t>(found->GetId(t + static_cast<vtkIdType>(c)));
        }
    }
    return triangles;
}

/// In the plane of its area.
Triangles divided_by_ears(const Face& face) {
    const Vec3 normal = face.area().normalized();
    if (normal.isZero()) return {};
    const Vec3 right = normal.unitOrthogonal(), up = normal.cross(right);
    std::vector<Eigen::Vector2d> corners;
    for (const Vec3& corner : face.corners) {
        const Vec3 from_first = corner - face.corners[0];
        corners.emplace_back(from_first.dot(right), from_first.dot(up));
    }
    return clipped_ears(std::move(corners));
}

/// Those of VTK, unless it fails, as it does on many outlines that are not convex, but not on those
/// of four corners. Nothing of a face without area.
Triangles triangles_of(const Face& face) {
    if (face.corners.size() == 3) return {{0, 1, 2}};
    Triangles triangles = divided_by_vtk(face);
    if (face.corners.size() == 4) return triangles;
    double length = 0, reach = 0, greatest = 0;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
        length = std::max(length, (face.corners[i] - face.corners[0]).norm());
        reach = std::max(reach, face.corners[i].norm());
        if (i > 1) greatest = std::max(greatest, face.area(0, i - 1, i).norm());
    }
    // Corners that were on a line before numbers were rounded, to seven digits or fewer decimals.
    const double no_area = 1e-6 * length * reach + 1e-4 * length * length;
    double left = face.left_by(triangles);
    if (triangles.empty() || left > 1e-9 * length * length) {
        Triangles ears = divided_by_ears(face);
        const double left_by_ears = face.left_by(ears);
        if (triangles.empty() || left_by_ears < left) {
            triangles = std::move(ears);
            left = left_by_ears;
        }
    }
    if (greatest <= no_area || (left <= no_area && !triangles.empty())) return triangles;
    throw Failure("a face of " + std::to_string(face.corners.size()) +
                  " corners cannot be divided into triangles; export it again as triangles");
}

}  // namespace

MeshSize read_mesh(const std::filesystem::path& path, const std::string& extension) {
    const PolygonMesh mesh = read_polygons(path, extension);
    check_mesh(mesh);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const auto add = [&](std::int64_t a, std::int64_t b, std::int64_t c) {
        triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                             static_cast<std::uint32_t>(c)});
    };
    for (const auto& ids : mesh.faces) {
        if (ids.size() == 3) add(ids[0], ids[1], ids[2]);
        if (ids.size() < 4) continue;
        const Face face(mesh, ids);
        if (face.corners.size() < 3) continue;
        for (const auto& [a, b, c] : triangles_of(face)) add(face.ids[a], face.ids[b], face.ids[c]);
    }
    if (triangles.empty()) {
        throw Failure("has no faces; export it again as a mesh of triangles or polygons");
    }
    const MeshSize size{std::ssize(mesh.vertices), std::ssize(triangles)};
    void* const memory = memory_of_caller(mesh_bytes(size.vertices, size.triangles));
    if (!memory) throw std::bad_alloc();
    const std::size_t of_vertices = mesh.vertices.size() * sizeof mesh.vertices[0];
    std::memcpy(memory, mesh.vertices.data(), of_vertices);
    std::memcpy(static_cast<std::byte*>(memory) + of_vertices, triangles.data(),
                triangles.size() * sizeof triangles[0]);
    return size;
}

}  // namespace palpate::io

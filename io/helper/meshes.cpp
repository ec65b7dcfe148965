// Reads the triangles of meshes: VTP by VTK, other formats by parsers of our own.
#include <vtkCellArray.h>
#include <vtkIdList.h>
#include <vtkMergePoints.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolygon.h>
#include <vtkTriangleFilter.h>
#include <vtkXMLPolyDataReader.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
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

vtkSmartPointer<vtkPolyData> read_vtp(const std::filesystem::path& path) {
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
    return reader->GetOutput();
}

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The vertex that a corner of an OBJ face names ("3", "3/1/2", from 1, or backwards from -1). It
/// may come later in the file.
vtkIdType vertex_of(std::string_view corner, vtkIdType vertices, const std::string& line) {
    const auto number = number_from<std::int64_t>(corner.substr(0, corner.find('/')));
    const std::int64_t index = number.value_or(0);
    if (index > 0) return index - 1;
    if (index < 0 && index >= -vertices) return vertices + index;
    throw Failure("'" + line.substr(0, 60) + "' names a vertex that is not there; export it again");
}

/// A mesh of polygons, to be filled.
struct Polygons {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> faces;

    Polygons() { points->SetDataTypeToDouble(); }
    void add_face(const std::vector<vtkIdType>& corners) const {
        faces->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    }
    vtkSmartPointer<vtkPolyData> data() const {
        auto data = vtkSmartPointer<vtkPolyData>::New();
        data->SetPoints(points);
        data->SetPolys(faces);
        return data;
    }
};

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

void scale(vtkPoints& points, double factor) {
    for (vtkIdType i = 0; i < points.GetNumberOfPoints(); ++i) {
        Vec3 at;
        points.GetPoint(i, at.data());
        at *= factor;
        points.SetPoint(i, at.data());
    }
}

/// Vertices and faces. Not by VTK, whose reader loses faces that count their vertices backwards.
vtkSmartPointer<vtkPolyData> read_obj(const std::filesystem::path& path) {
    std::istringstream in(plain_text(bytes_of(path)));
    const Polygons mesh;
    std::optional<double> unit;
    for (std::string line, comment; next_line(in, line, &comment);) {
        if (const auto told = unit_of(comment)) {
            if (!unit) scale(*mesh.points, *told);  // those before it, too
            unit = told;
        }
        for (std::string more; goes_on(line) && next_line(in, more);) line += more;
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            double at[3] = {};
            for (double& coordinate : at) {
                words >> word;
                const auto number = number_from<double>(word);
                if (!words || !number) {
                    throw Failure("'" + line.substr(0, 60) +
                                  "' is no vertex of three numbers; export it again");
                }
                coordinate = unit.value_or(1) * *number;
            }
            mesh.points->InsertNextPoint(at);
        } else if (word == "f") {
            std::vector<vtkIdType> corners;
            while (words >> word) {
                corners.push_back(vertex_of(word, mesh.points->GetNumberOfPoints(), line));
            }
            mesh.add_face(corners);
        }
    }
    return mesh.data();
}

vtkSmartPointer<vtkPolyData> read_ply(const std::filesystem::path& path) {
    const PlyMesh read = ply_mesh(path);
    const Polygons mesh;
    for (const auto& vertex : read.vertices) mesh.points->InsertNextPoint(vertex.data());
    for (const auto& face : read.faces) mesh.add_face({face.begin(), face.end()});
    return mesh.data();
}

/// Corners at one place become one vertex. Triangles of which two do are left out.
vtkSmartPointer<vtkPolyData> read_stl(const std::filesystem::path& path) {
    const auto corners = stl_corners(bytes_of(path));
    const Polygons mesh;
    const vtkNew<vtkPoints> all;
    all->SetDataTypeToDouble();
    for (const auto& corner : corners) {
        if (!std::isfinite(corner[0] + corner[1] + corner[2])) {
            throw Failure("vertex " + std::to_string(all->GetNumberOfPoints()) +
                          " is not finite; export it again");
        }
        all->InsertNextPoint(corner.data());
    }
    const vtkNew<vtkMergePoints> merged;
    merged->InitPointInsertion(mesh.points, all->GetBounds(), all->GetNumberOfPoints());
    std::vector<vtkIdType> ids(3);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        for (std::size_t c = 0; c < 3; ++c) {
            merged->InsertUniquePoint(corners[i + c].data(), ids[c]);
        }
        if (ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0]) mesh.add_face(ids);
    }
    return mesh.data();
}

vtkSmartPointer<vtkPolyData> read_poly_data(const std::filesystem::path& path,
                                            const std::string& extension) {
    if (extension == ".stl") return read_stl(path);
    if (extension == ".ply") return read_ply(path);
    if (extension == ".obj") return read_obj(path);
    if (extension == ".vtp") return read_vtp(path);
    throw Failure("has no extension of a known mesh format (stl, ply, obj, vtp)");
}

/// Faces that name a vertex the file has not would be read beyond the array's end.
void check_faces(vtkCellArray& faces, vtkIdType vertices) {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    for (faces.InitTraversal(); faces.GetNextCell(count, ids) != 0;) {
        for (vtkIdType i = 0; i < count; ++i) {
            if (ids[i] >= 0 && ids[i] < vertices) continue;
            throw Failure("a face names vertex " + std::to_string(ids[i]) + " of " +
                          std::to_string(vertices) + "; export it again");
        }
    }
}

void check_finite(vtkPolyData& mesh) {
    for (vtkIdType i = 0; i < mesh.GetNumberOfPoints(); ++i) {
        double at[3];
        mesh.GetPoint(i, at);
        if (!std::isfinite(at[0] + at[1] + at[2])) {
            throw Failure("vertex " + std::to_string(i) + " is not finite; export it again");
        }
    }
}

/// A face without corners at the place of the one before, for which VTK drops it.
struct Face {
    std::vector<vtkIdType> ids;
    std::vector<Vec3> corners;

    Face(vtkPoints& points, std::span<const vtkIdType> all) {
        for (const vtkIdType id : all) {
            Vec3 corner;
            points.GetPoint(id, corner.data());
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

Triangles divided_by_vtk(const Face& face, vtkPoints& points) {
    const vtkNew<vtkPolygon> polygon;
    const vtkNew<vtkIdList> found;
    polygon->Initialize(static_cast<int>(face.ids.size()), face.ids.data(), &points);
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

/// Those of VTK, unless it fails, as it does on many outlines that are not convex. Nothing of a
/// face without area.
Triangles triangles_of(const Face& face, vtkPoints& points) {
    double length = 0, reach = 0, greatest = 0;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
        length = std::max(length, (face.corners[i] - face.corners[0]).norm());
        reach = std::max(reach, face.corners[i].norm());
        if (i > 1) greatest = std::max(greatest, face.area(0, i - 1, i).norm());
    }
    // Corners that were on a line before numbers were rounded, to seven digits or fewer decimals.
    const double no_area = 1e-6 * length * reach + 1e-4 * length * length;
    Triangles triangles = divided_by_vtk(face, points);
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

/// Its strips, and its faces with up to four corners, which VTK always divides. VTK drops other
/// faces that it cannot divide, so they become triangles here.
vtkSmartPointer<vtkPolyData> divided(vtkPolyData& mesh) {
    if (mesh.GetPolys()->GetMaxCellSize() <= 3) return &mesh;
    const vtkNew<vtkCellArray> faces;
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    for (mesh.GetPolys()->InitTraversal(); mesh.GetPolys()->GetNextCell(count, ids) != 0;) {
        if (count < 4) {
            faces->InsertNextCell(count, ids);
            continue;
        }
        const Face face(*mesh.GetPoints(), {ids, static_cast<std::size_t>(count)});
        const std::size_t corners = face.ids.size();
        if (corners == 3 || corners == 4) {
            faces->InsertNextCell(static_cast<vtkIdType>(corners), face.ids.data());
        } else if (corners > 4) {
            for (const auto& triangle : triangles_of(face, *mesh.GetPoints())) {
                faces->InsertNextCell(3);
                for (const std::size_t corner : triangle) faces->InsertCellPoint(face.ids[corner]);
            }
        }
    }
    auto made = vtkSmartPointer<vtkPolyData>::New();
    made->SetPoints(mesh.GetPoints());
    made->SetPolys(faces);
    made->SetStrips(mesh.GetStrips());
    return made;
}

}  // namespace

MeshSize read_mesh(const std::filesystem::path& path, const std::string& extension) {
    const vtkSmartPointer<vtkPolyData> read = read_poly_data(path, extension);
    check_faces(*read->GetPolys(), read->GetNumberOfPoints());
    check_faces(*read->GetStrips(), read->GetNumberOfPoints());
    check_finite(*read);
    const vtkNew<vtkTriangleFilter> filter;
    filter->SetInputData(divided(*read));
    filter->PassVertsOff();
    filter->PassLinesOff();
    filter->Update();
    vtkPolyData& mesh = *filter->GetOutput();
    const MeshSize size{mesh.GetNumberOfPoints(), mesh.GetPolys()->GetNumberOfCells()};
    if (size.triangles == 0) {
        throw Failure("has no faces; export it again as a mesh of triangles or polygons");
    }
    if (size.vertices > std::numeric_limits<std::uint32_t>::max()) {
        throw Failure("has more vertices than can be read; simplify it");
    }
    void* const memory = memory_of_caller(mesh_bytes(size.vertices, size.triangles));
    if (!memory) throw std::bad_alloc();
    auto* const vertices = static_cast<double*>(memory);
    for (vtkIdType i = 0; i < size.vertices; ++i) mesh.GetPoint(i, vertices + 3 * i);
    auto* triangle = reinterpret_cast<std::uint32_t*>(vertices + 3 * size.vertices);
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    vtkCellArray& cells = *mesh.GetPolys();
    for (cells.InitTraversal(); cells.GetNextCell(count, ids) != 0;) {
        for (int i = 0; i < 3; ++i) *triangle++ = static_cast<std::uint32_t>(ids[i]);
    }
    return size;
}

}  // namespace palpate::io

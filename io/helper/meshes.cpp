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
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

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
    /// Without corners that are the one before, for which VTK drops a face.
    void add_face(std::vector<vtkIdType> corners) const {
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        while (corners.size() > 1 && corners.back() == corners.front()) corners.pop_back();
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
bool goes_on(std::string& line) {
    const std::size_t end = line.find_last_not_of(" \t");
    if (end == std::string::npos || line[end] != '\\') return false;
    line.resize(end);
    line += ' ';
    return true;
}

/// The length [mm] of the unit that a comment names, as SketchUp and Onshape write it ("File units
/// = meters"), or Mimics ("where 1 unit = 1000.0 mm"). Nothing of other comments.
std::optional<double> unit_of(const std::string& comment) {
    const std::string text = lower(comment);
    const auto after = [&](const std::string& words) {
        const std::size_t at = text.find(words);
        return at == text.npos ? "" : trimmed(text.substr(at + words.size()));
    };
    if (const std::string unit = after("file units ="); !unit.empty()) return millimetres_in(unit);
    std::istringstream words(after("where 1 unit ="));
    std::string number, unit;
    words >> number >> unit;
    const auto times = number_from<double>(number);
    const auto length = millimetres_in(unit);
    if (!times || !length || !(*times > 0)) return std::nullopt;
    return *times * *length;
}

/// Vertices and faces. Not by VTK, whose reader loses faces that count their vertices backwards.
vtkSmartPointer<vtkPolyData> read_obj(const std::filesystem::path& path) {
    std::istringstream in(plain_text(bytes_of(path)));
    const Polygons mesh;
    double unit = 1;
    for (std::string line, comment; next_line(in, line, &comment);) {
        unit = unit_of(comment).value_or(unit);
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
                coordinate = unit * *number;
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

/// Twice the area of a polygon as a vector, which is that of its triangles together.
Vec3 area_of(vtkPoints& points, vtkIdType count, const vtkIdType* ids) {
    Vec3 area = Vec3::Zero(), first, before, corner;
    for (vtkIdType i = 0; i < count; ++i) {
        points.GetPoint(ids[i], corner.data());
        if (i == 0) first = corner;
        if (i > 1) area += (before - first).cross(corner - first);
        before = corner;
    }
    return area;
}

/// VTK drops a polygon that it cannot divide, for example one that touches itself around a hole.
void check_divided(vtkPolyData& mesh) {
    const vtkNew<vtkPolygon> polygon;
    const vtkNew<vtkIdList> triangles;
    vtkPoints* const points = mesh.GetPoints();
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    for (mesh.GetPolys()->InitTraversal(); mesh.GetPolys()->GetNextCell(count, ids) != 0;) {
        if (count < 4) continue;
        polygon->Initialize(static_cast<int>(count), ids, points);
        polygon->Triangulate(triangles);
        Vec3 left = area_of(*points, count, ids);
        double most = left.norm();
        for (vtkIdType t = 0; t + 2 < triangles->GetNumberOfIds(); t += 3) {
            const std::array<vtkIdType, 3> corners{ids[triangles->GetId(t)],
                                                   ids[triangles->GetId(t + 1)],
                                                   ids[triangles->GetId(t + 2)]};
            const Vec3 area = area_of(*points, 3, corners.data());
            left -= area;
            most = std::max(most, area.norm());
        }
        if (left.norm() <= 1e-6 * most) continue;
        throw Failure("a face of " + std::to_string(count) +
                      " corners cannot be divided into triangles (it touches or crosses itself); "
                      "export it again as triangles");
    }
}

}  // namespace

MeshSize read_mesh(const std::filesystem::path& path, const std::string& extension) {
    const vtkSmartPointer<vtkPolyData> read = read_poly_data(path, extension);
    check_faces(*read->GetPolys(), read->GetNumberOfPoints());
    check_faces(*read->GetStrips(), read->GetNumberOfPoints());
    check_divided(*read);
    const vtkNew<vtkTriangleFilter> filter;
    filter->SetInputData(read);
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
    for (vtkIdType i = 0; i < size.vertices; ++i) {
        double* const vertex = vertices + 3 * i;
        mesh.GetPoint(i, vertex);
        if (!std::isfinite(vertex[0] + vertex[1] + vertex[2])) {
            throw Failure("vertex " + std::to_string(i) + " is not finite; export it again");
        }
    }
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

// Reads the triangles of meshes: VTP by VTK, other formats by parsers of our own.
#include <vtkCellArray.h>
#include <vtkMergePoints.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTriangleFilter.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <new>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_order.hpp"
#include "io/helper/ply_mesh.hpp"
#include "io/helper/protocol.hpp"
#include "io/helper/readers.hpp"
#include "io/helper/vtk_errors.hpp"
#include "io/system/number.hpp"
#include "palpate/io/error.hpp"

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

/// Without a byte order mark, every line with a line feed at its end.
std::string plain_text(const std::string& bytes) {
    std::string text;
    for (std::size_t i = bytes.starts_with("\xef\xbb\xbf") ? 3 : 0; i < bytes.size(); ++i) {
        if (bytes[i] != '\r') {
            text += bytes[i];
        } else if (i + 1 == bytes.size() || bytes[i + 1] != '\n') {
            text += '\n';
        }
    }
    return text;
}

/// The vertex that a corner of an OBJ face names ("3", "3/1/2", from 1, or backwards from -1).
vtkIdType vertex_of(std::string_view corner, vtkIdType vertices, const std::string& line) {
    const auto number = number_from<std::int64_t>(corner.substr(0, corner.find('/')));
    const std::int64_t index = number.value_or(0);
    if (index > 0 && index <= vertices) return index - 1;
    if (index < 0 && index >= -vertices) return vertices + index;
    throw Failure("'" + one_line(line.substr(0, 60)) +
                  "' names a vertex that is not there; export it again");
}

/// The next line without its comment. False at the end.
bool next_line(std::istream& in, std::string& line) {
    if (!std::getline(in, line)) return false;
    line.resize(std::min(line.find('#'), line.size()));
    return true;
}

/// Vertices and faces. Not by VTK, whose reader loses faces that count their vertices backwards.
vtkSmartPointer<vtkPolyData> read_obj(const std::filesystem::path& path) {
    std::istringstream in(plain_text(bytes_of(path)));
    const vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    const vtkNew<vtkCellArray> faces;
    for (std::string line; next_line(in, line);) {
        for (std::string more; line.ends_with('\\') && next_line(in, more);) {
            line.back() = ' ';
            line += more;
        }
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            double at[3] = {};
            for (double& coordinate : at) {
                words >> word;
                const auto number = number_from<double>(word);
                if (!words || !number) {
                    throw Failure("'" + one_line(line.substr(0, 60)) +
                                  "' is no vertex of three numbers; export it again");
                }
                coordinate = *number;
            }
            points->InsertNextPoint(at);
        } else if (word == "f") {
            std::vector<vtkIdType> corners;
            while (words >> word) {
                corners.push_back(vertex_of(word, points->GetNumberOfPoints(), line));
            }
            faces->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
        }
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(faces);
    return data;
}

vtkSmartPointer<vtkPolyData> read_ply(const std::filesystem::path& path) {
    const PlyMesh mesh = ply_mesh(path);
    const vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const auto& vertex : mesh.vertices) points->InsertNextPoint(vertex.data());
    const vtkNew<vtkCellArray> faces;
    std::vector<vtkIdType> corners;
    for (const auto& face : mesh.faces) {
        corners.assign(face.begin(), face.end());
        faces->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(faces);
    return data;
}

/// Behind the line of a text that begins with "solid", after comments; the size of the text if none
/// does.
std::size_t begin_of_solid(const std::string& text) {
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const bool found = lower(trimmed(text.substr(at, end - at))).starts_with("solid");
        at = end + 1;
        if (found) break;
    }
    return std::min(at, text.size());
}

[[noreturn]] void fail_stl(const std::string& what) {
    throw Failure("is damaged or not what its name says (" + what + "); export it again");
}

using Corner = std::array<double, 3>;

/// Three corners for each triangle of a text, from behind its first line on.
std::vector<Corner> corners_in_text(const std::string& text, std::size_t begin) {
    std::istringstream in(text.substr(begin));
    std::vector<Corner> corners;
    bool is_open = true;
    for (std::string line; next_line(in, line);) {
        std::istringstream words(lower(line));
        for (std::string word; words >> word;) {
            if (word == "solid" || word == "endsolid") {
                is_open = word == "solid";
                break;  // its name follows
            }
            if (word == "normal") {
                words >> word >> word >> word;  // it follows from the corners
            } else if (word == "vertex") {
                Corner& corner = corners.emplace_back();
                for (double& coordinate : corner) {
                    word.clear();
                    words >> word;
                    const auto number = number_from<double>(word);
                    if (!number) fail_stl("'" + word.substr(0, 40) + "' is not a number");
                    coordinate = *number;
                }
            } else if (word == "endloop") {
                if (corners.size() % 3 != 0) fail_stl("a facet has not three corners");
            } else if (word != "facet" && word != "outer" && word != "loop" && word != "endfacet") {
                fail_stl("'" + one_line(word.substr(0, 40)) + "' is no word of STL");
            }
        }
    }
    if (is_open || corners.size() % 3 != 0) fail_stl("it is cut off");
    return corners;
}

/// The same of a binary file, which says how many triangles it has.
std::vector<Corner> corners_in_binary(const std::string& bytes) {
    constexpr std::size_t head = 84, triangle = 50, normal = 12;
    if (bytes.size() < head) throw Failure("is too short for an STL file; copy it again");
    const auto raw = std::as_bytes(std::span(bytes));
    const auto count = little_endian<std::uint32_t>(raw.subspan(head - 4));
    if (bytes.size() < head + triangle * count) {
        throw Failure("it is cut off: its " + std::to_string(count) +
                      " triangles need more bytes; copy it again");
    }
    std::vector<Corner> corners(std::size_t{3} * count);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t at = head + i / 3 * triangle + normal + (i % 3 * 3 + a) * 4;
            corners[i][a] = little_endian<float>(raw.subspan(at));
        }
    }
    return corners;
}

/// Not by VTK, whose reader stops at marks, comments and line ends of other systems. Corners at one
/// place become one vertex; triangles without an area are left out where two of theirs do.
vtkSmartPointer<vtkPolyData> read_stl(const std::filesystem::path& path) {
    const std::string bytes = bytes_of(path);
    // The free header of some binary files begins with "solid", too.
    const bool may_be_text = bytes.find('\0') >= std::min<std::size_t>(bytes.size(), 84);
    const std::string text = may_be_text ? plain_text(bytes) : "";
    const std::size_t begin = begin_of_solid(text);
    const auto corners =
        begin < text.size() ? corners_in_text(text, begin) : corners_in_binary(bytes);
    const vtkNew<vtkPoints> all, points;
    all->SetDataTypeToDouble();
    points->SetDataTypeToDouble();
    for (const Corner& corner : corners) {
        if (!std::isfinite(corner[0] + corner[1] + corner[2])) {
            throw Failure("vertex " + std::to_string(all->GetNumberOfPoints()) +
                          " is not finite; export it again");
        }
        all->InsertNextPoint(corner.data());
    }
    const vtkNew<vtkMergePoints> merged;
    merged->InitPointInsertion(points, all->GetBounds(), all->GetNumberOfPoints());
    const vtkNew<vtkCellArray> faces;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        vtkIdType ids[3];
        for (std::size_t c = 0; c < 3; ++c) {
            merged->InsertUniquePoint(corners[i + c].data(), ids[c]);
        }
        if (ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0]) faces->InsertNextCell(3, ids);
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(faces);
    return data;
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

}  // namespace

MeshSize read_mesh(const std::filesystem::path& path, const std::string& extension) {
    const vtkSmartPointer<vtkPolyData> read = read_poly_data(path, extension);
    check_faces(*read->GetPolys(), read->GetNumberOfPoints());
    check_faces(*read->GetStrips(), read->GetNumberOfPoints());
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

// Writes an isosurface for other programs: PLY, STL, OBJ, VTP. Own writers, not VTK's;
// docs/surface.md says why.
#pragma once

#include <filesystem>

#include "palpate/surface.hpp"

namespace palpate::io {

/// Binary little-endian PLY, binary STL, OBJ text, VTP with raw appended data. Vertices are doubles
/// in all but STL, which has 32-bit floats only. Normals go along where the mesh has them, but for
/// STL.
enum class MeshFormat : std::uint8_t { ply, stl, obj, vtp };

/// The format of an extension, upper or lower case. Throws std::invalid_argument, naming the four,
/// for any other: call it before the mesh is computed.
MeshFormat mesh_format_from(const std::filesystem::path& path);

/// Writes the mesh in the format of the path's extension, whole or not at all (PendingFile).
/// Throws OutputError, and std::invalid_argument as above.
void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path);
/// The same in a named format, for targets without an extension ("-", /dev/stdout).
void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, MeshFormat format);

}  // namespace palpate::io

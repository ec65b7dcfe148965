// Meshes in files: an isosurface for other programs, a tool from them. PLY, STL, OBJ, VTP.
#pragma once

#include <cstdint>
#include <filesystem>

#include "palpate/surface.hpp"

namespace palpate::io {

/// Written as binary little-endian PLY, binary STL, OBJ text, VTP with raw appended data. Vertices
/// are doubles in all but STL, which has 32-bit floats only. Normals are written if the mesh has
/// them, except in STL.
enum class MeshFormat : std::uint8_t { ply, stl, obj, vtp };

/// The format of an extension, upper or lower case. Throws std::invalid_argument, naming the four,
/// for any other: call it before the mesh is computed.
MeshFormat mesh_format_from(const std::filesystem::path& path);

/// Whether the extension is one of the four, upper or lower case.
bool names_a_mesh(const std::filesystem::path& path);

/// The triangles of a mesh file, closed or not. Polygons are cut into triangles, vertices are
/// unchanged and taken as mm, and normals are ignored. Read in a process of its own, VTP by VTK,
/// the others by parsers of ours (docs/io_internals.md). `memory`: the limit of that process
/// [bytes]. With 0, it may take as much as a sound file of this size may need. Throws InputError,
/// and passes on exceptions of `progress`.
SurfaceMesh read_mesh(const std::filesystem::path& path, const OnProgress& progress = {},
                      std::uint64_t memory = 0);

/// Writes the mesh in the format of the path's extension, whole or not at all (PendingFile).
/// Throws OutputError, and std::invalid_argument as above.
void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path,
                const OnProgress& progress = {});
/// The same in a named format, for targets without an extension ("-", /dev/stdout).
void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, MeshFormat format,
                const OnProgress& progress = {});

}  // namespace palpate::io

// palpate extract: each format, closed meshes, and refusals before the work.
#include <cstring>
#include <nlohmann/json.hpp>

#include "apps/program.hpp"
#include "support/mesh_checks.hpp"

namespace palpate::app::test {
namespace {

const std::string extract_sphere = "extract synthetic:sphere:24x24x24 -o ";

template <class T>
T take(const std::string& bytes, std::size_t& at) {
    T value{};
    EXPECT_LE(at + sizeof value, bytes.size());
    if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
    return value;
}

std::size_t count_after(const std::string& bytes, const std::string& word) {
    const auto at = bytes.find(word);
    EXPECT_NE(at, std::string::npos) << word;
    return at == std::string::npos ? 0 : std::stoul(bytes.substr(at + word.size(), 20));
}

/// A reader of its own, by the PLY specification.
SurfaceMesh read_ply(const std::filesystem::path& path) {
    const std::string bytes = support::bytes_of(path);
    EXPECT_EQ(bytes.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0U);
    SurfaceMesh mesh;
    mesh.vertices.resize(count_after(bytes, "element vertex "));
    mesh.triangles.resize(count_after(bytes, "element face "));
    const std::string end = "end_header\n";
    std::size_t at = bytes.find(end) + end.size();
    mesh.normals.resize(contains(bytes.substr(0, at), "property double nx\n") ? mesh.vertices.size()
                                                                              : 0);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        for (int a = 0; a < 3; ++a) mesh.vertices[v][a] = take<double>(bytes, at);
        for (int a = 0; a < 3 && !mesh.normals.empty(); ++a)
            mesh.normals[v][a] = take<double>(bytes, at);
    }
    for (auto& triangle : mesh.triangles) {
        EXPECT_EQ(take<std::uint8_t>(bytes, at), 3);
        for (auto& index : triangle) index = take<std::uint32_t>(bytes, at);
        for (const auto index : triangle) EXPECT_LT(index, mesh.vertices.size());
    }
    EXPECT_EQ(at, bytes.size());
    return mesh;
}

TEST(Extract, the_ply_is_closed_and_encloses_what_the_summary_says) {
    const ScratchFolder folder;
    for (const std::string volume : {"sphere:24x24x24", "noise:16x16x16", "torus:30x30x20",
                                     "noise:1x9x9", "sphere:9x9x9 --solid below"}) {
        const Outcome outcome =
            succeeds(folder, "extract synthetic:" + volume + " -o a.ply --json");
        const auto summary = nlohmann::json::parse(outcome.out);
        const SurfaceMesh mesh = read_ply(folder / "a.ply");
        EXPECT_EQ(support::flaw_in_closed_mesh(mesh), "") << volume;
        EXPECT_GT(mesh.triangles.size(), 100U) << volume;
        EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
        EXPECT_EQ(summary["triangles"], mesh.triangles.size());
        EXPECT_EQ(summary["vertices"], mesh.vertices.size());
        EXPECT_EQ(summary["enclosed_volume_mm3"], enclosed_volume(mesh));
    }
}

TEST(Extract, every_format_has_the_same_triangles) {
    const ScratchFolder folder;
    std::size_t triangles = 0;
    for (const std::string name : {"a.ply", "a.stl", "a.obj", "a.vtp", "A.PLY"}) {
        const Outcome outcome = succeeds(folder, extract_sphere + name);
        EXPECT_EQ(outcome.out.rfind(name + ": isovalue 76.5, ", 0), 0U) << outcome.out;
        if (triangles == 0) triangles = read_ply(folder / "a.ply").triangles.size();
        EXPECT_TRUE(contains(outcome.out, std::to_string(triangles) + " triangles"));
    }
    const std::string stl = support::bytes_of(folder / "a.stl");
    EXPECT_EQ(stl.size(), 84 + 50 * triangles);
    const std::string obj = support::bytes_of(folder / "a.obj");
    std::size_t faces = 0;
    for (auto at = obj.find("\nf "); at != std::string::npos; at = obj.find("\nf ", at + 1))
        ++faces;
    EXPECT_EQ(faces, triangles);
    EXPECT_EQ(count_after(support::bytes_of(folder / "a.vtp"), "NumberOfPolys=\""), triangles);
    EXPECT_EQ(support::bytes_of(folder / "A.PLY"), support::bytes_of(folder / "a.ply"));
}

TEST(Extract, of_a_store_takes_the_level_that_is_asked_for) {
    const ScratchFolder folder;
    const std::string ball = "synthetic:sphere:132x128x128";  // more samples than an overview has
    succeeds(folder, "convert -q " + ball + " ball.zarr");
    succeeds(folder, "extract -q " + ball + " -i 50% -o whole.ply");
    const std::string extract = "extract ball.zarr -i 50% -o ";
    succeeds(folder, extract + "fine.ply --level 0");
    EXPECT_EQ(support::bytes_of(folder / "fine.ply"), support::bytes_of(folder / "whole.ply"));
    const Outcome overview = succeeds(folder, extract + "overview.ply");
    EXPECT_TRUE(contains(overview.err, "of this overview")) << overview.err;
    expect_failure(palpate(folder, extract + "none.ply -q --level 0 --memory 2MB"), 3,
                   "allow more memory");
}

TEST(Extract, refuses_unknown_extensions_before_the_work) {
    const ScratchFolder folder;
    for (const std::string name : {"a.foo", "a", "-", "a.ply.gz"}) {
        expect_failure(palpate(folder, "extract no-such-file.nrrd -i 5 -o " + name), 2,
                       ".ply, .stl, .obj, .vtp");
    }
    EXPECT_TRUE(folder.names().empty());
}

TEST(Extract, reports_what_cannot_be_written_and_leaves_nothing) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "folder.ply");
    std::filesystem::create_symlink("/dev/full", folder / "full.ply");
    const auto before = folder.names();
    expect_failure(palpate(folder, extract_sphere + "missing/a.ply"), 5, "missing does not exist");
    expect_failure(palpate(folder, extract_sphere + "folder.ply"), 5, "is a folder");
    expect_failure(palpate(folder, extract_sphere + "full.ply"), 5, "No space left");
    EXPECT_EQ(folder.names(), before);
}

TEST(Extract, an_isovalue_is_needed_for_a_file) {
    const ScratchFolder folder;
    support::put_bytes(folder / "v.raw", std::string("\0\1\2\3\4\5\6\7", 8));
    expect_failure(palpate(folder, "extract v.raw --dims 2x2x2 --type uint8 -o a.ply"), 2,
                   "palpate info v.raw suggests some");
    succeeds(folder, "extract v.raw --dims 2x2x2 --type uint8 -o a.ply -i 50%");
}

}  // namespace
}  // namespace palpate::app::test

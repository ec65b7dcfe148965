// Meshes come back from the four formats as they were; damaged files are refused in a line.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>

#include "palpate/io/error.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/io/tool_file.hpp"
#include "support/scratch_folder.hpp"
#include "volume_support.hpp"

namespace palpate::io::test {
namespace {

const char* const extensions[] = {".stl", ".ply", ".obj", ".vtp"};

SurfaceMesh wedge() {
    SurfaceMesh mesh;
    mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 0.5}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return mesh;
}

/// The corners of the triangles, in an order that does not depend on the file.
std::vector<std::vector<double>> corners_of(const SurfaceMesh& mesh) {
    std::vector<std::vector<double>> all;
    for (const auto& t : mesh.triangles) {
        std::vector<Vec3> corners;
        for (const std::uint32_t i : t) corners.push_back(mesh.vertices.at(i));
        const auto before = [](const Vec3& a, const Vec3& b) {
            return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
        };
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), before),
                    corners.end());
        auto& flat = all.emplace_back();
        for (const Vec3& corner : corners) flat.insert(flat.end(), corner.begin(), corner.end());
    }
    std::ranges::sort(all);
    return all;
}

std::string refusal_of_mesh(const std::filesystem::path& path) {
    try {
        (void)read_mesh(path);
    } catch (const InputError& e) {
        return e.what();
    }
    return "";
}

TEST(MeshReader, reads_what_was_written) {
    const support::ScratchFolder folder;
    for (const std::string extension : extensions) {
        const auto path = folder / ("a" + extension);
        write_mesh(wedge(), path);
        EXPECT_EQ(corners_of(read_mesh(path)), corners_of(wedge())) << extension;
    }
}

TEST(MeshReader, reads_texts_polygons_and_open_meshes) {
    const support::ScratchFolder folder;
    put_bytes(folder / "square.obj",
              "# a square and a triangle\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1 1 5\nvn 0 0 1\n"
              "f 1//1 2//1 3//1 4//1\nf -1 1 2\n");
    const SurfaceMesh square = read_mesh(folder / "square.obj");
    EXPECT_EQ(square.triangles.size(), 3U);
    put_bytes(folder / "one.STL",
              "solid one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e1 0 0\n"
              "   vertex 0 10 0\n  endloop\n endfacet\nendsolid one\n");
    EXPECT_EQ(read_mesh(folder / "one.STL").triangles.size(), 1U);
    put_bytes(folder / "five.ply",
              "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
              "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
              "end_header\n0 0 0\n2 0 0\n3 1 0\n1 3 0\n-1 1 0\n5 0 1 2 3 4\n");
    EXPECT_EQ(read_mesh(folder / "five.ply").triangles.size(), 3U);
    const auto tool = make_tool(tool_spec_from((folder / "one.STL").string()), 0.5);
    EXPECT_GT(tool->points().size(), 150U);
    EXPECT_NEAR(tool->radius(), 10, 1e-6);
}

TEST(MeshReader, reads_faces_before_their_vertices_and_all_triangles_of_a_wrong_count) {
    const support::ScratchFolder folder;
    put_bytes(folder / "a.obj", "f 1 2 3\nv 0 0 0\nv 2 0 0\nv 0 3 0\n");
    EXPECT_EQ(read_mesh(folder / "a.obj").triangles.size(), 1U);
    write_mesh(wedge(), folder / "a.stl");
    const std::string whole = support::bytes_of(folder / "a.stl");
    for (const char count : {'\0', '\1', '\3'}) {
        std::string bytes = whole;
        bytes[80] = count;
        put_bytes(folder / "a.stl", bytes);
        EXPECT_EQ(corners_of(read_mesh(folder / "a.stl")), corners_of(wedge()));
    }
    for (const std::string& end : {std::string("a comment"), std::string(50, '\0')}) {
        put_bytes(folder / "a.stl", whole + end);
        EXPECT_EQ(corners_of(read_mesh(folder / "a.stl")), corners_of(wedge()));
        EXPECT_EQ(read_mesh(folder / "a.stl").vertices.size(), 4U);
    }
}

TEST(MeshReader, says_what_is_wrong) {
    const support::ScratchFolder folder;
    const auto says = [&](const std::string& name, const std::string& bytes,
                          const std::string& word) {
        put_bytes(folder / name, bytes);
        const std::string message = refusal_of_mesh(folder / name);
        EXPECT_TRUE(one_line_about(message, folder / name)) << name << ": " << message;
        EXPECT_TRUE(contains(message, word)) << message;
    };
    says("empty.stl", "", "empty");
    says("short.stl", "abc", "too short");
    says("cut.stl", std::string(80, '\0') + std::string("\xff\xff\xff\x7f", 4), "cut off");
    says("points.obj", "v 0 0 0\nv 1 0 0\n", "no faces");
    says("beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "vertex");
    says("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -9223372036854775808 1 2\n", "vertex");
    says("before.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "vertex");
    says("text.ply", "not a mesh\n", "not what its name says");
    says("text.vtp", "not a mesh\n", "not what its name says");
    says("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "finite");
    says("a.mesh", "v\n", "extension");
    EXPECT_TRUE(contains(refusal_of_mesh(folder / "none.stl"), "does not exist"));
    EXPECT_TRUE(contains(refusal_of_mesh(folder.path()), "is a folder"));
}

TEST(MeshReader, damaged_files_are_refused_or_give_a_mesh) {
    const support::ScratchFolder folder;
    std::mt19937 random(17);
    for (const std::string extension : extensions) {
        const auto path = folder / ("a" + extension);
        write_mesh(wedge(), path);
        const std::string whole = support::bytes_of(path);
        for (int i = 0; i < support::scaled(40); ++i) {
            std::string bytes = whole;
            if (i % 4 == 0) {
                bytes.resize(1 + random() % (whole.size() - 1));
            } else {
                char& byte = bytes[random() % bytes.size()];
                byte = static_cast<char>(byte ^ (1 << random() % 8));
            }
            put_bytes(path, bytes);
            try {
                const SurfaceMesh mesh = read_mesh(path);
                for (const auto& t : mesh.triangles) {
                    for (const std::uint32_t v : t) ASSERT_LT(v, mesh.vertices.size());
                }
                for (const Vec3& v : mesh.vertices) ASSERT_TRUE(v.allFinite());
            } catch (const InputError& e) {
                EXPECT_TRUE(one_line_about(e.what(), path)) << extension << ": " << e.what();
            }
        }
    }
}

/// One number of a PLY file, as text or in either byte order.
template <class T>
std::string ply_number(T value, int encoding) {
    if (encoding == 0) return std::to_string(+value) + " ";
    std::string bytes = little(value);
    if (encoding == 2) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

/// The wedge with its elements in this order and other lists around the vertices of a face.
std::string ply_of(const std::vector<std::string>& order, int encoding, int lists,
                   const std::string& name) {
    const SurfaceMesh mesh = wedge();
    const bool before = lists & 1, after = lists & 2;
    std::string head = std::string("ply\nformat ") +
                       std::array{"ascii", "binary_little_endian", "binary_big_endian"}[encoding] +
                       " 1.0\ncomment made by hand\n";
    std::string body;
    for (const std::string& element : order) {
        if (element == "vertex") {
            head +=
                "element vertex 4\nproperty uchar red\nproperty double z\nproperty float x\n"
                "property float y\n";
            for (const Vec3& v : mesh.vertices) {
                body += ply_number(std::uint8_t{200}, encoding) + ply_number(v[2], encoding) +
                        ply_number(float(v[0]), encoding) + ply_number(float(v[1]), encoding);
            }
        } else if (element == "face") {
            const std::string texture = "property list uchar float texcoord\n";
            head += "element face 4\n" + (before ? texture : "") + "property list uchar uint " +
                    name + "\n" + (after ? texture : "") + "property short flags\n";
            std::string coordinates = ply_number(std::uint8_t{6}, encoding);
            for (int i = 0; i < 6; ++i) coordinates += ply_number(0.25F * float(i), encoding);
            for (const auto& t : mesh.triangles) {
                if (before) body += coordinates;
                body += ply_number(std::uint8_t{3}, encoding);
                for (const std::uint32_t corner : t) body += ply_number(corner, encoding);
                if (after) body += coordinates;
                body += ply_number(std::int16_t{-1}, encoding);
            }
        } else {
            head += "element " + element +
                    " 2\nproperty int vertex1\nproperty list int double weights\n";
            for (int i = 0; i < 2; ++i) {
                body += ply_number(std::int32_t{i}, encoding) +
                        ply_number(std::int32_t{1}, encoding) + ply_number(0.5, encoding);
            }
        }
        if (encoding == 0) body += "\n";
    }
    return head + "end_header\n" + body;
}

TEST(MeshReader, a_ply_file_keeps_every_triangle_in_any_order_of_elements_and_lists) {
    const support::ScratchFolder folder;
    std::vector<std::string> order = {"edge", "face", "vertex"};
    int files = 0;
    do {
        for (int encoding = 0; encoding < 3; ++encoding) {
            for (int lists = 0; lists < 4; ++lists) {
                const char* const name = lists % 2 == 0 ? "vertex_indices" : "vertex_index";
                put_bytes(folder / "a.ply", ply_of(order, encoding, lists, name));
                EXPECT_EQ(corners_of(read_mesh(folder / "a.ply")), corners_of(wedge()))
                    << order[0] << order[1] << order[2] << " " << encoding << " " << lists;
                ++files;
            }
        }
    } while (std::ranges::next_permutation(order).found);
    EXPECT_EQ(files, 72);
}

TEST(MeshReader, a_damaged_ply_file_is_refused_or_read_and_never_a_crash) {
    const support::ScratchFolder folder;
    std::mt19937 random(5);
    for (int i = 0; i < 60; ++i) {
        std::string bytes = ply_of({"vertex", "edge", "face"}, i % 3, i % 4, "vertex_indices");
        if (i % 2 == 0) {
            bytes.resize(random() % (bytes.size() - 20));
        } else {
            bytes[random() % bytes.size()] = static_cast<char>(random());
        }
        put_bytes(folder / "a.ply", bytes);
        const std::string message = refusal_of_mesh(folder / "a.ply");
        EXPECT_FALSE(contains(message, "crash")) << message;
        EXPECT_TRUE(i % 2 == 1 || !message.empty()) << "cut off";
    }
}

TEST(MeshReader, strips_of_triangles_in_a_ply_file_are_read) {
    const support::ScratchFolder folder;
    put_bytes(folder / "a.ply",
              "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
              "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
              "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n");
    EXPECT_EQ(read_mesh(folder / "a.ply").triangles.size(), 3U);
}

TEST(MeshReader, an_stl_text_in_capitals_is_read) {
    const support::ScratchFolder folder;
    std::string text = "SOLID A\n";
    for (const auto& t : wedge().triangles) {
        text += "FACET NORMAL 0 0 1\nOUTER LOOP\n";
        for (const std::uint32_t i : t) {
            const Vec3 v = wedge().vertices[i];
            text += "VERTEX " + std::to_string(v[0]) + " " + std::to_string(v[1]) + " " +
                    std::to_string(v[2]) + "\n";
        }
        text += "ENDLOOP\nENDFACET\n";
    }
    put_bytes(folder / "a.stl", text + "ENDSOLID A\n");
    EXPECT_EQ(read_mesh(folder / "a.stl").triangles.size(), 4U);
}

TEST(MeshReader, texts_may_have_any_line_ends_a_byte_order_mark_and_comments_first) {
    const support::ScratchFolder folder;
    const std::string stl =
        "solid a vertex\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
        "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
        "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n3\n";
    const auto reads = [&](const char* name, const std::string& text) {
        for (const std::string end : {"\n", "\r", "\r\n"}) {
            std::string bytes;
            for (const char c : text) bytes += c == '\n' ? end : std::string(1, c);
            put_bytes(folder / name, bytes);
            EXPECT_EQ(refusal_of_mesh(folder / name), "") << name << " " << end.size();
        }
    };
    reads("a.stl", stl);
    reads("a.stl", "\xef\xbb\xbf" + stl);
    reads("a.stl",
          "# made by hand, with a remark that is longer than the header of a binary file "
          "of STL has bytes\n\n" +
              stl);
    reads("a.ply", ply);
    reads("a.obj", obj);
    for (const std::size_t end : {20U, 60U, 90U, 105U}) {
        put_bytes(folder / "cut.stl", stl.substr(0, end));
        EXPECT_TRUE(contains(refusal_of_mesh(folder / "cut.stl"), "not what its name says"));
    }
}

TEST(MeshReader, an_stl_text_without_its_last_line_is_read_if_its_facets_are_whole) {
    const support::ScratchFolder folder;
    const std::string facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 +1 0\nendloop\n"
        "endfacet\n";
    for (const std::string end : {"", "\n", "endsolid"}) {
        put_bytes(folder / "a.stl", "solid a\n" + facet + facet + end);
        EXPECT_EQ(read_mesh(folder / "a.stl").triangles.size(), 2U) << end;
    }
    for (std::size_t length = 1; length + 1 < facet.size(); ++length) {
        put_bytes(folder / "a.stl", "solid a\n" + facet + facet.substr(0, length));
        EXPECT_TRUE(contains(refusal_of_mesh(folder / "a.stl"), "not what its name says"))
            << length;
    }
}

}  // namespace
}  // namespace palpate::io::test

// Reading STL, OBJ and PLY files: the same surface from every format, and what is said about bad files.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/base/errors/errors.hpp"
#include "core/triangles/triangle_reader.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test_triangle_reader {
namespace {

namespace fs = std::filesystem;

/// A file for one test, removed afterwards.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& extension, const std::string& bytes) {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    file_ = (fs::temp_directory_path() /
             (std::string("cgcontact_") + info->name() + std::to_string(std::hash<std::string>()(bytes)) + extension))
                .string();
    std::ofstream(file_, std::ios::binary) << bytes;
  }
  ~TemporaryFile() { fs::remove(file_); }
  const std::string& name() const { return file_; }

 private:
  std::string file_;
};

std::string message_of(const std::string& extension, const std::string& bytes) {
  const TemporaryFile file(extension, bytes);
  try {
    read_triangles(file.name());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_message(const std::string& extension, const std::string& bytes, const std::string& words) {
  const std::string message = message_of(extension, bytes);
  EXPECT_NE(message.find(words), std::string::npos) << words << "\n  in: " << message;
}

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 0\n outer loop\n vertex " + a + "\n vertex " + b + "\n vertex " + c +
         "\n endloop\nendfacet\n";
}

const TriangleSoup tetrahedron = test::tetrahedron_soup();

std::string text_of(const Vec3& x) {
  return std::to_string(x[0]) + " " + std::to_string(x[1]) + " " + std::to_string(x[2]);
}

std::string stl_text() {
  std::string text = "solid t\n";
  for (const Triangle& t : tetrahedron.triangles)
    text +=
        facet(text_of(tetrahedron.points[t[0]]), text_of(tetrahedron.points[t[1]]), text_of(tetrahedron.points[t[2]]));
  return text + "endsolid t\n";
}

template <class T>
std::string raw(T value, bool reversed = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (reversed) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// The header may say "solid", as that of an ASCII file.
std::string stl_binary(const std::string& header) {
  std::string bytes = header + std::string(80 - header.size(), ' ') + raw<std::uint32_t>(4);
  for (const Triangle& t : tetrahedron.triangles) {
    bytes += std::string(12, '\0');
    for (int p : t)
      for (int k = 0; k < 3; ++k) bytes += raw(static_cast<float>(tetrahedron.points[p][k]));
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string obj_text(bool relative) {
  std::string text = "# comment\no t\n";
  for (const Vec3& x : tetrahedron.points) text += "v " + text_of(x) + "\n";
  text += "vn 0 0 1\n";
  for (const Triangle& t : tetrahedron.triangles) {
    text += "f";
    for (int p : t) text += " " + std::to_string(relative ? p - 4 : p + 1) + (relative ? "" : "//1");
    text += "\n";
  }
  return text;
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
         "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string ply_text() {
  std::string text = ply_header("ascii");
  for (const Vec3& x : tetrahedron.points) text += text_of(x) + " 255\n";
  for (const Triangle& t : tetrahedron.triangles)
    text += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  return text;
}

std::string ply_binary(bool big) {
  std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian");
  for (const Vec3& x : tetrahedron.points) {
    for (int k = 0; k < 3; ++k) bytes += raw(static_cast<float>(x[k]), big);
    bytes += raw<std::uint8_t>(255);
  }
  for (const Triangle& t : tetrahedron.triangles) {
    bytes += raw<std::uint8_t>(3);
    for (int p : t) bytes += raw<std::int32_t>(p, big);
  }
  return bytes;
}

// Proves that every format gives the same corners in the same order, with equal points shared.
TEST(TriangleReader, AllFormatsGiveTheSameSurface) {
  const std::pair<std::string, std::string> files[] = {
      {".stl", stl_text()},        {".stl", stl_binary("part")}, {".STL", stl_binary("solid part")},
      {".obj", obj_text(false)},   {".obj", obj_text(true)},     {".ply", ply_text()},
      {".ply", ply_binary(false)}, {".ply", ply_binary(true)}};
  for (const auto& [extension, bytes] : files) {
    const TemporaryFile file(extension, bytes);
    const TriangleSoup soup = read_triangles(file.name());
    ASSERT_EQ(soup.triangles.size(), 4u) << extension;
    EXPECT_EQ(soup.points.size(), 4u) << extension;
    for (std::size_t t = 0; t < 4; ++t)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(soup.points[soup.triangles[t][k]], tetrahedron.points[tetrahedron.triangles[t][k]]) << extension;
  }
}

// Proves that polygons become triangles and messages can name the line of a facet.
TEST(TriangleReader, PolygonsAndLines) {
  const TemporaryFile file(".obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\nf 1 2 3 4\n");
  const TriangleSoup soup = read_triangles(file.name());
  ASSERT_EQ(soup.triangles.size(), 2u);
  EXPECT_EQ(soup.location(1), "triangle 1 (line 6) at (0.333333, 0.666667, 0)");
}

// Proves that OFF is read with comments, counts behind the header, colours and normals, and that inward corners are.
TEST(TriangleReader, OffFiles) {
  const std::string corners = "0 0 0\n3 0 0\n1 1 0 # inward\n0 3 0\n";
  for (const std::string& text :
       {"OFF 4 1 0\n" + corners + "4 0 1 2 3 255 0 0\n", "# part\nOFF\n\n4 1 4\n" + corners + "4 0 1 2 3\n",
        std::string("COFF\n4 1 0\n0 0 0 1 1 1 1\n3 0 0 1 1 1 1\n1 1 0 1 0 0 1\n0 3 0 1 1 1 1\n"
                    "4 0 1 2 3\n")}) {
    const TemporaryFile file(".off", text);
    const TriangleSoup soup = read_triangles(file.name());
    ASSERT_EQ(soup.points.size(), 4u) << text;
    ASSERT_EQ(soup.triangles.size(), 2u) << text;
    double area = 0;
    for (const Triangle& t : soup.triangles)
      area += (soup.points[t[1]] - soup.points[t[0]]).cross(soup.points[t[2]] - soup.points[t[0]])[2] / 2;
    EXPECT_DOUBLE_EQ(area, 3) << text;
  }
}

// Proves that bad files give their file, line and what is wrong.
TEST(TriangleReader, BadFilesAreNamed) {
  expect_message(".stl", "", "the file is empty");
  expect_message(".stp", "x", "unknown kind of file \".stp\" (allowed: .stl, .obj, .ply, .off)");
  expect_message(".stl", "solid t\nendsolid t\n", "there is no triangle");
  expect_message(".stl", stl_text().substr(0, 200), ".stl:11: the file ends here: is it truncated?");
  expect_message(".stl", "solid t\n" + facet("0 0 0", "1 0 0", "0 1 0"), ":8: the file ends before \"endsolid\"");
  expect_message(".stl", stl_binary("part").substr(0, 200),
                 "it announces 4 facets, 284 bytes, and has 200 bytes: is it");
  expect_message(".stl", "just text", "neither an ASCII STL file");
  expect_message(".stl", "solid t\n" + facet("0 0 0", "1 0 0", "0 nan 0"), ".stl:6: \"nan\" is not finite");
  expect_message(".stl", "solid t\n" + facet("0 0 0", "1 0 0", "0 1"),
                 ":6: a number is missing (allowed: vertex x y z)");
  expect_message(".stl", "solid t\nfacet normal 0 0 0\nendfacet\n", ":3: a facet with 0 vertices (allowed: three)");
  expect_message(".stl", "solid t\nfacit\n", ":2: \"facit\" is no word of an STL file");
  expect_message(".obj", "v 0 0 0\nf 1 2 3\n", ":2: face 1 refers to vertex 2 of 1");
  expect_message(".obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", ":3: face 1 has fewer than three corners");
  expect_message(".obj", "v 0 0 0\nv 3 0 0\nv 0 1 0\nv 3 3 0\nf 1 2 4\nf 1 2 3 4\n", ":6: face 2 crosses itself");
  expect_message(".off", "OF\n", ":1: \"of\" does not begin an OFF file");
  expect_message(".off", "OFF BINARY\n", ":1: the file is in binary OFF");
  expect_message(".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", ":4: the file ends before its last vertex: is it truncated?");
  expect_message(".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
                 ":6: face 1 refers to vertex 3 (allowed: 0 to 2)");
  expect_message(".off", "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", ":4: a number is missing (allowed: x y z)");
  expect_message(".obj", "v 0 0 1e999\n", ":1: ");
  expect_message(".ply", "plu\n", ":1: a PLY file begins with \"ply\"");
  expect_message(".ply", ply_header("ascii"), "the file ends before its 4 elements \"vertex\"");
  expect_message(".ply", ply_binary(true).substr(0, ply_binary(true).size() - 5),
                 "the file ends before its 4 elements");
  expect_message(".ply", "ply\nformat text 1.0\n", ":2: unknown format \"text\"");
  float infinite = std::numeric_limits<float>::infinity();
  std::string bytes = stl_binary("part");
  std::memcpy(bytes.data() + 84 + 50 + 12, &infinite, 4);
  expect_message(".stl", bytes, "triangle 2 has a coordinate that is not finite");
}

}  // namespace
}  // namespace cgcontact::test_triangle_reader

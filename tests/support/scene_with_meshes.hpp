/// Scenes of the repository with bodies from mesh files instead of CSG bodies.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/run_scene.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test {

/// A copy of a scene in a folder of its own, in which shapes of [[body]] sections are replaced by STL files in
/// millimetres.
class SceneWithMeshes {
 public:
  explicit SceneWithMeshes(const std::string& scene) {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("cgcontact_") + info->name());
    std::filesystem::create_directories(folder_);
    std::ostringstream text;
    text << std::ifstream(std::filesystem::path(CGCONTACT_SOURCE_DIR) / "scenes" / scene).rdbuf();
    text_ = text.str();
    replace("\"data/", "\"" + std::string(CGCONTACT_SOURCE_DIR) + "/scenes/data/");
  }
  ~SceneWithMeshes() { std::filesystem::remove_all(folder_); }

  /// The faces x- .. z+ get the names xm .. zp.
  void replace_box(const std::string& body, const Vec3& min, const Vec3& max) {
    write_stl(body + ".stl", box_soup(1000 * min, 1000 * max));
    const std::size_t section = text_.find("name = \"" + body + "\""), start = text_.find("box = {", section);
    const std::size_t end = text_.find("}}", start);
    std::string mesh = "mesh = {file = \"" + body + ".stl\", unit = \"mm\", faces = [";
    for (int k = 0; k < 3; ++k)
      for (const int sign : {-1, 1}) {
        const Vec3 n = sign * Vec3::Unit(k);
        std::ostringstream face;
        face << "{name = \""
             << "xyz"[k] << (sign < 0 ? 'm' : 'p') << "\", normal = {axis = [" << n[0] << ", " << n[1] << ", " << n[2]
             << "], angle = 1}}, ";
        mesh += face.str();
        replace(body + ".block." + "xyz"[k] + (sign < 0 ? "-" : "+"),
                body + ".block." + "xyz"[k] + (sign < 0 ? "m" : "p"));
      }
    const std::size_t at = text_.find("box = {", section);
    text_.replace(at, end - start + 1, mesh + "]}");
  }

  struct MeshFace {
    std::string csg;       ///< face of the scene's body that it stands for, "quarter.x-"
    std::string name;      ///< of the face of the mesh
    std::string selector;  ///< as in the scene file, "normal = {..}"; empty: selected by an earlier one of this name
  };

  /// The shape of a body becomes a mesh "part" (soup in m), in the rest of the scene "body.csg" becomes
  /// "body.part.name".
  void replace_shape(const std::string& body, TriangleSoup soup, const std::vector<MeshFace>& faces) {
    for (Vec3& x : soup.points) x *= 1000;
    write_stl(body + ".stl", soup);
    std::string list;
    for (const MeshFace& face : faces) {
      replace(body + "." + face.csg, body + ".part." + face.name);
      if (!face.selector.empty()) list += "{name = \"" + face.name + "\", " + face.selector + "}, ";
    }
    const std::size_t body_at = text_.find("name = \"" + body + "\"");
    const std::size_t section = text_.find("[body.shape]", body_at), value = text_.find("shape = {", body_at);
    const std::size_t start = std::min(section, value);
    const std::size_t end = section < value ? text_.find("\n[[", start) : text_.find("]}\n", start) + 2;
    text_.replace(
        start, end - start,
        "shape = {name = \"part\", mesh = {file = \"" + body + ".stl\", unit = \"mm\", faces = [" + list + "]}}\n");
  }

  std::unique_ptr<SolvedScene> run(const std::vector<std::string>& overrides) const {
    const std::string file = (folder_ / "scene.toml").string();
    std::ofstream(file) << text_;
    auto solved = std::make_unique<SolvedScene>();
    solved->scene = read_scene(file, overrides);
    solved->simulation = std::make_unique<Simulation>(solved->scene);
    solved->simulation->run({});
    return solved;
  }

 private:
  void replace(const std::string& from, const std::string& to) {
    for (std::size_t at = text_.find(from); at != std::string::npos; at = text_.find(from, at + to.size()))
      text_.replace(at, from.size(), to);
  }
  void write_stl(const std::string& name, const TriangleSoup& soup) const {
    std::ofstream file(folder_ / name);
    file.precision(17);
    file << "solid block\n";
    for (const Triangle& t : soup.triangles) {
      file << "facet normal 0 0 0\nouter loop\n";
      for (int p : t) file << "vertex " << soup.points[p].transpose() << "\n";
      file << "endloop\nendfacet\n";
    }
    file << "endsolid block\n";
  }

  std::filesystem::path folder_;
  std::string text_;
};

}  // namespace cgcontact::test

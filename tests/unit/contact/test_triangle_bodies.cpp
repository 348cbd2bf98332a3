/// Whole runs with bodies read from mesh files: the same results as with CSG bodies.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/run_scene.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact {
namespace {

namespace fs = std::filesystem;

/// A copy of a scene in a folder of its own, in which boxes of [[body]] sections are replaced by STL files in
/// millimetres.
class SceneWithMeshes {
 public:
  explicit SceneWithMeshes(const std::string& scene) {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("cgcontact_") + info->name());
    fs::create_directories(folder_);
    std::ostringstream text;
    text << std::ifstream(fs::path(CGCONTACT_SOURCE_DIR) / "scenes" / scene).rdbuf();
    text_ = text.str();
    replace("\"data/", "\"" + std::string(CGCONTACT_SOURCE_DIR) + "/scenes/data/");
  }
  ~SceneWithMeshes() { fs::remove_all(folder_); }

  /// The faces x- .. z+ get the names xm .. zp.
  void replace_box(const std::string& body, const Vec3& min, const Vec3& max) {
    write_stl(body + ".stl", test::box_soup(1000 * min, 1000 * max));
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

  std::unique_ptr<test::SolvedScene> run(const std::vector<std::string>& overrides) const {
    const std::string file = (folder_ / "scene.toml").string();
    std::ofstream(file) << text_;
    auto solved = std::make_unique<test::SolvedScene>();
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

  fs::path folder_;
  std::string text_;
};

// Proves that a block read from an STL file behaves as the CSG block: forces, pressures and counts of the paper's
// scene, with one body replaced (mixed with CSG) and with both. 1e-9 of the largest: rounding through the active set
// and the recovery.
TEST(TriangleBodies, TwoSolidsAreThoseOfCsg) {
  const auto csg = test::run_scene("scenes/two_solids_3d.toml", {"n=8"});
  for (const bool both : {false, true}) {
    SceneWithMeshes scene("two_solids_3d.toml");
    scene.replace_box("lower", {0, 0, 0}, {0.01, 0.005, 0.01});
    if (both) scene.replace_box("upper", {0, 0, 0.01}, {0.01, 0.005, 0.02});
    const auto mesh = scene.run({"n=8"});
    const Results &a = csg->results(), &b = mesh->results();
    ASSERT_TRUE(b.converged);
    EXPECT_TRUE(b.warnings.empty());
    ASSERT_EQ(a.contact_rows.size(), b.contact_rows.size());
    double largest = 0, worst = 0, worst_place = 0;
    for (std::size_t i = 0; i < a.contact_rows.size(); ++i) {
      largest = std::max(largest, std::abs(a.contact_rows[i].pressure_sprc));
      // The order of the points in a cell may differ.
      const ContactRow* nearest = &b.contact_rows[0];
      for (const ContactRow& row : b.contact_rows)
        if (row.body == a.contact_rows[i].body &&
            (row.x - a.contact_rows[i].x).norm() < (nearest->x - a.contact_rows[i].x).norm())
          nearest = &row;
      worst_place = std::max(worst_place, (nearest->x - a.contact_rows[i].x).norm());
      worst = std::max({worst, std::abs(nearest->pressure_sprc - a.contact_rows[i].pressure_sprc),
                        std::abs(nearest->pressure_raw - a.contact_rows[i].pressure_raw)});
    }
    EXPECT_LT(worst_place, 1e-15);
    EXPECT_LT(worst / largest, 1e-9);
    EXPECT_LT((a.pairs[0].force_on_first - b.pairs[0].force_on_first).norm() / a.pairs[0].force_on_first.norm(), 1e-9);
    EXPECT_NEAR(a.estimated_error / b.estimated_error, 1, 1e-9);
  }
}

// Proves that the contact patch test is exact with two bodies from STL files on shifted and turned grids; bound as
// there.
TEST(TriangleBodies, PatchTestIsExact) {
  SceneWithMeshes scene("patch_test.toml");
  scene.replace_box("lower", {0, 0, 0}, {1, 0.8, 0.6});
  scene.replace_box("upper", {0, 0, 0.6}, {1, 0.8, 1.1});
  const auto solved = scene.run({"solver.tolerance=1e-13", "solver.linear_tolerance=1e-15"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  double worst = 0;
  for (const ContactRow& row : r.contact_rows)
    for (double value : {row.pressure_raw, row.pressure_spr, row.pressure_sprc})
      worst = std::max(worst, std::abs(value - 1e8) / 1e8);
  EXPECT_LT(worst, 1e-10);
  EXPECT_LT(r.estimated_error_relative, 1e-10);
}

// Proves that curved contact faces of triangles work through the whole run: the example scene converges, and the forces
// on both bodies balance the reactions.
TEST(TriangleBodies, RailSceneConverges) {
  const auto solved = test::run_scene("scenes/rail.toml");
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_GT(r.pairs[0].force_on_first.norm(), 1e3);
}

}  // namespace
}  // namespace cgcontact

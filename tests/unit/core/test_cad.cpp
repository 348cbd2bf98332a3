// Bodies from CAD files: cells and boundary are those of the exact surfaces; files, names, units, placements, booleans.
#include <unistd.h>

#include <filesystem>
#include <random>
#include <thread>

#include "core/base/errors/errors.hpp"
#include "core/base/numbers/decompositions.hpp"
#include "core/bodies/cad_body.hpp"
#include "core/bodies/meridian.hpp"
#include "core/geometry/profile.hpp"
#include "core/scene_file/read_scene.hpp"
#include "tests/support/cad_parts.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/unit/core/cut_cells_checks.hpp"

namespace cgcontact::test_cad {
namespace {

constexpr double mm = 1e-3;

/// The parts as files, written once.
class Cad : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("cgcontact_cad_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    parts_ = test::write_cad_parts(folder_.string());
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  static std::string file(const std::string& name) { return (folder_ / name).string(); }
  static CadModel model(const std::string& name) { return read_cad(file(name + ".step"), {}).at(0).model; }
  /// Scaled to `cells` cells along its longest side.
  static Solid body(const CadModel& model, double cells) {
    const auto [low, high] = model.box();
    const Solid in_metres(std::make_shared<CadBody>(model, mm, mm * (high - low).maxCoeff() / cells));
    return in_metres.transformed(Mat3::Identity(), Vec3::Zero(), cells / (mm * (high - low).maxCoeff()));
  }

  static std::filesystem::path folder_;
  static std::vector<test::CadPart> parts_;
};
std::filesystem::path Cad::folder_;
std::vector<test::CadPart> Cad::parts_;

double size_of(const CadModel& model, double cells) {
  const auto [low, high] = model.box();
  return (high - low).maxCoeff() / cells;  // mm per cell
}

// Proves that volume and area are those of the exact surfaces (closed forms; OpenCASCADE's own integrals where there is
// none) at 10 cells per side in three positions. 1e-8 was asked. The boundary closes to 1e-6: normals are those of the
// surface, with points chosen to keep their integrals to 1e-6 per cell.
TEST_F(Cad, VolumeAndAreaAreExact) {
  for (const test::CadPart& part : parts_) {
    SCOPED_TRACE(part.name);
    const CadModel m = model(part.name);
    const double volume = part.volume > 0 ? part.volume : m.volume(), area = part.area > 0 ? part.area : m.area();
    EXPECT_NEAR(m.volume() / volume, 1, 1e-9);
    const double h = size_of(m, 10);
    const Solid solid = body(m, 10);
    for (const auto& [turn, fraction] :
         {std::pair(Mat3(Mat3::Identity()), Vec3(1, 1, 1)), std::pair(Mat3(Mat3::Identity()), Vec3(1.3, 1.7, 1.2)),
          std::pair(rotation(Vec3(1, 2, 3), 0.3), Vec3(1.1, 1.9, 1.4))}) {
      const CutCells cells = cut(solid, turn, fraction);
      const Totals sum = totals(cells);
      EXPECT_NEAR(sum.volume * h * h * h / volume, 1, 2e-9);
      EXPECT_NEAR(sum.area * h * h / area, 1, 2e-9);
      EXPECT_NEAR(sum.flux / sum.volume, 1, 1e-6);
      EXPECT_LT(sum.closure.norm() / sum.area, 1e-6);
      EXPECT_NEAR(area_by_cells(cells, {{Vec3(1, 2, 3).normalized(), 8}, {Vec3(1, 0, 0), 5}}, 2) / sum.area, 1, 1e-7);
    }
  }
}

// Proves that first moments are exact too: the centroid of a ball is its centre, that of a torus its middle. Slivers
// that stick out of their cells are counted where they are.
TEST_F(Cad, CentroidIsExact) {
  for (const std::string name : {"sphere", "torus"}) {
    const Solid solid = body(model(name), 10);
    const Vec3 fraction(1.3, 1.7, 1.2);
    Vec3 min, max;
    solid.bounding_box(min, max);
    const CutCells cells = cut(solid, Mat3::Identity(), fraction);
    const Vec3 centroid = first_moment(cells) / totals(cells).volume;
    EXPECT_LT((centroid - (fraction - min)).norm(), 1e-8) << name;
  }
}

// Proves that points and normals of the boundary are those of the sphere, not of triangles a hundredth of a cell from
// it: to rounding.
TEST_F(Cad, PointsLieOnTheSurface) {
  const CadModel m = model("sphere");
  const Solid solid = body(m, 10);
  const Vec3 shift(7, 8, 9);
  const CutCells cells = make_cut_cells(solid.transformed(Mat3::Identity(), shift), [] {
    Grid grid;
    grid.num_cells = {16, 16, 16};
    return grid;
  }());
  double off = 0, turned = 0;
  for (std::size_t i = 0; i < cells.boundary.size(); ++i) {
    const Vec3 r = cells.boundary.position[i] - shift;
    off = std::max(off, std::abs(r.norm() - 5));
    turned = std::max(turned, (cells.boundary.normal[i] - r.normalized()).norm());
  }
  EXPECT_LT(off, 1e-12);
  EXPECT_LT(turned, 1e-12);
}

// Proves that lines, distances, sides and nearest points are those of the exact surface: a sphere of radius 5.
TEST_F(Cad, SearchesMeetTheExactSurface) {
  const Solid solid = body(model("sphere"), 10);
  for (int k = 0; k < 200; ++k) {
    const Vec3 d = Vec3(std::sin(1.1 * k), std::cos(2.3 * k), std::sin(0.7 * k + 1)).normalized();
    std::vector<Crossing> found;
    solid.crossings(0.1 * d.unitOrthogonal(), d, 20, found);
    ASSERT_EQ(found.size() % 2, 0u);
    ASSERT_GE(found.size(), 2u);
    for (const Crossing& c : found) {
      const Vec3 x = 0.1 * d.unitOrthogonal() + c.t * d;
      EXPECT_NEAR(x.norm(), 5, 1e-12);
      EXPECT_LT((c.normal - x / 5).norm(), 1e-12);
    }
    EXPECT_TRUE(solid.contains(4.9999 * d));
    EXPECT_FALSE(solid.contains(5.0001 * d));
    EXPECT_NEAR(solid.distance_to_surfaces(5.004 * d), 0.004, 1e-12);
    EXPECT_NEAR(solid.surfaces()[0].near(5.3 * d).point.norm(), 5, 1e-12);
    EXPECT_LT((solid.surfaces()[0].gradient(5.3 * d) - d).norm(), 1e-12);
  }
}

// Proves that threads may share a body: four of them find the same crossings and distances as one does.
TEST_F(Cad, ThreadsShareABody) {
  const Solid solid = body(model("lofted"), 10);
  Vec3 min, max;
  solid.bounding_box(min, max);
  const auto look = [&] {
    std::vector<double> found;
    std::vector<Crossing> crossings;
    for (int k = 0; k < 500; ++k) {
      const Vec3 d = Vec3(std::sin(1.1 * k), std::cos(2.3 * k), std::sin(0.7 * k + 1)).normalized();
      crossings.clear();
      solid.crossings((min + max) / 2, d, 20, crossings);
      for (const Crossing& c : crossings) found.push_back(c.t);
      found.push_back(solid.distance_to_surfaces((min + max) / 2 + 3 * d));
    }
    return found;
  };
  const std::vector<double> alone = look();
  std::vector<std::vector<double>> together(4);
  std::vector<std::thread> threads;
  for (auto& result : together) threads.emplace_back([&] { result = look(); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : together) EXPECT_EQ(result, alone);
}

// Proves that smaller cells than those that the solid was read for get triangles of their own: they are a hundredth of
// the cells from the surface, whatever cells the solid was read for, and the volume is exact.
TEST_F(Cad, TrianglesFollowTheCells) {
  const CadModel m = model("cross_drilled");
  const Solid coarse = body(m, 5), fine = coarse.transformed(Mat3::Identity(), Vec3::Zero(), 8);
  EXPECT_LE(as_cad(coarse)->surface().sag, 0.01);
  EXPECT_LE(as_cad(fine)->surface().sag, 0.01);
  EXPECT_GT(fine.geometry().num_facets(), 2 * coarse.geometry().num_facets());
  const double h = size_of(m, 40);
  const Totals sum = totals(cut(fine, Mat3::Identity(), Vec3(1.3, 1.7, 1.2)));
  EXPECT_NEAR(sum.volume * h * h * h / m.volume(), 1, 1e-9);
  EXPECT_NEAR(sum.area * h * h / m.area(), 1, 1e-9);
}

// Proves that refined grids have the volume and area of the exact surfaces, and that the triangles of a level are small
// around its leaves only: there they are a hundredth of the cells from the surface, and their number does not grow with
// the surface of the body in cells of that level. The error of volume and area is where levels meet: their triangles
// are up to a hundredth of the coarser cells apart, so that strips as wide as that are missing or there twice (2e-6 and
// 4e-4 at worst, a torus; the same to 1e-12 with fine triangles everywhere).
TEST_F(Cad, RefinedGridsHaveFineTrianglesAtTheirLeavesOnly) {
  constexpr int max_levels = 6;
  for (const test::CadPart& part : parts_) {
    SCOPED_TRACE(part.name);
    const CadModel m = model(part.name);
    const double h = size_of(m, 10);
    const CutCells base = cut(body(m, 10), rotation({1, 2, 3}, 0.3), Vec3(1.2, 1.3, 1.1));
    const Vec3 point = base.boundary.position[base.boundary.size() / 3];
    const auto wanted = [&](const Vec3& low, const Vec3& high) {
      return std::max(1.0 / 32, 0.5 * (point - point.cwiseMax(low).cwiseMin(high)).norm());
    };
    const CellTree tree = refine_cells(base.solid.geometry(), base.grid, wanted, max_levels);
    ASSERT_EQ(tree.num_levels(), max_levels);
    const CutCells cells = make_cut_cells(base.solid, base.grid, {}, {}, tree);
    double volume = 0, area = 0;
    for (int a = 0; a < static_cast<int>(cells.cells.size()); ++a)
      volume += std::pow(cells.size(a), 3) * cells.volume_fraction(a);
    for (const double w : cells.boundary.weight) area += w;
    EXPECT_NEAR(volume * h * h * h / m.volume(), 1, 1e-5);
    EXPECT_NEAR(area * h * h / m.area(), 1, 1e-3);
    const Solid fine = base.solid.on_level(max_levels - 1, tree),
                all_fine = base.solid.transformed(Mat3::Identity(), Vec3::Zero(), std::ldexp(1.0, max_levels - 1));
    EXPECT_LE(as_cad(fine)->surface().sag, 0.01);
    EXPECT_LE(fine.geometry().num_facets(),
              std::max(2 * base.solid.geometry().num_facets(), all_fine.geometry().num_facets() / 4));
  }
}

// Proves that booleans with primitives are exact: half a sphere, and a bore through it whose rim is no conic.
// Reference: (pi R^3 / 3) 2, less the napkin ring 4/3 pi (R^2 - a^2)^(3/2) kept.
TEST_F(Cad, BooleansWithPrimitives) {
  const Solid ball(std::make_shared<CadBody>(model("sphere"), mm, mm));
  const auto exact = [](const Solid& solid) {
    const Totals sum =
        totals(cut(solid.transformed(Mat3::Identity(), Vec3::Zero(), 1 / mm), Mat3::Identity(), Vec3(1, 1.2, 1.3)));
    return sum.volume;
  };
  const auto half =
      combine_cad(BooleanOp::Kind::intersect, ball, Solid::half_space(Vec3::Zero(), Vec3(1, 0, 0), "cut"), mm);
  ASSERT_TRUE(half);
  EXPECT_NEAR(exact(*half) / (250 * pi / 3), 1, 1e-9);
  const auto names = half->surfaces();
  EXPECT_TRUE(std::any_of(names.begin(), names.end(), [](const Surface& s) {
    return s.kind == Surface::Kind::plane && s.names == std::vector<std::string>{"cut.plane"};
  }));
  const Solid drill = Solid::cylinder(Vec3(0, 0, -1), Vec3(0, 0, 1), 3 * mm, "drill");
  const auto ring = combine_cad(BooleanOp::Kind::subtract, ball, drill, mm);
  ASSERT_TRUE(ring);
  EXPECT_NEAR(exact(*ring) / (4 * pi / 3 * 64), 1, 1e-8);  // OpenCASCADE's edge is 1e-7 mm from both surfaces
  // A cone about the centre of the ball leaves 2/3 pi R^3 cos of its angle; its tip is inside.
  const Solid cone = Solid::cone(Vec3(0, 0, 9 * mm), Vec3::Zero(), 9 * mm, 0, "cone");
  const auto hollow = combine_cad(BooleanOp::Kind::subtract, ball, cone, mm);
  ASSERT_TRUE(hollow);
  EXPECT_NEAR(exact(*hollow) / (250 * pi / 3 * (1 + std::sqrt(0.5))), 1, 1e-8);
  const Solid box = Solid::box(Vec3::Constant(-2 * mm), Vec3::Constant(20 * mm), "box");
  const auto sum = combine_cad(BooleanOp::Kind::unite, ball, box, mm);
  ASSERT_TRUE(sum);
  EXPECT_GT(exact(*sum), 22.0 * 22 * 22);
  EXPECT_THROW(
      combine_cad(BooleanOp::Kind::intersect, ball, Solid::half_space(Vec3(1, 0, 0), Vec3(-1, 0, 0), "far"), mm),
      InputError);
}

// Proves that an assembly in inches comes with its placements, names, repeated parts and colours.
TEST_F(Cad, AssemblyInInches) {
  const std::vector<CadSolid> solids = read_cad(file("assembly.step"), {});
  ASSERT_EQ(solids.size(), 3u);
  const double inch = 25.4;
  EXPECT_EQ(solids[0].name, "bolt_1");
  EXPECT_EQ(solids[1].name, "bolt_2");
  EXPECT_EQ(solids[2].name, "base plate");
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(solids[k].model.volume() / std::pow(inch, 3), 80 * pi, 1e-6);
  const auto [low, high] = solids[0].model.box();
  EXPECT_LT((low / inch - Vec3(6, -2, 0)).norm(), 1e-6);
  EXPECT_LT((high / inch - Vec3(10, 2, 20)).norm(), 1e-6);
  const CadFace& end = solids[1].model.faces()[1];  // the bolt turned by 30 degrees about x
  EXPECT_LT((end.axis - Vec3(0, -0.5, std::sqrt(0.75))).norm(), 1e-9);
  const std::vector<CadFace>& faces = solids[2].model.faces();
  const auto seat = std::find_if(faces.begin(), faces.end(), [](const CadFace& f) { return f.name == "seat"; });
  ASSERT_NE(seat, faces.end());
  EXPECT_EQ(seat->kind, "plane");
  EXPECT_LT((seat->axis - Vec3(0, 0, 1)).norm(), 1e-12);
  ASSERT_TRUE(seat->colour);
  EXPECT_EQ(*seat->colour, (std::array<int, 3>{255, 0, 0}));
}

// Proves that planes, cylinders and cones that a file has as B-splines are told, with radii, half angles and outward
// normals, those of the shapes before they were made B-splines. A ball stays free-form.
TEST_F(Cad, SplinesOfSimpleShapes) {
  const std::vector<CadSolid> pin = read_cad(file("spline_pin.step"), {}),
                              boxes = read_cad(file("spline_boxes.step"), {}),
                              round = read_cad(file("spline_cone_and_ball.step"), {});
  const auto count = [](const CadSolid& solid, const std::string& kind) {
    const std::vector<CadFace>& faces = solid.model.faces();
    return std::count_if(faces.begin(), faces.end(), [&](const CadFace& face) { return face.kind == kind; });
  };
  ASSERT_EQ(pin.size(), 2u);
  for (const CadSolid& solid : pin)
    for (const CadFace& face : solid.model.faces())
      if (face.kind == "cylinder") {
        EXPECT_NEAR(face.radius, 5, 1e-9);
        EXPECT_NEAR(std::abs(face.axis[2]), 1, 1e-12);
      }
  EXPECT_EQ(count(pin[0], "cylinder"), 1);
  EXPECT_EQ(count(pin[0], "plane"), 6);
  EXPECT_EQ(count(pin[1], "cylinder"), 1);
  EXPECT_EQ(count(pin[1], "plane"), 2);
  ASSERT_EQ(boxes.size(), 2u);
  for (const CadSolid& solid : boxes) {
    EXPECT_EQ(count(solid, "plane"), 6);
    Vec3 middle = Vec3::Zero();
    for (const CadFace& face : solid.model.faces()) middle += face.middle / 6;
    for (const CadFace& face : solid.model.faces()) {
      EXPECT_GT(face.axis.dot((face.middle - middle).normalized()), 1 - 1e-9);
      EXPECT_NEAR(face.axis.norm(), 1, 1e-12);
    }
  }
  ASSERT_EQ(round.size(), 2u);
  EXPECT_EQ(count(round[0], "cone"), 1);
  EXPECT_EQ(count(round[0], "plane"), 2);
  for (const CadFace& face : round[0].model.faces())
    if (face.kind == "cone") {
      EXPECT_NEAR(face.half_angle, std::atan(1.0 / 3), 1e-9);
    }
  EXPECT_EQ(count(round[1], "other"), 1);
}

TEST_F(Cad, SizesOfFacesInWords) {
  const auto size = [&](const std::string& name, const std::string& kind) {
    const CadModel part = model(name);
    for (const CadFace& face : part.faces())
      if (face.kind == kind) return cad_size_text(face, mm, "m");
    return "no " + kind;
  };
  EXPECT_EQ(size("torus", "torus"), "ring radius 0.005 m, tube radius 0.002 m");
  EXPECT_EQ(size("cone", "cone"), "half-angle 18.4349 degrees");
  EXPECT_EQ(size("sphere", "sphere"), "radius 0.005 m");
  EXPECT_EQ(size("cone", "plane"), "");
}

// Proves that a solid from a child process is the file's to the last bit: read twice, it has the same figures and the
// same triangles, whose curves and surfaces lie on each other.
TEST_F(Cad, ReadTwiceIsTheSame) {
  const CadModel first = model("cross_drilled"), second = model("cross_drilled");
  ASSERT_EQ(first.faces().size(), second.faces().size());
  EXPECT_EQ(first.volume(), second.volume());
  const CurvedTriangles a = first.triangles(0.01), b = second.triangles(0.01);
  ASSERT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.curves.size(), b.curves.size());
  EXPECT_LE(a.largest_sag(), 2 * 0.01 * (1 + 1e-9));  // middles of triangles: twice that of sides
  for (std::size_t k = 0; k < a.points.size(); ++k) ASSERT_EQ(a.points[k], b.points[k]);
  const std::vector<double> distances = first.distances({0, 1}, Vec3(100, 0, 0));
  ASSERT_EQ(distances.size(), 2u);
  for (const double distance : distances) EXPECT_GT(distance, 50);
}

// Proves that IGES and BREP files give the same box.
TEST_F(Cad, OtherFormats) {
  for (const std::string name : {"box.igs", "box.brep"}) {
    const std::vector<CadSolid> solids = read_cad(file(name), {});
    ASSERT_EQ(solids.size(), 1u) << name;
    EXPECT_NEAR(solids[0].model.volume(), 1000, 1e-6) << name;
    EXPECT_EQ(solids[0].model.faces().size(), 6u) << name;
  }
}

// Proves that what cannot be read is refused with what is wrong: face and gap where a surface is open.
TEST_F(Cad, BadFiles) {
  const auto refused = [&](const std::string& name, bool repair, const std::vector<std::string>& words) {
    expect_contains(message_of([&] { read_cad(file(name), {repair}); }), words);
  };
  refused("missing.step", false, {"missing.step: cannot be opened"});
  refused("text.step", false, {"is not a STEP file"});
  refused("empty.step", false, {"is not a STEP file"});
  refused("part.stl", false, {"is not the name of a CAD file", ".iges"});
  refused("open_box.step", false, {"open surface", "4 of its edges", "face 1 (plane)", "10 mm from", "repair = true"});
  refused("open_box.step", true, {"stays open"});
  refused("loose_box.step", false, {"open surface", "face", "0.001 mm from"});
}

// Proves that a repair closes a gap of a thousandth of a millimetre and says what it did.
TEST_F(Cad, Repair) {
  const std::vector<CadSolid> solids = read_cad(file("loose_box.step"), {true});
  ASSERT_EQ(solids.size(), 1u);
  expect_contains(solids[0].repair, {"gaps of up to", "area", "before", "after"});
  EXPECT_NEAR(solids[0].model.volume(), 1000, 0.11);  // the gap's volume is 0.1 mm^3
}

/// The scene of one body with this shape, held somewhere.
Scene scene_of(const std::string& folder, const std::string& cad, const std::string& face = "cad") {
  return parse_scene(
      "[[body]]\nname = \"part\"\nmaterial = {E = 1e9, nu = 0.3}\ncell_size = 2e-3\n[body.shape]\ncad = {" + cad +
          "}\n[[support]]\nface = \"part." + face + "\"\nsymmetry = true\n",
      folder + "/scene.toml", {});
}

/// The solid of a scene with this shape, in cells of 8 mm, and the area of one of its faces, m^2.
std::pair<Solid, double> solid_of(const std::string& shape, const std::string& face) {
  const Scene scene =
      parse_scene("[[body]]\nname = \"part\"\nmaterial = \"steel\"\ncell_size = \"8 mm\"\nshape = " + shape +
                      "\n[[support]]\nface = \"part." + face + "\"\nsymmetry = true\n",
                  "shape.toml", {});
  double area = 0;
  for (const CadFace& f : as_cad(scene.bodies[0].solid)->model().faces())
    if (scene.supports[0].face.face.selects(f.names)) area += f.area * mm * mm;
  return {scene.bodies[0].solid, area};
}

// Proves that tori, and arcs beside the axis of a turned profile, are exact at 10 cells along the longest side, also
// cut and combined with other shapes. References: Pappus' theorems.
TEST_F(Cad, ToriOfAScene) {
  const double ring = 30 * mm, tube = 10 * mm, groove = 5 * mm, h = 8 * mm;
  const double volume = 2 * pi * pi * ring * tube * tube, area = 4 * pi * pi * ring * tube;
  const double cut_out = 2 * pi * (ring - 4 * groove / (3 * pi)) * pi * groove * groove / 2;
  const double wall = 2 * pi * (ring - 2 * groove / pi) * pi * groove;
  const std::string torus =
      "{torus = {center = [0, 0, 0], axis = [1, 2, 3], ring_radius = \"30 mm\", tube_radius = \"10 mm\"}}";
  const struct {
    std::string shape, face;
    double volume, area, face_area;
  } cases[] = {
      {torus, "torus", volume, area, area},
      {"{intersection = [" + torus + ", {half_space = {point = [0, 0, 0], normal = [3, 0, -1]}}]}", "torus.surface",
       volume / 2, area / 2 + 2 * pi * tube * tube, area / 2},
      {"{difference = [{cylinder = {base = [0, 0, 0], top = [0, 0, \"20 mm\"], radius = \"30 mm\"}}, {torus = {center "
       "= [0, 0, "
       "\"10 mm\"], ring_radius = \"30 mm\", tube_radius = \"5 mm\"}}]}",
       "torus.surface", pi * ring * ring * 20 * mm - cut_out, 2 * pi * ring * ring + 2 * pi * ring * 10 * mm + wall,
       wall},
      {"{name = \"disc\", revolve = {axis = [0, 1, 0], profile = [[\"10 mm\", 0], [\"30 mm\", 0], [\"30 mm\", \"5 "
       "mm\"], {to = "
       "[\"30 mm\", \"15 mm\"], through = [\"25 mm\", \"10 mm\"], name = \"groove\"}, [\"30 mm\", \"20 mm\"], [\"10 "
       "mm\", \"20 "
       "mm\"]]}}",
       "disc.groove", pi * (ring * ring - tube * tube) * 20 * mm - cut_out,
       2 * pi * (ring * ring - tube * tube) + 2 * pi * (ring * 10 * mm + tube * 20 * mm) + wall, wall},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.shape);
    const auto [solid, face_area] = solid_of(c.shape, c.face);
    // OpenCASCADE's edges of booleans are 1e-7 mm from both surfaces, its own areas are those of its rules
    EXPECT_NEAR(face_area / c.face_area, 1, 1e-6);
    for (const double angle : {0.0, 0.7}) {
      const Totals sum = totals(cut(solid.transformed(Mat3::Identity(), Vec3::Zero(), 1 / h),
                                    rotation({1, 2, 3}, angle), Vec3(0.7, 0.2, 0.4)));
      EXPECT_NEAR(sum.volume * h * h * h / c.volume, 1, 1e-8);
      EXPECT_NEAR(sum.area * h * h / c.area, 1, 1e-8);
    }
  }
  // A line along x beside the middle of the ring meets it in four points.
  const double y = 3 * mm, z = 2 * mm, across = std::sqrt(tube * tube - z * z);
  const double inner = std::sqrt(std::pow(ring - across, 2) - y * y),
               outer = std::sqrt(std::pow(ring + across, 2) - y * y);
  const Solid flat =
      solid_of("{torus = {center = [0, 0, 0], ring_radius = \"30 mm\", tube_radius = \"10 mm\"}}", "torus").first;
  std::vector<Crossing> found;
  flat.crossings({0, y, z}, Vec3::UnitX(), 1, found);
  std::sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) { return a.t < b.t; });
  ASSERT_EQ(found.size(), 4u);
  for (int k = 0; k < 4; ++k) {
    const double t[] = {-outer, -inner, inner, outer};
    EXPECT_NEAR(found[k].t, t[k], 1e-12);
    const Vec3 x(t[k], y, z), foot = ring * Vec3(t[k], y, 0).normalized();
    EXPECT_LT((found[k].normal - (x - foot) / tube).norm(), 1e-9);
  }
  expect_contains(
      message_of([&] { solid_of("{torus = {center = [0, 0, 0], ring_radius = 1, tube_radius = \"2 m\"}}", "torus"); }),
      {"shape.toml:5: body[0].shape.torus.tube_radius = \"2 m\": is not less than ring_radius", "< 1 m"});
}

// Proves that faces are found by number, name, colour, kind and size, normal and position, and that what selects
// nothing is refused with what there is.
TEST_F(Cad, FacesOfAScene) {
  const auto area = [&](const std::string& cad, const std::string& face) {
    const Scene scene = scene_of(folder_.string(), cad, face);
    const FaceSpec& spec = scene.supports[0].face.face;
    double sum = 0;
    const std::vector<CadFace>& faces = as_cad(scene.bodies[0].solid)->model().faces();
    for (const CadFace& f : faces)
      if (spec.selects(f.names)) sum += f.area;
    return sum;
  };
  const std::string plate = "file = \"assembly.step\", solid = \"base plate\"";
  const double in2 = 25.4 * 25.4;
  EXPECT_NEAR(area(plate, "seat") / in2, 900, 1e-6);
  EXPECT_NEAR(area(plate, "face1") / in2, 150, 1e-6);
  EXPECT_NEAR(area(plate + ", faces = [{name = \"red\", color = \"#ff0000\"}]", "red") / in2, 900, 1e-6);
  EXPECT_NEAR(area(plate + ", faces = [{name = \"up\", called = \"seat\"}]", "up") / in2, 900, 1e-6);
  EXPECT_NEAR(area(plate + ", faces = [{name = \"two\", number = [1, 2]}]", "two") / in2, 300, 1e-6);
  EXPECT_NEAR(area(plate + ", faces = [{name = \"low\", normal = {axis = [0, 0, -1], angle = 5}}]", "low") / in2, 900,
              1e-6);
  EXPECT_NEAR(area(plate + ", faces = [{name = \"near\", nearest = [0.5, 0, -0.05]}]", "near") / in2, 150, 1e-6);
  EXPECT_NEAR(
      area("file = \"cross_drilled.step\", faces = [{name = \"hole\", kind = \"cylinder\", radius = 2e-3}]", "hole"),
      area("file = \"cross_drilled.step\", faces = [{name = \"hole\", radius = \"4e-3/2\"}]", "hole"), 1e-12);
  const auto refused = [&](const std::string& cad, const std::vector<std::string>& words) {
    expect_contains(message_of([&] { scene_of(folder_.string(), cad); }), words);
  };
  refused("file = \"assembly.step\"",
          {"scene.toml:6", "cad.file", "3 solids", "\"bolt_1\", \"bolt_2\", \"base plate\""});
  refused("file = \"assembly.step\", solid = \"bolt1\"",
          {"cad.solid = \"bolt1\"", "no such solid", "did you mean \"bolt_1\"?"});
  refused("file = \"assembly.step\", solid = 4", {"cad.solid = 4", "1 to 3"});
  refused(plate + ", unit = \"mm\"", {"unit", "the file says its unit"});
  refused("file = \"box.brep\"", {"unit", "does not say its unit"});
  refused(plate + ", faces = [{name = \"a\", called = \"seet\"}]", {"called = \"seet\"", "allowed: seat"});
  refused(plate + ", faces = [{name = \"a\", color = \"red\"}]", {"is no colour", "#rrggbb"});
  refused(plate + ", faces = [{name = \"a\", color = \"#00ff00\"}]", {"#ff0000"});
  refused(plate + ", faces = [{name = \"a\", kind = \"cilinder\"}]", {"kind", "did you mean \"cylinder\"?"});
  refused(plate + ", faces = [{name = \"a\", kind = \"cylinder\"}]", {"no face of the solid is so", "allowed: plane"});
  refused(plate + ", faces = [{name = \"a\", radius = 1}]", {"the file has none"});
  refused(plate + ", faces = [{name = \"a\"}]", {"selects nothing", "nearest"});
  refused(plate + ", faces = [{name = \"face2\", number = 1}]", {"is a name that the file gives a face"});
  refused(plate + ", faces = [{name = \"a\", number = 9}]", {"1 to 6"});
}

/// Sections of rings with grooves and of a torus, turned or not, hold the same points; a ball on one side of a groove
/// has a seam in the half-plane. Faces keep their names.
TEST_F(Cad, SectionsOfBodiesOfRevolution) {
  const ProfileFrame frame{Vec3(0, 0, 3), Vec3::UnitX(), Vec3::UnitZ()};
  const CadModel torus = CadModel::revolved({{Vec2(12, 0), Vec2(12, 0), "ring.surface", true, Vec2(8, 0)}}, frame);
  // An arc whose centre is nearer to the axis than to the arc: OpenCASCADE's section of its face is an approximation.
  const Vec2 end(0.28942441457783873, 0.014382728292267499), middle(0.1699280129588892, 0.0035989201295916208);
  const CadModel punch = CadModel::revolved({{Vec2(0, 0), Vec2(0.05, 0), "tip", false, Vec2()},
                                             {Vec2(0.05, 0), end, "tip", true, middle},
                                             {end, Vec2(end[0], 0.15), "side", false, Vec2()},
                                             {Vec2(end[0], 0.15), Vec2(0, 0.15), "top", false, Vec2()},
                                             {Vec2(0, 0.15), Vec2(0, 0), "axis", false, Vec2()}},
                                            {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitZ()});
  const std::vector<CadSolid> rings = read_cad(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/data/bearing.step", {});
  std::vector<CadModel> models{torus, punch};
  for (const CadSolid& solid : rings)
    if (solid.name == "inner" || solid.name == "outer") models.push_back(solid.model);
  ASSERT_EQ(models.size(), 4u);
  std::mt19937 random(7);
  for (const CadModel& each : models)
    for (const int axis : {2, 0}) {
      const auto [low, high] = each.box();
      const double size = mm * (high - low).maxCoeff();
      Solid whole(std::make_shared<CadBody>(each, mm, size / 40));
      if (axis == 0) whole = whole.transformed(rotation_between(Vec3::UnitZ(), Vec3::UnitX()), Vec3::Zero());
      const Solid section = meridian_of(whole, axis);
      std::uniform_real_distribution<double> away(0, 0.55 * size), along(-0.4 * size, 0.4 * size);
      int inside = 0;
      for (int i = 0; i < 3000; ++i) {
        Vec3 x = Vec3::Zero();
        x[axis] = along(random);
        x[(axis + 1) % 3] = away(random);
        if (whole.distance_to_surfaces(x) < 1e-3 * size) continue;  // triangles stand for the body there
        EXPECT_EQ(section.contains(x), whole.contains(x)) << x.transpose();
        inside += section.contains(x);
      }
      EXPECT_GT(inside, 50);
      for (const Surface& face : whole.surfaces())
        EXPECT_TRUE(std::any_of(section.surfaces().begin(), section.surfaces().end(), [&](const Surface& surface) {
          return surface.names == face.names;
        })) << face.names.front();
    }
  const CadModel box = model("box");
  EXPECT_THROW(meridian_of(Solid(std::make_shared<CadBody>(box, mm, 1e-3)), 2), InputError);
}

}  // namespace
}  // namespace cgcontact::test_cad

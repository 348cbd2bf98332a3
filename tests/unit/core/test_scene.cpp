#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "core/base/errors/suggest.hpp"
#include "core/scene_file/read_scene.hpp"

namespace cgcontact::test_scene {
namespace {

namespace fs = std::filesystem;

const fs::path root = CGCONTACT_SOURCE_DIR;

std::string scene_file(const std::string& name) { return (root / "scenes" / name).lexically_normal().string(); }

/// what() of the InputError that reading throws, or "" if there is none.
std::string message_of(const std::string& file, const std::vector<std::string>& overrides = {}) {
  try {
    read_scene(file, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_contains(const std::string& text, const std::vector<std::string>& wanted) {
  for (const std::string& words : wanted) EXPECT_NE(text.find(words), std::string::npos) << words << "\n  in: " << text;
}

/// A scene file for one test, removed afterwards.
class TemporaryScene {
 public:
  explicit TemporaryScene(const std::string& text) {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    file_ = (fs::temp_directory_path() /
             (std::string("cgcontact_") + info->name() + std::to_string(std::hash<std::string>()(text)) + ".toml"))
                .string();
    std::ofstream(file_) << text;
  }
  ~TemporaryScene() { fs::remove(file_); }
  const std::string& file() const { return file_; }

 private:
  std::string file_;
};

const char* const one_block = R"(
[[body]]
name = "block"
shape = {box = {min = [0, 0, 0], max = [1, 2, 3]}}
material = {E = 1, nu = 0}
cell_size = 0.3

[[support]]
face = "block.z-"
symmetry = true
)";

// ---- scenes that come with the program

TEST(Scene, two_solids_has_the_values_of_the_file) {
  const Scene scene = read_scene(scene_file("two_solids.toml"));
  ASSERT_EQ(scene.bodies.size(), 2u);
  const BodySpec& lower = scene.bodies[0];
  EXPECT_EQ(lower.name, "lower");
  EXPECT_EQ(lower.material.youngs_modulus, 115e9);
  EXPECT_EQ(lower.material.poisson_ratio, 0.3);
  EXPECT_DOUBLE_EQ(lower.cell_size, 0.01 / 16);
  EXPECT_EQ(lower.grid_offset, Vec3(0.11, 0.19, 0.242));
  EXPECT_EQ(lower.grid_rotation, Mat3(Mat3::Identity()));
  EXPECT_TRUE(lower.body_force[2].is_zero());
  Vec3 min, max;
  ASSERT_TRUE(lower.solid.bounding_box(min, max));
  EXPECT_EQ(max[0], scene.bodies[1].cell_size) << "the upper body is one cell thick";
  EXPECT_EQ(max[1], 0.005);

  ASSERT_EQ(scene.supports.size(), 8u);
  EXPECT_TRUE(scene.supports[0].symmetry);
  EXPECT_FALSE(scene.supports[7].symmetry);
  EXPECT_FALSE(scene.supports[7].displacement[0]);
  ASSERT_TRUE(scene.supports[7].displacement[2]);
  EXPECT_EQ((*scene.supports[7].displacement[2])(Vec3(0, 0, 0)), -1.6e-6);
  EXPECT_EQ(scene.supports[7].face.body, 1);
  EXPECT_EQ(scene.supports[7].face.face.surfaces, std::vector<std::string>{"block.z+"});

  ASSERT_EQ(scene.loads.size(), 1u);
  EXPECT_DOUBLE_EQ(scene.loads[0].pressure(Vec3(0, 0, 0.005)), 1e7);
  EXPECT_DOUBLE_EQ(scene.loads[0].traction[2](Vec3(0, 0, 0.005)), -2.5e7);
  EXPECT_TRUE(scene.loads[0].traction[1].is_zero());

  ASSERT_EQ(scene.contacts.size(), 1u);
  EXPECT_EQ(scene.contacts[0].name, "lower-upper");
  EXPECT_EQ(scene.contacts[0].second.face.surfaces, std::vector<std::string>{"block.z-"});
  EXPECT_EQ(scene.contacts[0].interference, 0);

  EXPECT_EQ(scene.solver.kappa, 10);
  EXPECT_EQ(scene.output.directory, (fs::path("out") / "two_solids").string());
  EXPECT_NEAR(*scene.reference.force, 39179.7 / 2 * 0.01 / (1.3 * 16), 1e-9);
  EXPECT_TRUE(fs::exists(scene.reference.pressure_file));
  ASSERT_EQ(scene.reference.zones.size(), 3u);
  EXPECT_EQ(scene.reference.zones[1].first, "edge");
  EXPECT_NE(scene.reference.zones[1].second(Vec3(0, 2.5e-3, 0)), 0);
  EXPECT_EQ(scene.reference.zones[1].second(Vec3(0, 1.5e-3, 0)), 0);
}

TEST(Scene, three_dimensional_two_solids_differs_in_thickness) {
  const Scene scene = read_scene(scene_file("two_solids_3d.toml"), {"n=8"});
  Vec3 min, max;
  ASSERT_TRUE(scene.bodies[0].solid.bounding_box(min, max));
  EXPECT_EQ(max[0], 0.01);
  EXPECT_DOUBLE_EQ(scene.bodies[0].cell_size, 0.01 / 8);
  EXPECT_NEAR(*scene.reference.force, 195.8985, 1e-9);
}

TEST(Scene, patch_test_has_a_rotated_grid) {
  const Scene scene = read_scene(scene_file("patch_test.toml"), {"angle=90", "body.upper.grid.rotation.axis=[0,0,2]"});
  Mat3 quarter_turn;
  quarter_turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_NEAR((scene.bodies[1].grid_rotation - quarter_turn).norm(), 0, 1e-15);
  EXPECT_EQ((*scene.reference.pressure)(Vec3(0, 0, 0)), 1e8);
  EXPECT_EQ(scene.reference.stress_of_body[1][2](Vec3(0, 0, 0)), -1e8);
}

/// Lame: the radial stresses meet at the interface, vanish on the free sides, and the displacement jumps by delta.
TEST(Scene, reference_of_rings_is_lames_solution) {
  const Scene scene = read_scene(scene_file("rings.toml"));
  ASSERT_EQ(scene.reference.stress_of_body.size(), 2u);
  const double b = 0.7, nu = 0.3, modulus = 200e9;
  const auto stress = [&](int body, double r) {
    const Vec3 x = r * Vec3(0.6, 0.8, 0);
    Sym3 s;
    for (int k = 0; k < 6; ++k) s[k] = scene.reference.stress_of_body[body][k](x);
    Mat3 axes;
    axes << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
    return Mat3(axes.transpose() * tensor(s) * axes);
  };
  const double p = (*scene.reference.pressure)(Vec3(0, 0, 0));
  for (const int body : {0, 1}) {
    EXPECT_NEAR(stress(body, b)(0, 0), -p, 1e-9 * p);
    EXPECT_NEAR(stress(body, body == 0 ? 0.4 : 1.0)(0, 0), 0, 1e-9 * p);
    EXPECT_NEAR(stress(body, 0.77)(0, 1), 0, 1e-9 * p);
  }
  const auto radial_displacement = [&](int body) {
    const Mat3 s = stress(body, b);
    EXPECT_NEAR(s(2, 2), nu * (s(0, 0) + s(1, 1)), 1e-9 * p) << "plane strain";
    return b / modulus * (s(1, 1) - nu * (s(0, 0) + s(2, 2)));
  };
  EXPECT_NEAR(radial_displacement(1) - radial_displacement(0), scene.contacts[0].interference, 1e-13);
  EXPECT_EQ(scene.contacts[0].interference, 1e-4);
}

/// Lame: the shell's stress at the interface and on the free side, equilibrium, and the displacement jumps by delta.
TEST(Scene, reference_of_sphere_in_shell_is_lames_solution) {
  const Scene scene = read_scene(scene_file("sphere_in_shell.toml"));
  ASSERT_EQ(scene.reference.stress_of_body.size(), 2u);
  const double b = 0.7, c = 1.0, nu = 0.3, modulus = 200e9;
  const Vec3 e(0.48, 0.6, 0.64), across(-0.78086880944303028, 0.62469504755442429, 0);
  const auto stress = [&](int body, double r) {
    Sym3 s;
    for (int k = 0; k < 6; ++k) s[k] = scene.reference.stress_of_body[body][k](r * e);
    return Mat3(tensor(s));
  };
  const auto radial = [&](int body, double r) { return e.dot(stress(body, r) * e); };
  const auto hoop = [&](int body, double r) { return across.dot(stress(body, r) * across); };
  const double p = (*scene.reference.pressure)(Vec3(0, 0, 0));
  for (const int body : {0, 1}) {
    EXPECT_NEAR(radial(body, b), -p, 1e-9 * p);
    EXPECT_NEAR((stress(body, b) * e + p * e).norm(), 0, 1e-9 * p) << "no shear";
  }
  EXPECT_NEAR(radial(1, c), 0, 1e-9 * p);
  const double r = 0.83, step = 1e-4;
  const double slope = (radial(1, r + step) - radial(1, r - step)) / (2 * step);
  EXPECT_NEAR(slope + 2 / r * (radial(1, r) - hoop(1, r)), 0, 1e-6 * p) << "equilibrium";
  const auto displacement = [&](int body, double at) {
    return at / modulus * ((1 - nu) * hoop(body, at) - nu * radial(body, at));
  };
  const double strain = (displacement(1, r + step) - displacement(1, r - step)) / (2 * step);
  EXPECT_NEAR(modulus * strain, radial(1, r) - 2 * nu * hoop(1, r), 1e-6 * p) << "compatibility";
  EXPECT_NEAR(displacement(1, b) - displacement(0, b), scene.contacts[0].interference, 1e-13);
}

/// Hertz's pressure follows the computed force: its integral over the quarter's circle is that force.
TEST(Scene, reference_of_hertz_is_that_of_the_computed_force) {
  const Scene scene = read_scene(scene_file("hertz.toml"));
  for (const double force : {1.0, 2e7}) {
    const ReferenceSpec reference = scene.reference_at(force);
    const double reduced_modulus = 200e9 / (2 * (1 - 0.09));
    const double a = std::cbrt(3 * 4 * force / (4 * reduced_modulus));
    EXPECT_NEAR((*reference.pressure)(Vec3(0, 0, 0)) / (2 * a * reduced_modulus / pi), 1, 1e-12);
    EXPECT_EQ((*reference.pressure)(Vec3(a, 0.1 * a, 0)), 0);
    const int steps = 2000;
    double integral = 0;
    for (int k = 0; k < steps; ++k) {
      const double r = a * (k + 0.5) / steps;
      integral += pi / 2 * r * (a / steps) * (*reference.pressure)(Vec3(r, 0, 0));
    }
    EXPECT_NEAR(integral / force, 1, 1e-4);
    EXPECT_NE(reference.zones[0].second(Vec3(0.7 * a, 0, 0)), 0);
    EXPECT_EQ(reference.zones[0].second(Vec3(0.9 * a, 0, 0)), 0);
  }
  EXPECT_EQ((*scene.reference_at(0).pressure)(Vec3(0, 0, 0)), (*scene.reference.pressure)(Vec3(0, 0, 0)));
}

/// Integers that no double meets are rounded like any other number.
TEST(Scene, long_integers_are_numbers) {
  const Scene scene = read_scene(scene_file("two_solids.toml"), {"body.lower.material.E=9007199254740993",
                                                                 "body.upper.material.E=1000000000000000001"});
  EXPECT_EQ(scene.bodies[0].material.youngs_modulus, 9007199254740992.0);
  EXPECT_EQ(scene.bodies[1].material.youngs_modulus, 1e18);
}

/// --set adds whole sections that the file does not have.
TEST(Scene, sections_can_be_added) {
  const Scene scene = read_scene(scene_file("two_solids.toml"), {"solver={kappa=20}"});
  EXPECT_EQ(scene.solver.kappa, 20);
}

TEST(Scene, contact_force_is_no_name_for_a_parameter) {
  for (const char* key : {"parameters", "reference.parameters"})
    expect_contains(message_of(scene_file("hertz.toml"), {std::string(key) + ".contact_force=3"}),
                    {".contact_force = 3", "cannot be the name of a parameter"});
}

TEST(Scene, reference_force_is_not_compared_with_itself) {
  expect_contains(message_of(scene_file("hertz.toml"), {"reference.force=contact_force"}),
                  {"reference.force = \"contact_force\"", "is a result"});
}

TEST(Scene, every_scene_of_the_program_is_good) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(root / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_EQ(message_of(entry.path().string()), "");
    ++count;
  }
  EXPECT_GE(count, 6);
}

/// Bodies, their faces, regions and operands of shapes: the same scene as written out by hand, line by line.
TEST(Scene, copies_are_what_they_would_be_written_out) {
  const TemporaryScene copied(R"toml([parameters]
Z = 3

[[body]]
copies = "Z"
name = "ball_{i}"
shape = {sphere = {center = ["10*cos(2*pi*{i}/Z)", "{i}", 0], radius = 1}}
material = {E = "{i}e9", nu = 0}
cell_size = 0.3

[[body]]
name = "plate"
shape = {difference = [{name = "all", box = {min = [0, 0, -9], max = [9, 9, -8]}}, {copies = 2, name = "hole_{i}", cylinder = {base = ["3*{i}", 4, -10], top = ["3*{i}", 4, 0], radius = 1}}]}
material = "steel"
cell_size = 0.5
refine = [{sphere = {center = [0, 0, -8], radius = 1}, size = 0.25}, {copies = 2, sphere = {center = ["{i}", 0, -8], radius = 1}, size = "0.25/{i}"}]

[[support]]
face = "plate.all.z-"
displacement = {x = 0, y = 0, z = 0}

[[load]]
copies = 3
face = "ball_{i}.surface"
force = [0, 0, "-{i}"]

[[contact]]
copies = "Z"
faces = ["ball_{i}.surface", "plate.all.z+"]
)toml");
  const Scene scene = read_scene(copied.file());
  ASSERT_EQ(scene.bodies.size(), 4U);
  for (int i = 1; i <= 3; ++i) {
    const BodySpec& ball = scene.bodies[i - 1];
    EXPECT_EQ(ball.name, "ball_" + std::to_string(i));
    EXPECT_EQ(ball.material.youngs_modulus, i * 1e9);
    Vec3 low, high;
    ball.solid.bounding_box(low, high);
    EXPECT_LT((0.5 * (low + high) - Vec3(10 * std::cos(2 * pi * i / 3), i, 0)).norm(), 1e-12);
    EXPECT_EQ(scene.loads[i - 1].face.body, i - 1);
    EXPECT_EQ(scene.loads[i - 1].force, Vec3(0, 0, -i));
    EXPECT_EQ(scene.contacts[i - 1].first.body, i - 1);
    EXPECT_EQ(scene.contacts[i - 1].name, ball.name + "-plate");
  }
  const BodySpec& plate = scene.bodies[3];
  ASSERT_EQ(plate.refine.size(), 3U);
  EXPECT_EQ(plate.refine[1].size, 0.25);
  EXPECT_EQ(plate.refine[2].size, 0.125);
  EXPECT_TRUE(plate.solid.contains(Vec3(1, 1, -8.5)));
  EXPECT_FALSE(plate.solid.contains(Vec3(3, 4, -8.5)));
  EXPECT_FALSE(plate.solid.contains(Vec3(6, 4, -8.5)));
  // --set sees what is written in the file; the number of copies may be a parameter.
  EXPECT_EQ(read_scene(copied.file(), {"body.ball_{i}.material.E={i}e6"}).bodies[1].material.youngs_modulus, 2e6);
  expect_contains(message_of(copied.file(), {"Z=2"}), {":24: load[2].face = \"ball_3.surface\""});
  expect_contains(message_of(copied.file(), {"Z=1001"}), {":5: body[0].copies = \"Z\"", "1 to 1000"});
}

// ---- bad scenes

// A mesh is read relative to the scene file, scaled, placed, and its faces can be referred to; its size tells a wrong
// unit.
TEST(Scene, bodies_from_mesh_files) {
  const Scene scene = read_scene(scene_file("rail.toml"), {"body.rail.shape.translate=[1, 0, 0]"});
  const BodySpec& rail = scene.bodies[0];
  Vec3 min, max;
  ASSERT_TRUE(rail.solid.bounding_box(min, max));
  EXPECT_TRUE(min.isApprox(Vec3(1, -0.024, 0), 1e-12)) << min.transpose();
  EXPECT_TRUE(max.isApprox(Vec3(1.048, 0.024, 0.048), 1e-12)) << max.transpose();
  ASSERT_EQ(rail.notes.size(), 1u);
  expect_contains(rail.notes[0], {"data/rail.stl: 208 triangles in 1 shell, 0.048 x 0.048 x 0.048 m"});
  EXPECT_TRUE(rail.warnings.empty());
  EXPECT_EQ(scene.contacts[0].second.face.surfaces, std::vector<std::string>{"profile.tread"});
  EXPECT_TRUE(scene.bodies[1].notes.empty());
  expect_contains(
      message_of(scene_file("rail.toml"), {"body.rail.shape.mesh.unit=um"}),
      {"body[0].cell_size", "is more than the whole body, which is 4.8e-05 m long: is the unit of the mesh right?"});
  expect_contains(message_of(scene_file("rail.toml"), {"body.rail.shape.mesh.scale=1"}), {"has both unit and scale"});
  expect_contains(message_of(scene_file("rail.toml"), {"body.rail.shape.mesh.faces.tread.smooth={triangle=999}"}),
                  {"faces[1].smooth.triangle = 999: there is no such triangle"});
}

/// On top for all bodies, or in a body; both ends become symmetry planes of their own, after the supports of the scene.
TEST(Scene, plane_strain_of_the_scene_or_a_body) {
  const std::string second = R"(
[[body]]
name = "other"
shape = {box = {min = [2, 0, 0], max = [3, 2, 3]}}
material = {E = 1, nu = 0}
cell_size = 1
)";
  const TemporaryScene all(std::string("plane_strain = \"z\"\n") + one_block + second);
  const Scene scene = read_scene(all.file());
  for (const BodySpec& body : scene.bodies) EXPECT_EQ(body.plane_strain, Coordinate::z);
  ASSERT_EQ(scene.supports.size(), 5u);
  EXPECT_FALSE(scene.supports[0].implied);
  for (int k = 1; k < 5; ++k) {
    const SupportSpec& end = scene.supports[k];
    EXPECT_TRUE(end.implied && end.symmetry);
    EXPECT_EQ(end.face.body, (k - 1) / 2);
    EXPECT_EQ(end.face.face.name, k % 2 ? "plane_strain.z-" : "plane_strain.z+");
    EXPECT_EQ(end.face.face.contains({}, Vec3(1, 1, 0), Vec3(0, 0, -1)), k % 2 == 1);
  }
  const TemporaryScene one(one_block + second + "plane_strain = \"y\"\n");
  const Scene of_body = read_scene(one.file());
  EXPECT_FALSE(of_body.bodies[0].plane_strain.has_value());
  EXPECT_EQ(of_body.bodies[1].plane_strain, Coordinate::y);
  EXPECT_EQ(of_body.supports.size(), 3u);
  // A grid may be turned about the axis only, and there is one axis.
  const TemporaryScene turned(one_block + second +
                              "grid = {rotation = {axis = [0, 0, -1], angle = 30}}\nplane_strain = \"y\"\n");
  expect_contains(message_of(turned.file()),
                  {"body[1].plane_strain = \"y\"", "turned about another axis", "about y only"});
  EXPECT_EQ(message_of(turned.file(), {"body.other.plane_strain=z"}), "");
  expect_contains(message_of(all.file(), {"body.other.plane_strain=x"}),
                  {"body[1].plane_strain", "another axis than that of an earlier body", "\"z\""});
}

/// Every file in tests/bad_scenes says in "# expect: text" lines what the message must contain; those of the stage
/// "solve" are found bad later, when there are grids.
TEST(Scene, bad_scenes_give_one_message_with_location_key_value_and_range) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(root / "tests" / "bad_scenes")) {
    std::ifstream stream(entry.path());
    std::vector<std::string> expected;
    bool found_by_reader = true;
    for (std::string line; std::getline(stream, line) && line.rfind("#", 0) == 0;) {
      if (line.rfind("# expect: ", 0) == 0) expected.push_back(line.substr(10));
      if (line == "# stage: solve") found_by_reader = false;
    }
    EXPECT_FALSE(expected.empty()) << entry.path();
    const auto start = std::chrono::steady_clock::now();
    const std::string message = message_of(entry.path().string());
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    if (found_by_reader)
      expect_contains(message, expected);
    else
      EXPECT_EQ(message, "") << entry.path();
    ++count;
  }
  EXPECT_GE(count, 30);
}

TEST(Scene, missing_file_is_named) {
  expect_contains(message_of("nowhere/scene.toml"), {"nowhere/scene.toml", "no such scene file"});
  expect_contains(message_of(root.string()), {"not a file"});
}

// ---- faces

TEST(Scene, faces_can_be_named_in_several_ways) {
  const TemporaryScene text(std::string(R"(
[[body]]
name = "plate"
shape = {difference = [{name = "slab", box = {center = [0, 0, 0], size = [4, 4, 1]}},
                       {cylinder = {base = [0, 0, -1], top = [0, 0, 1], radius = 1}},
                       {sphere = {center = [2, 2, 0], radius = 0.5}, translate = [0, 0, 1]},
                       {sphere = {center = [-2, 2, 0], radius = 0.5}}]}
material = {E = 1, nu = 0}
cell_size = 0.3
faces = [{name = "balls", surfaces = ["sphere", "sphere2.surface"]},
         {name = "corner", box = {min = [1, 1, -1], max = [2, 2, 1]}, normal = {axis = [2, 0, 0], angle = 60}}]
[[support]]
face = "plate.side"
symmetry = true
[[support]]
face = "plate.balls"
symmetry = true
[[support]]
face = "plate.slab"
symmetry = true
[[support]]
face = "plate.corner"
symmetry = true
)"));
  const Scene scene = read_scene(text.file());
  using Names = std::vector<std::string>;
  EXPECT_EQ(scene.supports[0].face.face.surfaces, Names{"cylinder.side"});
  EXPECT_EQ(scene.supports[1].face.face.surfaces, (Names{"sphere.surface", "sphere2.surface"}));
  EXPECT_EQ(scene.supports[2].face.face.surfaces.size(), 6u);
  const FaceSpec& corner = scene.supports[3].face.face;
  EXPECT_TRUE(corner.contains({"slab.x+"}, Vec3(2, 1.5, 0), Vec3(1, 0, 0)));
  EXPECT_FALSE(corner.contains({"slab.x+"}, Vec3(2, 0.5, 0), Vec3(1, 0, 0)));
  EXPECT_FALSE(corner.contains({"slab.y+"}, Vec3(1.5, 2, 0), Vec3(0, 1, 0)));
  EXPECT_TRUE(scene.supports[0].face.face.contains({"a.b", "cylinder.side"}, Vec3(0, 0, 0), Vec3(0, 0, 1)));
  EXPECT_FALSE(scene.supports[0].face.face.contains({"a.b"}, Vec3(0, 0, 0), Vec3(0, 0, 1)));
}

TEST(Scene, points_on_the_rim_of_a_flat_box_belong_to_the_face) {
  FaceSpec face;
  face.box = std::make_pair(Vec3(0, 0, 0.01), Vec3(1, 1, 0.01));
  EXPECT_TRUE(face.contains({}, Vec3(1, 0.5, 0.01 * (1 + 1e-15)), Vec3(0, 0, 1)));
  EXPECT_FALSE(face.contains({}, Vec3(1, 0.5, 0.0101), Vec3(0, 0, 1)));
}

TEST(Scene, ambiguous_face_is_refused) {
  const TemporaryScene text(R"(
[[body]]
name = "b"
shape = {union = [{box = {min = [0, 0, 0], max = [1, 1, 1]}}, {box = {min = [1, 0, 0], max = [2, 1, 1]}}]}
material = {E = 1, nu = 0}
cell_size = 0.3
[[support]]
face = "b.x-"
symmetry = true
)");
  expect_contains(message_of(text.file()), {"has no face \"x-\"", "b.box.x-", "b.box2.x+"});
}

// ---- shapes

TEST(Scene, materials_have_what_the_scene_says) {
  const TemporaryScene scene(one_block);
  const Material plain = read_scene(scene.file()).bodies[0].material;
  EXPECT_FALSE(plain.density || plain.expansion || plain.yield_stress);
  const Material full =
      read_scene(scene.file(), {"body.block.material={E = 2e11, nu = 0.3, density = 7850, expansion = 12e-6, yield = "
                                "235e6}"})
          .bodies[0]
          .material;
  EXPECT_EQ(full.density, 7850);
  EXPECT_EQ(full.expansion, 12e-6);
  EXPECT_EQ(full.yield_stress, 235e6);
}

TEST(Scene, shapes_are_turned_then_moved) {
  const TemporaryScene text(R"(
[[body]]
name = "bar"
shape = {box = {min = [0, 0, 0], max = [4, 1, 1]}, rotate = {axis = [0, 0, 1], angle = 90, center = [1, 0, 0]}, translate = [0, 0, 5]}
material = {E = 1, nu = 0}
cell_size = 0.3
[[support]]
face = "bar.x-"
symmetry = true
)");
  const Scene scene = read_scene(text.file());
  EXPECT_TRUE(scene.bodies[0].solid.contains(Vec3(0.5, 2.9, 5.5)));
  EXPECT_TRUE(scene.bodies[0].solid.contains(Vec3(0.5, -0.9, 5.5)));
  EXPECT_FALSE(scene.bodies[0].solid.contains(Vec3(0.5, 3.1, 5.5)));
  EXPECT_FALSE(scene.bodies[0].solid.contains(Vec3(0.5, 2.9, 0.5)));
}

TEST(Scene, operations_combine_solids) {
  const TemporaryScene text(R"(
[[body]]
name = "b"
shape = {difference = [{intersection = [{sphere = {center = [0, 0, 0], radius = 2}}, {half_space = {point = [0, 0, 0], normal = [0, 0, 3]}}]},
                       {cylinder = {base = [0, 0, -3], top = [0, 0, 1], radius = 0.5}}]}
material = {E = 1, nu = 0}
cell_size = 0.3
[[support]]
face = "b.plane"
symmetry = true
)");
  const Solid solid = read_scene(text.file()).bodies[0].solid;
  EXPECT_TRUE(solid.contains(Vec3(1, 0, -0.5)));
  EXPECT_FALSE(solid.contains(Vec3(0.1, 0, -0.5)));
  EXPECT_FALSE(solid.contains(Vec3(1, 0, 0.5)));
  EXPECT_FALSE(solid.contains(Vec3(1.5, 1.5, -0.5)));
}

// ---- contact

TEST(Scene, automatic_contact_joins_the_bodies_that_no_pair_joins) {
  std::string text = "[[contact]]\nautomatic = true\ninterference = 1e-3\n";
  text += "[[contact]]\nfaces = [\"c.x-\", \"a.x+\"]\n";
  for (const std::string name : {"a", "b", "c"})
    text += "[[body]]\nname = \"" + name +
            "\"\nshape = {box = {min = [0, 0, 0], max = [1, 1, 1]}}\nmaterial = {E = 1, nu = 0}\ncell_size = 0.1\n";
  text += "[[support]]\nface = \"a.z-\"\nsymmetry = true\n";
  const TemporaryScene file(text);
  const Scene scene = read_scene(file.file());
  ASSERT_EQ(scene.contacts.size(), 3u);
  EXPECT_EQ(scene.contacts[0].name, "c-a");
  EXPECT_EQ(scene.contacts[1].name, "a-b");
  EXPECT_EQ(scene.contacts[2].name, "b-c");
  EXPECT_FALSE(scene.contacts[0].automatic);
  EXPECT_TRUE(scene.contacts[2].automatic);
  EXPECT_EQ(scene.contacts[0].interference, 0);
  EXPECT_EQ(scene.contacts[2].interference, 1e-3);
  EXPECT_TRUE(scene.contacts[2].first.face.contains({"anything"}, Vec3(1, 2, 3), Vec3(0, 0, 1)));
}

// ---- --set

TEST(Scene, degree_of_the_recovery_is_one_number_or_a_table) {
  const auto degree = [](const std::vector<std::string>& overrides) {
    const RecoveryDegree d = read_scene(scene_file("rings.toml"), overrides).recovery.degree;
    return std::array<int, 3>{d.interior, d.boundary, d.contact};
  };
  EXPECT_EQ(degree({}), (std::array<int, 3>{1, 1, 0}));
  EXPECT_EQ(degree({"recovery.degree=1"}), (std::array<int, 3>{1, 1, 1}));
  EXPECT_EQ(degree({"recovery.degree=2"}), (std::array<int, 3>{2, 2, 2}));
  EXPECT_EQ(degree({"recovery.degree={boundary = 2, contact = 2}"}), (std::array<int, 3>{1, 2, 2}));
  EXPECT_EQ(degree({"recovery.degree.contact=2"}), (std::array<int, 3>{1, 1, 2}));
  EXPECT_EQ(read_scene(scene_file("rings.toml")).recovery.quadratic_rings, 0);
  EXPECT_EQ(read_scene(scene_file("rings.toml"), {"recovery.rings=4"}).recovery.quadratic_rings, 4);
  expect_contains(message_of(scene_file("rings.toml"), {"recovery.degree.contact=3"}),
                  {"recovery.degree.contact", "an integer from 0 to 2"});
  expect_contains(message_of(scene_file("rings.toml"), {"recovery.rings=5"}), {"an integer from 0 to 4"});
}

// A plain number instead of "0.08 mm" is in m, also where other parameters use it; an angle stays in degrees.
TEST(Overrides, numbers_have_the_si_unit_of_the_parameter_that_they_replace) {
  const std::string text = R"(
parameters = {c = "0.08 mm", d = "2*c + 1 mm", n = 3, w = "3000 rpm", tilt = "30 deg"}
rotation = {axis = [0, 0, 1], speed = "w"}
[[body]]
name = "a"
shape = {box = {min = [0, 0, 0], max = ["d", "1 mm + c", "1 mm"]}}
material = {E = 1e9, nu = 0.3, density = 1000}
cell_size = "1 mm/n"
grid = {rotation = {axis = [0, 0, 1], angle = "tilt"}}
[[support]]
face = "a.box.z-"
displacement = {x = 0, y = 0, z = 0}
)";
  const auto read = [&](const std::vector<std::string>& overrides) { return parse_scene(text, "a.toml", overrides); };
  const auto extent = [&](const Scene& scene) {
    Vec3 min, max;
    scene.bodies[0].solid.bounding_box(min, max);
    return max;
  };
  const Scene scene = read({"c=1e-4", "n=4"});
  EXPECT_DOUBLE_EQ(extent(scene)[0], 1.2e-3);
  EXPECT_DOUBLE_EQ(extent(scene)[1], 1.1e-3);
  EXPECT_DOUBLE_EQ(scene.bodies[0].cell_size, 0.25e-3);
  EXPECT_DOUBLE_EQ(extent(read({"d=5e-3"}))[0], 5e-3);
  EXPECT_DOUBLE_EQ(extent(read({"c=0.1 mm"}))[1], 1.1e-3);
  EXPECT_DOUBLE_EQ(read({"w=2"}).bodies[0].inertia.spin, 4000);
  const double cosine = std::cos(45 * 3.14159265358979323846 / 180);
  EXPECT_NEAR(read({"tilt=45"}).bodies[0].grid_rotation(0, 0), cosine, 1e-15);
  EXPECT_THROW(read({"n=4 mm"}), InputError) << "1 mm/n is no length then";
}

TEST(Overrides, change_values_by_name_index_and_parameter) {
  const std::string file = scene_file("two_solids.toml");
  EXPECT_DOUBLE_EQ(read_scene(file, {"n=32"}).bodies[0].cell_size, 0.01 / 32);
  EXPECT_DOUBLE_EQ(read_scene(file, {"parameters.n=8"}).bodies[1].cell_size, 0.01 / (1.3 * 8));
  EXPECT_EQ(read_scene(file, {"body.upper.cell_size=1e-3"}).bodies[1].cell_size, 1e-3);
  EXPECT_EQ(read_scene(file, {"body[1].cell_size=2e-3"}).bodies[1].cell_size, 2e-3);
  EXPECT_EQ(read_scene(file, {"body.0.cell_size=0.016/n"}).bodies[0].cell_size, 1e-3);
  EXPECT_EQ(read_scene(file, {"body.lower.grid.offset=[0, 0.1, 0.2]"}).bodies[0].grid_offset, Vec3(0, 0.1, 0.2));
  EXPECT_EQ(read_scene(file, {"body.lower.grid.offset.2=0.5"}).bodies[0].grid_offset[2], 0.5);
  EXPECT_EQ(read_scene(file, {"solver.tolerance=1e-8"}).solver.tolerance, 1e-8);
  EXPECT_EQ(read_scene(file, {"title=Another title"}).title, "Another title");
  EXPECT_EQ(read_scene(file, {"load.0.pressure=2*z"}).loads[0].pressure(Vec3(0, 0, 3)), 6);
  EXPECT_FALSE(read_scene(file, {"recovery.spr_c=false"}).recovery.spr_c);
}

TEST(Overrides, the_last_one_counts) {
  EXPECT_EQ(read_scene(scene_file("two_solids.toml"), {"n=8", "n=20"}).parameters.at("n"), 20);
}

TEST(Overrides, mistakes_name_the_option) {
  const std::string file = scene_file("two_solids.toml");
  const auto expect_message = [&](const std::string& option, const std::vector<std::string>& wanted) {
    const std::string message = message_of(file, {option});
    EXPECT_EQ(message.rfind("--set " + option + ": ", 0), 0u) << message;
    expect_contains(message, wanted);
  };
  expect_message("body.uper.cell_size=1", {"no element \"uper\"", "did you mean \"upper\"?"});
  expect_message("body.upper.cel_size=1", {"unknown key \"cel_size\"", "did you mean \"cell_size\"?"});
  expect_message("solvr.tolerance=1e-3", {"unknown key \"solvr\"", "did you mean \"solver\"?"});
  expect_message("body.upper.cell_size=-1", {"body[1].cell_size = -1: out of range", "(allowed: > 0 m)"});
  expect_message("body.upper.cell_size=true", {"is a boolean, not a number"});
  expect_message("body.5.cell_size=1", {"no element \"5\"", "0 to 1"});
  expect_message("m=5", {"no such parameter", "n, t"});
  expect_message("title.text=5", {"is a single value"});
  expect_message("n", {"has no value"});
  expect_message("=3", {"empty part"});
  for (const char* key : {"body[0.cell_size", "body[0]cell_size", "body0].cell_size", "body[[0]].cell_size", "body["})
    expect_message(std::string(key) + "=1e-3", {key, "bracket", "body[0].cell_size=1e-3"});
  expect_message("n=many", {"parameters.n = \"many\": unknown name \"many\""});
}

// ---- parameters

TEST(Parameters, may_refer_to_each_other_in_any_order) {
  const TemporaryScene text("[parameters]\na = \"2*b\"\nb = \"c + 1\"\nc = 3\n" + std::string(one_block));
  EXPECT_EQ(read_scene(text.file()).parameters.at("a"), 8);
  EXPECT_EQ(read_scene(text.file(), {"c=0"}).parameters.at("a"), 2);
}

TEST(Parameters, cannot_take_the_name_of_a_variable) {
  const TemporaryScene text("[parameters]\nx = 3\n" + std::string(one_block));
  expect_contains(message_of(text.file()), {":2: parameters.x = 3", "cannot be the name of a parameter"});
}

TEST(Parameters, out_of_range_results_show_the_values_used) {
  expect_contains(message_of(scene_file("hertz.toml"), {"n=-2"}), {"body[0].cell_size", "-0.25", "n = -2"});
  expect_contains(message_of(scene_file("rings.toml"), {"n=-2"}), {"rings.toml:", "-0.38"});
}

// ---- suggestions

TEST(Suggestion, edit_distance_counts_swaps_once) {
  EXPECT_EQ(edit_distance("cell_size", "cell_size"), 0);
  EXPECT_EQ(edit_distance("cellsize", "cell_size"), 1);
  EXPECT_EQ(edit_distance("cell_szie", "cell_size"), 1);
  EXPECT_EQ(edit_distance("", "abc"), 3);
}

TEST(Suggestion, is_given_for_similar_names_only) {
  EXPECT_EQ(closest_name("Offset", {"rotation", "offset"}), "offset");
  EXPECT_EQ(closest_name("w", {"x", "y"}), "");
  EXPECT_EQ(closest_name("banana", {"rotation", "offset"}), "");
}

}  // namespace
}  // namespace cgcontact::test_scene

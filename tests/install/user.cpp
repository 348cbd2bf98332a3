/// A user's program: runs a scene from a file, and one made in code, and checks what is known of both. Its own flags
/// have no -march=native: the figures show that its structs are those of the library.
#include <cgcontact/cgcontact.hpp>
#include <cmath>
#include <cstdio>
#include <vector>

using namespace cgcontact;

namespace {

int failures = 0;

void expect(const char* what, double value, double known, double tolerance) {
  const bool good = std::abs(value - known) <= tolerance * std::abs(known);
  std::printf("%s: %.10g, expected %.10g within %g: %s\n", what, value, known, tolerance, good ? "good" : "WRONG");
  failures += !good;
}

/// The paper's scene. Its reference: 39.18 kN per metre of thickness, good to 0.3 %; the program is 0.2 % off at n
/// = 16.
void run_file(const char* file) {
  const Scene scene = read_scene(file, {"n=16"});
  Simulation simulation(scene);
  simulation.run({});
  const Results& results = simulation.results;
  expect("converged", results.converged, 1, 0);
  const double force = results.pairs.at(0).force_on_first.norm();
  expect("force per thickness", 2 * force / scene.parameters.at("t"), 39.18e3, 0.01);
  double active_area = 0;
  for (const ContactRow& row : results.contact_rows)
    if (row.body == 0 && row.active) active_area += row.weight;
  expect("closed area of the lower body", active_area, results.pairs[0].area, 0.1);
}

/// A body from a CAD file: the module with OpenCASCADE is found. A quarter of the lug, whose eye is 30 mm and whose
/// round end another 12 mm above its sole.
void read_cad_file(const char* file) {
  const Scene scene = read_scene(file);
  Vec3 min, max;
  scene.bodies.at(0).solid.bounding_box(min, max);
  expect("height of the lug", max[2] - min[2], 42e-3, 1e-3);
}

FaceRef face(int body, const char* name) {
  FaceRef ref;
  ref.body = body;
  ref.face.name = name;
  ref.face.surfaces = {name};
  return ref;
}

BodySpec cube(const char* name, double z, double cell_size) {
  BodySpec body;
  body.name = name;
  body.solid = Solid::box({0, 0, z}, {1, 1, z + 1}, "cube");
  body.material = {200e9, 0};
  body.cell_size = cell_size;
  body.grid_offset = {0.1, 0.2, 0.3};
  return body;
}

SupportSpec held(int body, const char* name, int axis, double displacement) {
  SupportSpec support;
  support.face = face(body, name);
  support.displacement[axis] = Expression(displacement);
  return support;
}

/// Two cubes of side 1 m, one on the other, pressed by 1 mm: uniform pressure E * 1 mm / 2 m, exact for trilinear
/// cells.
void run_code() {
  Scene scene;
  scene.title = "Two cubes";
  scene.bodies = {cube("lower", 0, 0.26), cube("upper", 1, 0.33)};
  scene.supports = {held(0, "cube.z-", 2, 0), held(1, "cube.z+", 2, -1e-3), held(0, "cube.x-", 0, 0),
                    held(0, "cube.y-", 1, 0), held(1, "cube.x-", 0, 0),     held(1, "cube.y-", 1, 0)};
  ContactSpec contact;
  contact.name = "pair";
  contact.first = face(0, "cube.z+");
  contact.second = face(1, "cube.z-");
  scene.contacts = {contact};
  Simulation simulation(scene);
  simulation.run({});
  const PairFigures& pair = simulation.results.pairs.at(0);
  expect("contact force", -pair.force_on_first[2], 100e6, 1e-6);
  expect("maximum pressure", pair.max_pressure, 100e6, 1e-6);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const TrilinosScope trilinos(1);
  run_file(argv[1]);
  if (argc > 2) read_cad_file(argv[2]);
  run_code();
  return failures;
}

/// Fuzz target: any bytes as a triangle file; the first one chooses the format (s, o, p: STL, OBJ, PLY). Either it is
/// refused with an InputError, or it is a closed surface that can be asked for its nearest points and placed on a grid.
#include <cstdint>
#include <string>

#include "core/base/errors/errors.hpp"
#include "core/cells/cut_cells.hpp"
#include "core/triangles/triangle_checks.hpp"
#include "core/triangles/triangle_faces.hpp"
#include "core/triangles/triangle_reader.hpp"

namespace {

using namespace cgcontact;

constexpr std::size_t max_triangles = 64;

void use(const TriangleSoup& soup) {
  TriangleSurface surface = make_surface(soup, name_faces(soup, "part", {}), default_crease_angle);
  const Solid solid = Solid::bounded_by(std::move(surface));
  Vec3 min, max;
  solid.bounding_box(min, max);
  solid.contains(0.5 * (min + max));
  const double size = (max - min).maxCoeff() / 2.1;
  if (soup.triangles.size() > max_triangles || !(size > 0) || min.cwiseAbs().maxCoeff() > 1e8 * size) return;
  Grid grid;
  grid.cell_size = size;
  grid.origin = min - Vec3::Constant(0.45 * size);
  grid.num_cells = {3, 3, 3};
  make_cut_cells(solid.transformed(Mat3::Identity(), -grid.origin / size, 1 / size), grid);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const char* const extension = data[0] == 's' ? ".stl" : data[0] == 'o' ? ".obj" : ".ply";
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1), file = std::string("fuzzed") + extension;
  try {
    TriangleSoup soup = parse_triangles(file, bytes);
    repair_and_check(soup, file);
    use(soup);
  } catch (const InputError&) {
  }
  return 0;
}

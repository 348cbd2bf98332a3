/// Bodies bounded by triangles: reading, checking and cutting a sphere of triangles from a binary STL file.
/// Sizes are rings of the sphere (4 rings^2 triangles; 500: a million); the grid has 128 cells across at 500 rings.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include "core/cells/cut_cells.hpp"
#include "core/triangles/triangle_checks.hpp"
#include "core/triangles/triangle_faces.hpp"
#include "core/triangles/triangle_reader.hpp"
#include "perf/harness.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

/// A binary STL file that lasts as long as this object.
class StlFile {
 public:
  explicit StlFile(const TriangleSoup& soup)
      : name_((std::filesystem::temp_directory_path() / ("cgcontact_bench_" + std::to_string(getpid()) + ".stl"))) {
    std::ofstream file(name_, std::ios::binary);
    const auto count = static_cast<std::uint32_t>(soup.triangles.size());
    file.write(std::string(80, ' ').data(), 80);
    file.write(reinterpret_cast<const char*>(&count), 4);
    for (const Triangle& t : soup.triangles) {
      char facet[50] = {};
      float corners[9];
      for (int k = 0; k < 3; ++k)
        for (int d = 0; d < 3; ++d) corners[3 * k + d] = static_cast<float>(soup.points[t[k]][d]);
      std::memcpy(facet + 12, corners, sizeof(corners));
      file.write(facet, sizeof(facet));
    }
  }
  ~StlFile() { std::filesystem::remove(name_); }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

/// The sphere at the stages of its way into a grid.
struct Problem {
  explicit Problem(int rings) : file(test::sphere_soup(1, rings)), soup(read_triangles(file.name())) {
    const int cells = std::max(8, 128 * rings / 500);
    grid.num_cells = {cells, cells, cells};
    for (const Triangle& t : soup.triangles)
      volume += soup.points[t[0]].dot(soup.points[t[1]].cross(soup.points[t[2]])) / 6;
    volume *= std::pow(scale(), 3);
  }
  double scale() const { return 0.5 * (grid.num_cells[0] - 2); }
  Solid placed() const {
    const Solid solid = Solid::bounded_by(make_surface(soup, name_faces(soup, "ball", {}), default_crease_angle));
    return solid.transformed(Mat3::Identity(), Vec3::Constant(0.5 * grid.num_cells[0]) + Vec3(0.214, 0.232, 0.136),
                             scale());
  }
  double error(const CutCells& cells) const {
    double sum = 0;
    for (std::size_t a = 0; a < cells.cells.size(); ++a) sum += cells.volume_fraction(static_cast<int>(a));
    return std::abs(sum / volume - 1);
  }

  StlFile file;
  TriangleSoup soup;
  Grid grid;
  double volume = 0;  ///< that the triangles enclose, cell units
};

Kernel make_kernel(const Problem& problem) {
  Kernel k;
  k.unit = "triangles";
  k.items = static_cast<double>(problem.soup.triangles.size());
  return k;
}

Kernel read_stl(int rings) {
  auto p = std::make_shared<Problem>(rings);
  Kernel k = make_kernel(*p);
  k.run = [p] { benchmark::DoNotOptimize(read_triangles(p->file.name())); };
  return k;
}

Kernel check(int rings) {
  auto p = std::make_shared<Problem>(rings);
  Kernel k = make_kernel(*p);
  k.run = [p] {
    TriangleSoup soup = p->soup;
    benchmark::DoNotOptimize(repair_and_check(soup, "ball.stl"));
  };
  return k;
}

/// Faces, patches, search tree, placing in the grid.
Kernel make(int rings) {
  auto p = std::make_shared<Problem>(rings);
  Kernel k = make_kernel(*p);
  k.run = [p] { benchmark::DoNotOptimize(p->placed()); };
  return k;
}

/// Exact to rounding: the volume is that of the triangles.
Kernel cut(int rings) {
  auto p = std::make_shared<Problem>(rings);
  auto solid = std::make_shared<Solid>(p->placed());
  const CutCells cells = make_cut_cells(*solid, p->grid);
  Kernel k = make_kernel(*p);
  k.error = p->error(cells), k.tolerance = 1e-11, k.against = "the volume that the triangles enclose";
  k.run = [p, solid] { benchmark::DoNotOptimize(make_cut_cells(*solid, p->grid)); };
  k.figures = {{"cells", static_cast<double>(cells.moments.size())},
               {"points", static_cast<double>(cells.boundary.size())}};
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("triangles/read", read_stl, {{20}, {100, 500}});
    add("triangles/check", check, {{20}, {100, 500}});
    add("triangles/make", make, {{20}, {100, 500}});
    add("triangles/cut", cut, {{20}, {100, 500}});
  });
}

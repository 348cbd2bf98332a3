/// Cut cells: moments of planar and of curved cells, and the whole of make_cut_cells.
/// Sizes are cells along the body (diameter of the sphere, edge of the turned box).
#include <cmath>
#include <memory>

#include "core/bodies/cell_facets.hpp"
#include "core/cells/cut_cells.hpp"
#include "perf/harness.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

struct Body {
  const char* name;
  bool curved;
  Solid solid;
  Grid grid;
  double volume, area;  ///< exact, cell units
};

/// A box turned by 0.3 rad against its grid, or a sphere.
Body make_body(int size, bool curved) {
  Body body{curved ? "sphere" : "box", curved, {}, {}, 0, 0};
  const int cells = static_cast<int>(std::ceil((curved ? 1.0 : 1.8) * size)) + 2;
  body.grid.num_cells = {cells, cells, cells};
  const Vec3 centre = Vec3::Constant(0.5 * cells) + Vec3(0.214, 0.232, 0.136);
  if (curved) {
    const double r = 0.5 * size;
    body.solid = Solid::sphere(centre, r, "ball");
    body.volume = 4 * pi / 3 * r * r * r;
    body.area = 4 * pi * r * r;
  } else {
    const Mat3 turn = Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const Vec3 half = Vec3::Constant(0.5 * size);
    body.solid = Solid::box(-half, half, "block").transformed(turn, centre);
    body.volume = std::pow(size, 3);
    body.area = 6 * std::pow(size, 2);
  }
  return body;
}

/// Nominal: what is added up in the integration points of one cut cell; finding the points is left out, so that the
/// rates are lower bounds. Per point 250 flop for the 125 products, 50 for the three factors of degree 4 and the
/// weight, on curved surfaces 60 for height and normal. Planar: two parallelograms of 7 x 7 points. Curved: one and a
/// half nested rules of 12 x 12 points. Bytes: the moments, written once.
Cost moments_cost(bool curved) {
  return curved ? Cost{1.5 * 144 * 360, 2 * 8.0 * num_moments} : Cost{2 * 49 * 300, 2 * 8.0 * num_moments};
}

double volume_error(const Body& body, const CutCells& cc) {
  double volume = 0;
  for (std::size_t a = 0; a < cc.cells.size(); ++a) volume += cc.volume_fraction(static_cast<int>(a));
  return std::abs(volume - body.volume) / body.volume;
}

double area_error(const Body& body, const CutCells& cc) {
  double area = 0;
  for (double w : cc.boundary.weight) area += w;
  return std::abs(area - body.area) / body.area;
}

/// The stated accuracy: planar cells exact to rounding, curved ones to 1e-8 at 8 cells per diameter.
double tolerance(const Body& body) { return body.curved ? 1e-8 : 1e-12; }

/// Moments of the cut cells alone, classification done before.
Kernel moments(int size, bool curved) {
  struct Problem {
    Body body;
    CutCells cc;
    std::vector<LocalSolid> local;
    std::vector<Moments> result;
  };
  auto p = std::make_shared<Problem>(Problem{make_body(size, curved), {}, {}, {}});
  p->cc = make_cut_cells(p->body.solid, p->body.grid);
  for (int a : p->cc.active_of_cut) {
    const Index3& c = p->cc.cells[a];
    p->local.push_back(make_local_solid(*as_csg(p->cc.solid), Vec3(c[0], c[1], c[2]), 1));
  }
  p->result.resize(p->local.size());
  const auto run = [p] {
    for (std::size_t c = 0; c < p->local.size(); ++c)
      p->result[c] = cell_moments(*as_csg(p->cc.solid), p->local[c], p->cc.cells[p->cc.active_of_cut[c]]);
  };
  run();
  p->cc.moments = MomentList(p->result);
  Kernel k;
  k.unit = "cells";
  k.items = static_cast<double>(p->local.size());
  k.cost = moments_cost(curved);
  k.cost.flop *= k.items, k.cost.bytes *= k.items;
  k.error = volume_error(p->body, p->cc), k.tolerance = tolerance(p->body), k.against = "the exact volume";
  k.run = run;
  return k;
}

/// Classification, moments, boundary points. Items are cut cells; the model counts the moments only.
Kernel cut_cells(int size, bool curved) {
  auto body = std::make_shared<Body>(make_body(size, curved));
  const CutCells cc = make_cut_cells(body->solid, body->grid);
  Kernel k;
  k.unit = "cells";
  k.items = static_cast<double>(cc.moments.size());
  k.cost = moments_cost(curved);
  k.cost.flop *= k.items, k.cost.bytes *= k.items;
  k.error = std::max(volume_error(*body, cc), area_error(*body, cc));
  k.tolerance = tolerance(*body), k.against = "exact volume and area";
  k.run = [body] { benchmark::DoNotOptimize(make_cut_cells(body->solid, body->grid)); };
  k.figures = {{"points", static_cast<double>(cc.boundary.size())}};
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    for (const bool curved : {false, true}) {
      const std::string name = curved ? "curved" : "planar";
      add("moments/" + name, [curved](int size) { return moments(size, curved); }, {{8}, {16}});
      add("cut_cells/" + name, [curved](int size) { return cut_cells(size, curved); }, {{8}, {16}});
    }
  });
}

/// Calibration of the edge of contact zones (recovery/zone_edge) on Hertz's contacts of random
/// radii ratios, materials and grids (perf/edge_scenes): where the edges come out, in cells of the coarser body outside
/// of the exact ones, and what that makes of the pressure. None of these scenes is one of docs/accuracy.md.
///   edge_calibration [--seed 1] [--repeats 2] [--only FAMILY] [--toy]
///   edge_calibration --half-space: how far inside the sums of forces put an edge, by what the cells' stiffness does to
///   long waves of the pressure (docs/recovery.md, "Where the shift comes from")
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "contact/results/reference.hpp"
#include "contact/simulation.hpp"
#include "core/quadrature/gauss_rules.hpp"
#include "core/scene/read_scene.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "recovery/patch/contact_edge.hpp"
#include "recovery/zone_edge/edge_search.hpp"
#include "recovery/zone_edge/smooth_fall.hpp"

namespace {

using namespace cgcontact;

/// One scene of a family with its random settings.
struct Case {
  std::string family, file;
  double across;  ///< cells of the coarser body over the (shorter) width of the zone, about
  std::vector<std::string> settings;
};

/// Semi-axes and approach of Hertz's ellipse for radii of curvature with the given ratio (along y over along x), of
/// those of the sphere with the radius sqrt(R1 R2): Johnson, Contact Mechanics, eq. (4.26).
struct Ellipse {
  double along_x, along_y, approach;
};

Ellipse hertz_ellipse(double ratio) {
  // Complete elliptic integrals of e^2 = 1 - (a / b)^2 by their definition.
  const auto integrals = [](double a_over_b) {
    constexpr int steps = 400;
    const double square = 1 - a_over_b * a_over_b;
    double first = 0, second = 0;
    for (int i = 0; i < steps; ++i) {
      const double root = std::sqrt(1 - square * std::pow(std::sin(M_PI / 2 * (i + 0.5) / steps), 2));
      first += M_PI / 2 / steps / root;
      second += M_PI / 2 / steps * root;
    }
    return std::pair(first, second);
  };
  double low = 1e-3, high = 1 - 1e-9;  // a / b
  for (int i = 0; i < 100; ++i) {
    const double k = 0.5 * (low + high);
    const auto [K, E] = integrals(k);
    // Curvatures' ratio falls with k.
    ((E / (k * k) - K) / (K - E) > ratio ? low : high) = k;
  }
  const double k = 0.5 * (low + high), e2 = 1 - k * k;
  const auto [K, E] = integrals(k);
  if (ratio < 1 + 1e-6) return {1, 1, 1};
  // c^3 = (a b)^(3/2) = (3 F R / 4 Es) * 4 / (pi e^2) k^(3/2) sqrt((E / k^2 - K) (K - E)).
  const double c = std::cbrt(4 / (M_PI * e2) * std::pow(k, 1.5) * std::sqrt((E / (k * k) - K) * (K - E)));
  // approach = 3 F / (2 pi Es b) K, of F / Es = 4 / (3 R): sphere 1.
  const double a = c * std::sqrt(k), b = c / std::sqrt(k);
  return {a, b, 2 / (M_PI * b) * K};
}

std::vector<Case> make_cases(int seed, int repeats) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto offset = [&] {
    const auto fraction = [&] { return 0.999 * uniform(generator); };
    return fmt::format("[{:.3f}, {:.3f}, {:.3f}]", fraction(), fraction(), fraction());
  };
  std::vector<Case> cases;
  const auto add = [&](const std::string& family, const std::string& file, const char* lower, const char* upper,
                       double across, std::vector<std::string> settings) {
    // 3 to 12 cells of the coarser body, which is either.
    const double finer = std::exp(1.4 * uniform(generator) - 0.7), of_lower = finer > 1 ? across : across / finer;
    const double soft = std::exp(4.6 * uniform(generator) - 2.3);
    settings.push_back(fmt::format("across={:.4f}", of_lower));
    settings.push_back(fmt::format("finer={:.3f}", finer));
    settings.push_back(fmt::format("soft={:.3f}", soft));
    settings.push_back(fmt::format("nu1={:.2f}", 0.1 + 0.3 * uniform(generator)));
    settings.push_back(fmt::format("nu2={:.2f}", 0.1 + 0.3 * uniform(generator)));
    settings.push_back(fmt::format("body.{}.grid.offset={}", lower, offset()));
    settings.push_back(fmt::format("body.{}.grid.offset={}", upper, offset()));
    cases.push_back({family, file, across, settings});
  };
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (const double across : {3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0}) {
      add("line", "line", "block", "roller", across,
          {fmt::format("body.block.grid.rotation={{axis=[0, 1, 0], angle={:.1f}}}", 45 * uniform(generator))});
      add("line, half", "line_half", "block", "roller", across, {});
    }
    for (const double across : {5.0, 7.0, 9.0})
      add("line, wide", "line_half", "block", "roller", across,
          {"t=5*h", fmt::format("body.block.grid.rotation={{axis=[0, 0, 1], angle={:.1f}}}", 45 * uniform(generator))});
    for (const double across : {3.0, 3.5, 4.0, 5.0, 6.0})
      add("ball", "ball", "block", "cap", across,
          {fmt::format("body.cap.grid.rotation={{axis=[1, 2, 3], angle={:.1f}}}", 45 * uniform(generator))});
    for (const double ratio : {1.0, 2.0, 5.0})
      for (const double across : {3.0, 4.0, 5.0, 6.0, 8.0, 11.0}) {
        if (ratio > 4 && across > 6) continue;
        const Ellipse e = hertz_ellipse(ratio);
        add(ratio == 1 ? "round" : fmt::format("ellipse {:.1f}", e.along_y / e.along_x), "cylinders", "lower", "upper",
            across,
            {fmt::format("R1={}", ratio), fmt::format("ka={:.6f}", e.along_x), fmt::format("kb={:.6f}", e.along_y),
             fmt::format("kd={:.6f}", e.approach)});
      }
  }
  return cases;
}

/// Distances of the exact edge from those found, cells of the coarser body, positive where they lie outside of it.
/// Of a slab (plane strain) in its middle.
std::vector<double> places(const Simulation& simulation, const FoundEdges& edges, bool slab) {
  const SolvedState& state = simulation.state;
  const Reference known(state.scene, state.reference);
  double cell = 0, reach = 0;
  for (const BodySpec& body : state.scene.bodies) cell = std::max(cell, body.cell_size);
  for (const ContactPoint& p : state.pairs[0].points) reach = std::max(reach, p.x.norm());
  double y = 0;
  for (const ContactPoint& p : state.pairs[0].points) y = std::max(y, p.x[1]);
  std::vector<double> found;
  const int turns = slab ? 2 : 16;
  for (int turn = 0; turn < turns; ++turn) {
    const double angle = 2 * M_PI * (turn + (slab ? 0 : 0.5)) / turns;
    const Vec3 ray(std::cos(angle), slab ? 0 : std::sin(angle), 0), start(0, slab ? y / 2 : 0, 0);
    double inside = 0, outside = reach;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (inside + outside);
      (known.pressure(start + middle * ray) > 0 ? inside : outside) = middle;
    }
    const Vec3 x = start + inside * ray;
    const bool on_face = std::any_of(state.pairs[0].points.begin(), state.pairs[0].points.end(),
                                     [&](const ContactPoint& p) { return (p.x - x).norm() < cell; });
    EdgePiece piece;
    if (on_face && edges.near(0, x, piece)) found.push_back(piece.inside(x) / cell);
  }
  return found;
}

struct Outcome {
  double spr, sprc, estimate;  ///< relative L2 error of the pressure over both faces; the estimate of it
  std::vector<double> places;
};

FoundEdges edges_of(const Simulation& simulation) {
  const SolvedState& state = simulation.state;
  const std::vector<PatchSet> patches = make_patches(state.system.meshes, state.scene.recovery.patch_volume);
  std::vector<RecoveryBody> bodies;
  for (std::size_t b = 0; b < state.bodies.size(); ++b)
    bodies.push_back({&state.system.meshes[b], &patches[b], &state.bodies[b].boundary, state.sprc[b]});
  return find_contact_edges(bodies, state.scales, state.scene.recovery);
}

Outcome outcome_of(const Simulation& simulation, bool slab) {
  const ZoneError whole = simulation.results.pressure_errors.at(0);
  return {whole.spr, whole.sprc, simulation.results.pairs.at(0).pressure_error_estimate,
          places(simulation, edges_of(simulation), slab)};
}

Scene scene_of(const Case& c) {
  return read_scene(fmt::format("{}/perf/edge_scenes/{}.toml", CGCONTACT_SOURCE_DIR, c.file), c.settings);
}

struct Sum {
  int runs = 0;
  double log_spr = 0, log_sprc = 0, worst = 0, log_ratio = 0, least_ratio = 1e300, most_ratio = 0;
  std::vector<double> places;
  void add(const Outcome& o) {
    ++runs;
    log_spr += std::log(o.spr);
    log_sprc += std::log(o.sprc);
    worst = std::max(worst, o.sprc);
    const double ratio = o.estimate / o.sprc;
    log_ratio += std::log(ratio);
    least_ratio = std::min(least_ratio, ratio);
    most_ratio = std::max(most_ratio, ratio);
    places.insert(places.end(), o.places.begin(), o.places.end());
  }
  std::string print() const {
    double mean = 0, square = 0;
    for (const double p : places) mean += p / static_cast<double>(places.size());
    for (const double p : places) square += std::pow(p - mean, 2) / static_cast<double>(places.size());
    return fmt::format("{:3} | {:6.2f} | {:6.2f} ({:.2f}) | {:+.3f} +- {:.3f} ({}) | {:.2f}, {:.2f}, {:.2f}", runs,
                       100 * std::exp(log_spr / runs), 100 * std::exp(log_sprc / runs), 100 * worst, mean,
                       std::sqrt(square), places.size(), least_ratio, std::exp(log_ratio / runs), most_ratio);
  }
};

/// Of a wave exp(i k x) along the face of a half-space (plane strain) of square trilinear cells of side 1, its face at
/// `filled` of their height: what the means over the cells are short of the half-space's displacements if the pressure
/// is constant over the cells. In parts of k^2, for small k.
double stiffening(double nu, double filled) {
  using Complex = std::complex<double>;
  using Mat2c = Eigen::Matrix2cd;
  constexpr double k = 0.1;
  const double lambda = nu / ((1 + nu) * (1 - 2 * nu)), mu = 0.5 / (1 + nu);
  Mat3 law = Vec3(lambda + 2 * mu, lambda + 2 * mu, mu).asDiagonal();
  law(0, 1) = law(1, 0) = lambda;
  // Stiffness of the wave's amplitudes: upper x, y, lower x, y.
  const auto layer = [&](double height) {
    Eigen::Matrix4cd sum = Eigen::Matrix4cd::Zero();
    const GaussRule& rule = gauss_rule(2);
    for (std::size_t q = 0; q < 4; ++q) {
      const double x = rule.node[q % 2], y = height * rule.node[q / 2];
      Eigen::Matrix<Complex, 3, 4> strain = Eigen::Matrix<Complex, 3, 4>::Zero();
      for (int a = 0; a < 4; ++a) {
        const bool right = a % 2 == 1, upper = a / 2 == 1;
        const Complex phase = right ? std::exp(Complex(0, k)) : Complex(1);
        const Complex dx = phase * (right ? 1. : -1.) * (upper ? y : 1 - y),
                      dy = phase * (right ? x : 1 - x) * (upper ? 1. : -1.);
        const int column = upper ? 0 : 2;
        strain(0, column) += dx;
        strain(1, column + 1) += dy;
        strain(2, column) += dy;
        strain(2, column + 1) += dx;
      }
      sum += rule.weight[q % 2] * rule.weight[q / 2] * height * strain.adjoint() * law * strain;
    }
    return sum;
  };
  const Eigen::Matrix4cd full = layer(1);
  const auto above = [](const Eigen::Matrix4cd& m, const Mat2c& below) -> Mat2c {
    return m.topLeftCorner<2, 2>() -
           m.topRightCorner<2, 2>() * (m.bottomRightCorner<2, 2>() + below).inverse() * m.bottomLeftCorner<2, 2>();
  };
  Mat2c below = Mat2c::Identity();
  for (int i = 0; i < 60 / k; ++i) below = above(full, below);
  Eigen::Matrix4cd top = layer(filled);
  top.bottomRightCorner<2, 2>() += below;
  const Eigen::Vector4cd on_face(0, filled, 0, 1 - filled);  // also the nodes' shares of a force there
  const double compliance = (on_face.adjoint() * top.inverse() * on_face)(0).real();
  const double mean = std::pow(std::cos(k / 2), 2);  // over a cell, of forces and of displacements
  return (1 - mean * compliance * k / (2 * (1 - nu * nu))) / (k * k);
}

/// Where the sums of forces put an edge at 0 if the forces are those of p - excess p'', p = sqrt(s (1 - s / width)).
double shift_by(double excess, double inverse_width, const EdgeOptions& options) {
  const auto integral = [](double from, double to, const auto& f) {
    constexpr int steps = 4000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) sum += f(from + (i + 0.5) * (to - from) / steps) * (to - from) / steps;
    return sum;
  };
  const auto share = [&](double shift, double of_excess) {
    double sums[2];
    for (int k = 0; k < 2; ++k) {
      const double end = k == 0 ? options.nearer_end : options.farther_end, length = end - options.plateau;
      sums[k] = integral(-shift, end, [&](double s) {
        const double x = (s - options.plateau) / length;
        return edge_root(s + shift, inverse_width) * smooth_fall(x);
      });
      sums[k] += of_excess * integral(options.plateau, end, [&](double s) {  // p' w', by parts
                   const double x = (s - options.plateau) / length;
                   return (1 - 2 * inverse_width * s) / (2 * edge_root(s, inverse_width)) * 6 * x * (x - 1) / length;
                 });
    }
    return sums[0] / sums[1];
  };
  const double measured = share(0, excess);
  double low = -0.5, high = 0.5;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (share(middle, 0) < measured ? low : high) = middle;
  }
  return low;
}

void print_half_space() {
  fmt::print(
      "| nu | p'' in the forces: faces at 0.05, 0.5, 1 of a cell | edge, cells: wide zone, of 8 cells |\n"
      "|---|---|---|\n");
  for (const double nu : {0.1, 0.2, 0.3, 0.4}) {
    std::string parts;
    double mean = 0;
    for (const double filled : {0.05, 0.5, 1.0}) {
      const double excess = stiffening(nu, filled) - 1. / 12;  // twice the mean over a cell: of gap and weight
      parts += fmt::format(" {:.3f}", excess);
      mean += excess / 3;
    }
    fmt::print("| {} |{} | {:.3f}, {:.3f} |\n", nu, parts, shift_by(mean, 0, {}), shift_by(mean, 1. / 8, {}));
  }
}

}  // namespace

int main(int argc, char** argv) {
  int seed = 1, repeats = 2;
  std::string only;
  bool toy = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--half-space") {
      print_half_space();
      return 0;
    }
    if (word == "--toy")
      toy = true;
    else if (i + 1 < argc && word == "--seed")
      seed = std::stoi(argv[++i]);
    else if (i + 1 < argc && word == "--repeats")
      repeats = std::stoi(argv[++i]);
    else if (i + 1 < argc && word == "--only")
      only = argv[++i];
    else {
      fmt::print(stderr, "usage: {} [--seed 1] [--repeats 2] [--only FAMILY] [--toy] | --half-space\n", argv[0]);
      return 1;
    }
  }
  try {
    const TrilinosScope trilinos(0);
    std::map<std::string, std::map<double, Sum>> sums;
    for (const Case& c : make_cases(seed, toy ? 1 : repeats)) {
      if ((!only.empty() && c.family != only) || (toy && (c.across != 4 || c.file == "cylinders"))) continue;
      const Scene scene = scene_of(c);
      Simulation simulation(scene);
      simulation.run({});
      sums[c.family][c.across].add(outcome_of(simulation, c.family.rfind("line", 0) == 0));
    }
    fmt::print(
        "| contact | cells across | runs | SPR, % | SPR-C, mean (worst), % | edge outside of the exact one, cells "
        "(places) | estimate / error: least, mean, most |\n|---|---|---|---|---|---|---|\n");
    for (const auto& [family, by_across] : sums)
      for (const auto& [across, sum] : by_across) fmt::print("| {} | {} | {} |\n", family, across, sum.print());
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

#include "contact/results/verdict/small_strain.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/files/text.hpp"
#include "core/base/numbers/decompositions.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "kernels/mesh/hex.hpp"

namespace cgcontact {
namespace {

struct Largest {
  double value = 0;
  Vec3 x = Vec3::Zero();
  void add(double other, const Vec3& position) {
    if (other <= value) return;
    value = other;
    x = position;
  }
};

struct StrainExtremes {
  Largest strain, displacement;
};

/// At the centroid of every cell; of several ranks each computes some of them.
StrainExtremes find_extremes(const CutCells& cc, const BodyMesh& mesh, const RealView& u, const BodyMotion& body_motion,
                             double length_scale) {
  const std::size_t cells = cc.cells.size();
  std::vector<StrainExtremes> found(num_chunks(cells, grain_of_light));
  const auto [first, last] = share_out(found.size());
  parallel_chunks(
      "cgcontact::small_strain::largest_strain", cells, grain_of_light,
      [&, first = first, last = last](std::size_t chunk, std::size_t begin, std::size_t end) {
        if (chunk < first || chunk >= last) return;
        for (std::size_t e = begin; e < end; ++e) {
          const Vec3 xi = centroid(cc, static_cast<int>(e));
          const Vec3 x = global_position(cc, static_cast<int>(e), xi);
          double corner[8][3], g[3][3];
          corner_values(mesh.cell_nodes[e], u, corner);
          for (auto& v : corner)
            for (double& component : v) component *= length_scale;
          const Vec3 displacement = interpolate(corner, xi, cc.grid.rotation.transpose() * body_motion.at(x));
          interpolate_gradient(corner, xi.data(), g);
          add_ring_strain(mesh.ring_of(static_cast<int>(e)), corner, xi.data(), g);
          const Mat3 gradient =  // m per m, grid axes
              Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&g[0][0]) / cc.h(static_cast<int>(e)) +
              cc.grid.rotation.transpose() * body_motion.expansion * cc.grid.rotation;
          const Mat3 strain = 0.5 * (gradient + gradient.transpose());
          // The Frobenius norm bounds the principal strains; it is found without them.
          if (strain.norm() > found[chunk].strain.value)
            found[chunk].strain.add(eigenvalues(strain).cwiseAbs().maxCoeff(), x);
          found[chunk].displacement.add(displacement.norm(), x);
        }
      });
  put_together(found.data(), found.size(), sizeof(StrainExtremes));
  StrainExtremes all;
  for (const StrainExtremes& of_chunk : found) {
    all.strain.add(of_chunk.strain.value, of_chunk.strain.x);
    all.displacement.add(of_chunk.displacement.value, of_chunk.displacement.x);
  }
  return all;
}

StrainExtremes extremes_of(const SolvedState& state, std::size_t b) {
  return find_extremes(state.bodies[b].cut_cells, state.system.meshes[b], state.outer.u, state.outer.body_motions[b],
                       state.scales.length);
}

/// Longest side of its bounding box, m.
double size_of(const BodySpec& spec) {
  Vec3 low, high;
  spec.solid.bounding_box(low, high);
  return (high - low).maxCoeff();
}

}  // namespace

std::vector<std::string> small_strain_warnings(const SolvedState& state, const std::vector<ContactRow>& rows) {
  std::vector<std::string> warnings;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const BodySpec& spec = *state.bodies[b].spec;
    const StrainExtremes extremes = extremes_of(state, b);
    Largest pressure;
    for (const ContactRow& row : rows)
      if (row.body == static_cast<int>(b)) pressure.add(row.pressure_sprc, row.x);
    const double size = size_of(spec), modulus = spec.material.youngs_modulus;
    const ResultOptions& limits = state.scene.results;
    std::string text;
    const auto add = [&](bool too_large, const std::string& phrase) {
      if (too_large) text += (text.empty() ? "" : ", ") + phrase;
    };
    add(extremes.strain.value > limits.largest_strain,
        fmt::format("strain {:.2g} % {}", 100 * extremes.strain.value, at_position(extremes.strain.x)));
    add(extremes.displacement.value > limits.largest_displacement * size,
        fmt::format("displacement {:.3g} m, {:.2g} % of the body, {}", extremes.displacement.value,
                    100 * extremes.displacement.value / size, at_position(extremes.displacement.x)));
    add(pressure.value > limits.largest_pressure * modulus,
        fmt::format("contact pressure {:.3g} Pa, {:.2g} % of E, {}", pressure.value, 100 * pressure.value / modulus,
                    at_position(pressure.x)));
    if (!text.empty())
      warnings.push_back(
          fmt::format("body \"{}\": too much for small strain and small sliding, the result is at best "
                      "rough: {} (wrong unit of a load, of E or of a length?)",
                      spec.name, text));
  }
  return warnings;
}

std::string beyond_all_grids(const SolvedState& state) {
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const BodySpec& spec = *state.bodies[b].spec;
    const StrainExtremes extremes = extremes_of(state, b);
    const double way = extremes.displacement.value / size_of(spec);
    if (extremes.strain.value > 1 && way > 1)
      return fmt::format(
          "body \"{}\": strain {:.2g} %, displacement {:.2g} % of its size, which finer cells do not change "
          "(E = {:.2g} Pa, is a unit wrong?)",
          spec.name, 100 * extremes.strain.value, 100 * way, spec.material.youngs_modulus);
  }
  return "";
}

}  // namespace cgcontact

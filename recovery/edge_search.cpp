#include "recovery/edge_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/parallel.hpp"
#include "recovery/constrained_fit.hpp"
#include "recovery/edge_moments.hpp"

namespace cgcontact {
namespace {

constexpr std::size_t grain = 4;
constexpr int num_unknowns = 6 * num_terms;
using Unknowns = Eigen::Matrix<double, 2 * num_unknowns, 1>;

/// First guess of the edge in a patch: the line that parts closed from open contact points best (least squares of
/// +1 and -1) among those within two cells.
struct Guess {
  Vec3 origin, closed, normal, opposite;  ///< global axes, m
  bool clear = false;
};

Guess part_points(const PatchAssembly& assembly, int node, int pair, const RecoveryBody& other) {
  const RecoveryBody& body = assembly.body();
  const Grid& grid = assembly.grid();
  const CutCells& cc = *body.mesh->cut_cells;
  const Index3& at = body.mesh->nodes[node];
  Guess guess;
  constexpr int reach = 2;
  const auto each_link = [&](const auto& use) {
    for (int k = -reach; k < reach; ++k)
      for (int j = -reach; j < reach; ++j)
        for (int i = -reach; i < reach; ++i) {
          const int cell = cc.find({at[0] + i, at[1] + j, at[2] + k});
          if (cell < 0) continue;
          for (int l : body.boundary->links_of_cell[cell])
            if (body.boundary->links[l].pair == pair) use(body.boundary->links[l]);
        }
  };
  double area = 0;
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero(), opposite = Vec3::Zero();
  each_link([&](const ContactLink& link) {
    area += link.weight;
    centroid += link.weight * link.position;
    normal += link.weight * link.normal;
    opposite += link.weight * link.other_position;
  });
  centroid /= area;
  opposite /= area;
  normal.normalize();
  const auto [t1, t2] = tangents(normal);
  // Plane fit of the state in the tangent plane.
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  each_link([&](const ContactLink& link) {
    const Vec3 d = link.position - centroid;
    const Vec3 p(1, t1.dot(d), t2.dot(d));
    A += link.weight / area * p * p.transpose();
    b += link.weight / area * (link.active ? 1 : -1) * p;
  });
  A.diagonal().tail<2>().array() += 1e-6;
  const Vec3 c = A.ldlt().solve(b);
  const Vec3 slope = c[1] * t1 + c[2] * t2;
  const double steep = slope.norm();
  if (!(steep > 0.05)) return guess;
  const Vec3 closed = slope / steep;
  const Vec3 origin = centroid - c[0] / steep * closed;
  double wrong = 0;
  each_link([&](const ContactLink& link) {
    if (link.active != (closed.dot(link.position - origin) > 0)) wrong += link.weight / area;
  });
  guess.clear = wrong < 0.2;
  guess.origin = grid.to_global(origin);
  guess.closed = grid.rotation * closed;
  guess.normal = grid.rotation * normal;
  guess.opposite = other.mesh->cut_cells->grid.to_global(opposite);
  return guess;
}

/// The fit of polynomials and term in one patch and its auxiliary patch, as a function of the place of the edge.
class PatchMisfit {
 public:
  PatchMisfit(const RecoveryBody* const bodies[2], const PatchProblem& problem, const std::vector<FitRow>& rows,
              const std::vector<int> cells[2], const RealView& u, double rank_tolerance)
      : problem_(problem), u_(u) {
    for (int b = 0; b < 2; ++b) {
      bodies_[b] = bodies[b];
      cells_[b] = &cells[b];
      factor_[b].compute(problem.fit[b].mass);
    }
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6 + problem.num_rows, 2 * num_unknowns);
    C.block<3, num_unknowns>(0, 0) = divergence_rows();
    C.block<3, num_unknowns>(3, num_unknowns) = divergence_rows();
    for (int r = 0; r < problem.num_rows; ++r) {
      const FitRow& row = rows[problem.first_row + r];
      for (int b = 0; b < 2; ++b) {
        const double p[num_terms] = {1, row.place[b][0], row.place[b][1], row.place[b][2]};
        for (int k = 0; k < 6; ++k)
          for (int t = 0; t < num_terms; ++t) C(6 + r, num_unknowns * b + num_terms * k + t) = row.weight[b][k] * p[t];
      }
    }
    for (int b = 0; b < 2; ++b)
      for (int k = 0; k < 6; ++k) {
        auto columns = C.middleCols<num_terms>(num_unknowns * b + num_terms * k);
        columns = factor_[b].matrixL().solve(columns.transpose()).transpose().eval();
      }
    for (Eigen::Index r = 0; r < C.rows(); ++r)
      if (C.row(r).norm() > 0) C.row(r).normalize();
    // Orthonormal basis of the rows that count.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(C * C.transpose());
    const double threshold = rank_tolerance * rank_tolerance * eigen.eigenvalues().maxCoeff();
    Eigen::Index first = 0;
    while (first < C.rows() && !(eigen.eigenvalues()[first] > threshold)) ++first;
    const Eigen::Index rank = C.rows() - first;
    basis_ = C.transpose() * eigen.eigenvectors().rightCols(rank) *
             eigen.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
    for (int b = 0; b < 2; ++b)
      for (int k = 0; k < 6; ++k)
        free_.segment<num_terms>(num_unknowns * b + num_terms * k) =
            factor_[b].matrixL().transpose() * problem.fit[b].a.segment<num_terms>(num_terms * k);
    free_ -= basis_ * (basis_.transpose() * free_);
  }

  /// How much the term reduces the square of the misfit (less is better: it is negative), its factor and the square of
  /// the part of the term that polynomials do not carry.
  double operator()(const ContactEdge edge[2], double& factor, double& weight) const {
    Unknowns h;
    double square = 0, with_stress = 0;
    for (int b = 0; b < 2; ++b) {
      const EdgeMoments moments = edge_moments(*bodies_[b]->mesh, cells_[b]->data(), static_cast<int>(cells_[b]->size()),
                                               edge[b], problem_.fit[b].centre, u_);
      square += moments.square;
      with_stress += moments.with_stress;
      for (int k = 0; k < 6; ++k)
        h.segment<num_terms>(num_unknowns * b + num_terms * k) =
            factor_[b].matrixL().solve(moments.with_polynomials.segment<num_terms>(num_terms * k));
    }
    const Eigen::VectorXd in_rows = basis_.transpose() * h;
    weight = square - h.squaredNorm() + in_rows.squaredNorm();
    const double product = with_stress - free_.dot(h);
    factor = product / weight;
    return -product * factor;
  }

 private:
  const PatchProblem& problem_;
  const RealView& u_;
  const RecoveryBody* bodies_[2];
  const std::vector<int>* cells_[2];
  Eigen::LLT<Eigen::Matrix<double, num_terms, num_terms>> factor_[2];
  Eigen::MatrixXd basis_;
  Unknowns free_;  ///< polynomials of sigma_h that the rows leave
};

/// Places tried, own cells from the first guess.
constexpr int num_trials = 11;
constexpr double trial_step = 0.2;

}  // namespace

bool FoundEdges::near(int pair, const Vec3& x, EdgePiece& piece) const {
  double sum = 0, factor_sum = 0;
  piece = {Vec3::Zero(), Vec3::Zero(), 0};
  double nearest = 1e300;
  for (const EdgeSample& s : samples_)
    if (s.pair == pair) nearest = std::min(nearest, (s.origin - x).norm());
  if (nearest > 4 * width_) return false;
  for (const EdgeSample& s : samples_) {
    if (s.pair != pair) continue;
    const double distance = std::max((s.origin - x).norm() - nearest, 0.0) / width_;
    if (distance > 4) continue;
    const double kernel = std::exp(-0.5 * distance * distance);
    piece.origin += kernel * s.place_weight * s.origin;
    piece.closed += kernel * s.place_weight * s.closed;
    piece.factor += kernel * s.factor_weight * s.factor;
    sum += kernel * s.place_weight;
    factor_sum += kernel * s.factor_weight;
  }
  piece.origin /= sum;
  piece.closed.normalize();
  piece.factor /= factor_sum;
  return true;
}

FoundEdges find_contact_edges(const std::vector<PatchAssembly>& assemblies, const std::vector<RecoveryBody>& bodies,
                              const RealView& u, const RecoveryOptions& options) {
  std::vector<EdgeSample> samples;
  double width = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const PatchAssembly& assembly = assemblies[b];
    const double h = assembly.grid().cell_size;
    width = std::max(width, h);
    const int num_nodes = bodies[b].mesh->num_nodes;
    std::vector<std::pair<int, int>> mixed;  // node, pair
    PatchWorkspace workspace;
    for (int n = 0; n < num_nodes && options.contact_edge; ++n) {
      assembly.pair_states(n, workspace.states);
      for (const PairState& state : workspace.states)
        if (state.is_mixed()) mixed.emplace_back(n, state.pair);
    }
    std::vector<EdgeSample> found(mixed.size());
    parallel_for(mixed.size(), grain, [&](std::size_t i) {
      found[i].pair = -1;
      PatchWorkspace work;
      std::vector<FitRow> rows;
      const PatchProblem problem = assembly.assemble_at_edge(mixed[i].first, mixed[i].second, work, rows);
      if (!problem.coupled) return;
      const RecoveryBody& other = bodies[problem.other_body];
      const Guess guess = part_points(assembly, mixed[i].first, problem.pair, other);
      if (!guess.clear) return;
      const RecoveryBody* both[2] = {&bodies[b], &other};
      const PatchSet& patches = *bodies[b].patches;
      const std::vector<int> cells[2] = {
          {patches.cells.begin() + patches.begin[problem.node], patches.cells.begin() + patches.begin[problem.node + 1]},
          work.auxiliary};
      const PatchMisfit misfit(both, problem, rows, cells, u, options.rank_tolerance);
      const auto at = [&](double shift, double& factor, double& weight) {
        EdgePiece piece{guess.origin + shift * h * guess.closed, guess.closed, 0};
        const ContactEdge edge[2] = {assembly.seen_from(bodies[b], guess.origin, guess.normal, piece, h),
                                     assembly.seen_from(other, guess.opposite, -guess.normal, piece, h)};
        return misfit(edge, factor, weight);
      };
      double value[num_trials], factor, weight;
      int best = 0;
      for (int t = 0; t < num_trials; ++t) {
        value[t] = at(trial_step * (t - num_trials / 2), factor, weight);
        if (value[t] < value[best]) best = t;
      }
      if (best == 0 || best == num_trials - 1) return;
      const double curvature = value[best - 1] - 2 * value[best] + value[best + 1];
      double shift = trial_step * (best - num_trials / 2);
      if (curvature > 0) shift += 0.5 * trial_step * (value[best - 1] - value[best + 1]) / curvature;
      const double least = at(shift, factor, weight);
      if (std::getenv("EDGE_PRINT")) {
        const Vec3 o = guess.origin + shift * h * guess.closed;
        std::printf("edge body %zu node %d guess %.4e %.4e closed %.3f %.3f %.3f shift %.3f -> %.5e %.5e K %.4e w %.3e curv %.3e J %.3e\n", b, mixed[i].first, guess.origin[0], guess.origin[1], guess.closed[0], guess.closed[1], guess.closed[2], shift, o[0], o[1], factor/std::sqrt(h), weight, curvature, least);
      }
      if (!(factor < 0)) return;
      found[i] = {problem.pair, guess.origin + shift * h * guess.closed, guess.closed, factor / std::sqrt(h), curvature,
                  weight};
    });
    for (const EdgeSample& sample : found)
      if (sample.pair >= 0) samples.push_back(sample);
  }
  return FoundEdges(std::move(samples), width);
}

}  // namespace cgcontact

#include "recovery/edge_search.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/parallel.hpp"
#include "recovery/edge_misfit.hpp"

namespace cgcontact {
namespace {

/// Patches per chunk of the parallel loops.
constexpr std::size_t grain = 4;

/// Places tried across the edge, own cells: widely from the first guess, then closely about the parabola through what
/// the neighbours found (its direction and curvature are better than the guess's).
constexpr double wide_step = 0.2, close_step = 0.2;
constexpr int wide_trials = 11, close_trials = 5;

/// Samples count with exp(-(distance / (smoothing width))^2 / 2), and not at all beyond reach widths.
constexpr double smoothing = 1.5, reach = 4 * smoothing;
/// Pull of slope and curvature of the parabola to zero, relative to the sum of the weights: samples of a thin body lie
/// on one line.
constexpr double ridge = 0.1;

/// First guess of the edge in a patch: the line that parts closed from open contact points best.
struct Guess {
  EdgePiece piece;
  Vec3 point, opposite;  ///< on the faces of both bodies, m, global axes
  Vec3 normal;           ///< outward
  bool clear = false;    ///< a line parts the points at all
};

/// Least squares of +1 (closed) and -1 by a linear function on the face, over the contact points within two cells.
Guess part_points(const PatchAssembly& assembly, int node, int pair, const Grid& other) {
  const RecoveryBody& body = assembly.body();
  const CutCells& cc = *body.mesh->cut_cells;
  const Grid& grid = cc.grid;
  const Index3& at = body.mesh->nodes[node];
  constexpr int cells = 2;
  const auto each_link = [&](const auto& use) {
    for (int k = -cells; k < cells; ++k)
      for (int j = -cells; j < cells; ++j)
        for (int i = -cells; i < cells; ++i) {
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
  normal.normalize();
  const auto [t1, t2] = tangents(normal);
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  const auto tangential = [&, &e1 = t1, &e2 = t2](const ContactLink& link) {
    return Vec3(1, e1.dot(link.position - centroid), e2.dot(link.position - centroid));
  };
  each_link([&](const ContactLink& link) {
    const Vec3 p = tangential(link);
    A += link.weight / area * p * p.transpose();
    b += link.weight / area * (link.active ? 1 : -1) * p;
  });
  A.diagonal().tail<2>().array() += 1e-6;  // points on one line
  const Vec3 c = A.ldlt().solve(b);
  const double steep = c.tail<2>().norm();
  Guess guess;
  if (!(steep > 0.05)) return guess;
  const Vec3 closed = (c[1] * t1 + c[2] * t2) / steep;
  double wrong = 0;
  each_link([&](const ContactLink& link) {
    if (link.active != (c.dot(tangential(link)) > 0)) wrong += link.weight / area;
  });
  guess.clear = wrong < 0.2;
  guess.piece.origin = grid.to_global(centroid - c[0] / steep * closed);
  guess.piece.closed = grid.rotation * closed;
  guess.piece.along = grid.rotation * normal.cross(closed);
  guess.point = grid.to_global(centroid);
  guess.opposite = other.to_global(opposite / area);
  guess.normal = grid.rotation * normal;
  return guess;
}

/// A patch that holds closed and open points.
struct Candidate {
  const PatchAssembly* assembly;
  int pair = -1;  ///< -1: of no use
  Guess guess;
  std::unique_ptr<EdgeMisfit> misfit;
};

Candidate make_candidate(const PatchAssembly& assembly, int node, int pair, const RealView& u, double rank_tolerance) {
  Candidate candidate{&assembly, -1, {}, nullptr};
  PatchWorkspace workspace;
  std::vector<PatchRow> rows;
  const PatchProblem problem = assembly.assemble_at_edge(node, pair, workspace, rows);
  if (!problem.coupled) return candidate;
  const RecoveryBody& other = assembly.body_of(problem.other_body);
  candidate.guess = part_points(assembly, node, pair, other.mesh->cut_cells->grid);
  if (!candidate.guess.clear) return candidate;
  const RecoveryBody& body = assembly.body();
  const int* cells = body.patches->cells.data() + body.patches->begin[node];
  const int num_cells = body.patches->begin[node + 1] - body.patches->begin[node];
  const std::vector<int>& auxiliary = workspace.auxiliary;
  candidate.misfit = std::make_unique<EdgeMisfit>(
      EdgeMisfit::Side{&body, cells, num_cells},
      EdgeMisfit::Side{&other, auxiliary.data(), static_cast<int>(auxiliary.size())}, problem, rows, u, rank_tolerance);
  candidate.pair = pair;
  return candidate;
}

/// Moves the edge of a candidate's guess across to the least misfit; false if there is none among the places tried.
bool place_edge(const Candidate& candidate, double step, int trials, EdgeSample& sample) {
  const PatchAssembly& assembly = *candidate.assembly;
  const double h = assembly.grid().cell_size;
  EdgeFit fit;
  const auto misfit_at = [&](double shift) {
    EdgePiece piece = candidate.guess.piece;
    piece.origin += shift * h * piece.closed;
    const auto seen = [&](int side) {
      return side == 0 ? assembly.seen_from(assembly.body(), candidate.guess.point, candidate.guess.normal, piece, h)
                       : assembly.seen_from(candidate.misfit->other(), candidate.guess.opposite,
                                            -candidate.guess.normal, piece, h);
    };
    fit = candidate.misfit->at(seen(0), seen(1));
    return fit.misfit;
  };
  double value[wide_trials];
  int best = 0;
  for (int t = 0; t < trials; ++t) {
    value[t] = misfit_at(step * (t - trials / 2));
    if (value[t] < value[best]) best = t;
  }
  if (best == 0 || best == trials - 1) return false;
  const double before = value[best - 1], after = value[best + 1], curvature = before - 2 * value[best] + after;
  double shift = step * (best - trials / 2);
  if (curvature > 0) shift += 0.5 * step * (before - after) / curvature;
  misfit_at(shift);
  if (!(fit.factor < 0)) return false;  // pulls instead of pressing
  const EdgePiece& piece = candidate.guess.piece;
  sample = {candidate.pair,
            piece.origin + shift * h * piece.closed,
            piece.closed,
            candidate.guess.normal,
            fit.factor / std::sqrt(h),
            piece.inverse_width,
            fit.weight};
  return true;
}

/// All candidates' samples, in order.
std::vector<EdgeSample> place_edges(const std::vector<Candidate>& candidates, double step, int trials) {
  std::vector<EdgeSample> samples(candidates.size());
  parallel_for(candidates.size(), grain, [&](std::size_t i) {
    if (candidates[i].pair < 0 || !place_edge(candidates[i], step, trials, samples[i])) samples[i].pair = -1;
  });
  samples.erase(std::remove_if(samples.begin(), samples.end(), [](const EdgeSample& s) { return s.pair < 0; }),
                samples.end());
  return samples;
}

}  // namespace

FoundEdges::FoundEdges(std::vector<EdgeSample> samples, double width) : samples_(std::move(samples)), width_(width) {
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    // The normals of both bodies' patches point the same way.
    for (std::size_t k = 0; k < i; ++k)
      if (samples_[k].pair == samples_[i].pair) {
        if (samples_[k].normal.dot(samples_[i].normal) < 0) samples_[i].normal *= -1;
        break;
      }
    buckets_[bucket(samples_[i].origin)].push_back(static_cast<int>(i));
  }
}

FoundEdges::Bucket FoundEdges::bucket(const Vec3& x) const {
  Bucket key;
  for (int d = 0; d < 3; ++d) key[d] = static_cast<long long>(std::floor(x[d] / (reach * width_)));
  return key;
}

template <class Use>
void FoundEdges::each_near(int pair, const Vec3& x, const Use& use) const {
  const Bucket centre = bucket(x);
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        const auto found = buckets_.find({centre[0] + i, centre[1] + j, centre[2] + k});
        if (found == buckets_.end()) continue;
        for (int s : found->second)
          if (samples_[s].pair == pair) use(samples_[s]);
      }
}

bool FoundEdges::near(int pair, const Vec3& x, EdgePiece& piece) const {
  if (samples_.empty()) return false;
  const EdgeSample* first = nullptr;
  double nearest = reach * width_;
  each_near(pair, x, [&](const EdgeSample& s) {
    const double distance = (s.origin - x).norm();
    if (distance < nearest) first = &s, nearest = distance;
  });
  if (!first) return false;
  Vec3 foot = first->origin;
  const auto each_weighted = [&](const auto& use) {
    each_near(pair, foot, [&](const EdgeSample& s) {
      const double distance = (s.origin - foot).norm() / width_;
      if (distance < reach) use(s, std::exp(-0.5 * distance * distance / (smoothing * smoothing)));
    });
  };
  // Mean directions about the nearest sample; the foot of x on the edge.
  Vec3 closed = Vec3::Zero(), normal = Vec3::Zero();
  each_weighted([&](const EdgeSample& s, double w) {
    closed += w * s.closed;
    normal += w * s.normal;
  });
  normal.normalize();
  closed = (closed - closed.dot(normal) * normal).normalized();
  const Vec3 along = normal.cross(closed);
  foot += along.dot(x - foot) * along;
  // A parabola across over along.
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  double sum = 0, height = 0, factor = 0, factor_weight = 0, inverse_width = 0;
  each_weighted([&](const EdgeSample& s, double w) {
    const Vec3 d = (s.origin - foot) / width_;
    const double t = along.dot(d);
    const Vec3 p(1, t, 0.5 * t * t);
    A += w * p * p.transpose();
    b += w * closed.dot(d) * p;
    sum += w;
    height += w * normal.dot(d);
    inverse_width += w * s.inverse_width;
    factor += w * s.weight * s.factor;
    factor_weight += w * s.weight;
  });
  if (!(factor_weight > 0)) return false;
  A(1, 1) += ridge * sum;
  A(2, 2) += ridge * sum;
  const Vec3 c = A.ldlt().solve(b);
  piece.origin = foot + width_ * (c[0] * closed + height / sum * normal);
  piece.closed = (closed - c[1] * along).normalized();
  piece.along = normal.cross(piece.closed);
  piece.curvature = -c[2] / width_;
  piece.inverse_width = inverse_width / sum;
  piece.factor = factor / factor_weight;
  return true;
}

/// Across the zone from some samples to its other side, over the contact points within a band: to the opposite edge
/// where open points follow, else to a plane of symmetry (or an edge of the body) that the zone is taken to go on
/// behind. The other samples take the value of the nearest of these.
void FoundEdges::measure_widths(const std::vector<PatchAssembly>& assemblies) {
  constexpr std::size_t measured = 64;
  const std::size_t stride = samples_.size() / measured + 1;
  parallel_for((samples_.size() + stride - 1) / stride, 1, [&](std::size_t i) {
    EdgeSample& sample = samples_[i * stride];
    double closed = 0, open = 0;
    for (const PatchAssembly& assembly : assemblies)
      for (const ContactLink& link : assembly.body().boundary->links) {
        if (link.pair != sample.pair) continue;
        const Vec3 d = assembly.grid().to_global(link.position) - sample.origin;
        const double across = sample.closed.dot(d);
        if ((d - across * sample.closed).squaredNorm() > width_ * width_) continue;
        double& farthest = link.active ? closed : open;
        farthest = std::max(farthest, across);
      }
    sample.inverse_width = closed > width_ ? 1 / (open > closed ? closed : 2 * closed) : 0;
  });
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (i % stride == 0) continue;
    double nearest = 1e300;
    for (std::size_t k = 0; k < samples_.size(); k += stride) {
      const double distance = (samples_[k].origin - samples_[i].origin).squaredNorm();
      if (samples_[k].pair != samples_[i].pair || distance >= nearest) continue;
      nearest = distance;
      samples_[i].inverse_width = samples_[k].inverse_width;
    }
  }
}

FoundEdges find_contact_edges(const std::vector<PatchAssembly>& assemblies, const RealView& u,
                              const RecoveryOptions& options) {
  if (!options.contact_edge) return FoundEdges({}, 1);
  std::vector<Candidate> candidates;
  double width = 0;
  for (const PatchAssembly& assembly : assemblies) {
    width = std::max(width, assembly.grid().cell_size);
    std::vector<std::pair<int, int>> mixed;  // node, pair
    std::vector<PairState> states;
    for (int n = 0; n < assembly.body().mesh->num_nodes; ++n) {
      assembly.pair_states(n, states);
      for (const PairState& state : states)
        if (state.is_mixed()) mixed.emplace_back(n, state.pair);
    }
    const std::size_t first = candidates.size();
    candidates.resize(first + mixed.size());
    parallel_for(mixed.size(), grain, [&](std::size_t i) {
      candidates[first + i] = make_candidate(assembly, mixed[i].first, mixed[i].second, u, options.rank_tolerance);
    });
  }
  FoundEdges rough(place_edges(candidates, wide_step, wide_trials), width);
  rough.measure_widths(assemblies);
  for (Candidate& candidate : candidates) {
    if (candidate.pair < 0) continue;
    Guess& guess = candidate.guess;
    EdgePiece piece;
    if (!rough.near(candidate.pair, guess.piece.origin, piece)) {
      candidate.pair = -1;
      continue;
    }
    guess.piece = piece;
    guess.piece.closed = (piece.closed - piece.closed.dot(guess.normal) * guess.normal).normalized();
    guess.piece.along = guess.normal.cross(guess.piece.closed);
  }
  return FoundEdges(place_edges(candidates, close_step, close_trials), width);
}

}  // namespace cgcontact

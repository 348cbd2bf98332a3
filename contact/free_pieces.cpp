#include "contact/free_pieces.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "contact/free_motion.hpp"

namespace cgcontact {
namespace {

/// Of the largest eigenvalue (stiffness of the best held motion): what is less is not held.
constexpr double not_held = 1e-9;
/// Part of a motion that is rounding.
constexpr double negligible = 1e-3;
/// Mean squared resistance of a face to a motion (of 1 at its fastest) that makes it worth naming.
constexpr double worth_holding = 0.02;
constexpr std::size_t most_pieces = 1000;

/// Rigid motion: translation and rotation about the centre, u = t + r x (x - c) / size.
using Motion = Eigen::Matrix<double, 6, 1>;

/// A connected piece of a body.
struct Piece {
  int body = 0;
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  Vec3 centre() const { return 0.5 * (low + high); }
  double size() const { return (high - low).maxCoeff(); }
  /// Row q with q . motion = u(x) . d.
  Motion row(const Vec3& x, const Vec3& d) const {
    Motion q;
    q << d, ((x - centre()) / size()).cross(d);
    return q;
  }
};

/// All pieces of all bodies, and which one a cell belongs to.
struct Pieces {
  std::vector<Piece> list;
  std::vector<std::vector<int>> of_cell;  ///< body, active cell -> index into list

  explicit Pieces(const std::vector<BodyModel>& bodies) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const CutCells& cc = bodies[b].cut_cells;
      int count = 0;
      of_cell.push_back(find_pieces(cc, count));
      const std::size_t first = list.size();
      list.resize(first + count);
      for (std::size_t e = 0; e < cc.cells.size(); ++e) {
        int& piece = of_cell[b][e];
        piece += static_cast<int>(first);
        list[piece].body = static_cast<int>(b);
        for (int k = 0; k < 2; ++k) {
          const Vec3 x = cc.grid.to_global(Vec3(cc.cells[e][0] + k, cc.cells[e][1] + k, cc.cells[e][2] + k));
          list[piece].low = list[piece].low.cwiseMin(x);
          list[piece].high = list[piece].high.cwiseMax(x);
        }
      }
    }
  }
};

std::string as_text(const Vec3& x) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", x[0], x[1], x[2]); }

std::string motion_text(const Piece& piece, const Motion& m) {
  const Vec3 t = m.head<3>(), r = m.tail<3>() / piece.size();
  if (m.tail<3>().norm() < negligible * m.norm()) return "move along " + direction_text(t.normalized());
  const Vec3 axis = r.normalized();
  // A screw: its axis passes where the velocity is along it.
  const Vec3 point = piece.centre() + r.cross(t) / r.squaredNorm();
  const bool slides = std::abs(t.dot(axis)) > negligible * m.norm();
  return fmt::format("{} about the axis along {} through {}", slides ? "turn and move" : "rotate", direction_text(axis),
                     as_text(point));
}

/// Orthonormal basis of the motions of `free` (columns) that `gram` does not resist.
Eigen::MatrixXd not_resisted(const Eigen::MatrixXd& free, const Eigen::MatrixXd& gram) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(free.transpose() * gram * free);
  Eigen::Index left = 0;
  while (left < free.cols() && eigen.eigenvalues()[left] < worth_holding) ++left;
  return free * eigen.eigenvectors().leftCols(left);
}

/// Motions along and about x, y, z first, as far as they are free; then what is left. Columns of `free` are
/// orthonormal.
std::vector<Motion> readable_motions(Eigen::MatrixXd free) {
  std::vector<Motion> motions;
  const auto take = [&](const Motion& m) {
    motions.push_back(m);
    const Eigen::MatrixXd rest = free - m * (m.transpose() * free);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rest, Eigen::ComputeThinU);
    free = svd.matrixU().leftCols(free.cols() - 1);
  };
  for (int k = 0; k < 6 && free.cols() > 0; ++k) {
    const Motion m = Motion::Unit(k);
    if ((m - free * (free.transpose() * m)).norm() < negligible) take(m);
  }
  while (free.cols() > 0) take(free.col(0));
  return motions;
}

class FreeMotion {
 public:
  FreeMotion(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
             const std::vector<ContactPair>& pairs)
      : scene_(scene), bodies_(bodies), pieces_(bodies) {
    if (pieces_.list.size() > most_pieces) return;
    const auto n = static_cast<Eigen::Index>(6 * pieces_.list.size());
    stiffness_ = Eigen::MatrixXd::Zero(n, n);
    for (const SupportPoint& p : supports) add_support(p);
    for (const ContactPair& pair : pairs)
      for (const ContactPoint& q : pair.points)
        if (q.active) add_contact(pair, q);
  }

  std::string describe() const {
    if (pieces_.list.size() > most_pieces)
      return fmt::format("the bodies are in {} separate pieces: are the cells larger than their walls?",
                         pieces_.list.size());
    const double largest = stiffness_.diagonal().sum();  // at least the largest eigenvalue, at most n times
    const Eigen::Index n = stiffness_.rows();
    if (largest > 0) {
      const Eigen::LLT<Eigen::MatrixXd> all_held(stiffness_ - not_held * largest * Eigen::MatrixXd::Identity(n, n));
      if (all_held.info() == Eigen::Success) return {};
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(stiffness_);
    Eigen::Index count = 0;
    while (count < n && eigen.eigenvalues()[count] <= not_held * eigen.eigenvalues()[n - 1]) ++count;
    if (count == 0) return {};
    return describe(eigen.eigenvectors().leftCols(count));
  }

 private:
  void add_support(const SupportPoint& p) {
    const int piece = pieces_.of_cell[p.body][p.cell];
    const Motion q = pieces_.list[piece].row(global_position(bodies_[p.body].cut_cells, p.cell, p.xi), p.direction);
    const double size = pieces_.list[piece].size();
    stiffness_.block<6, 6>(6 * piece, 6 * piece).noalias() += p.weight / (size * size) * q * q.transpose();
  }

  void add_contact(const ContactPair& pair, const ContactPoint& point) {
    const int piece[2] = {pieces_.of_cell[pair.primary][point.primary_cell],
                          pieces_.of_cell[pair.secondary][point.secondary_cell]};
    const Motion row[2] = {pieces_.list[piece[0]].row(point.x, -point.normal),
                           pieces_.list[piece[1]].row(point.x, point.normal)};
    const double size = pieces_.list[piece[0]].size();
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        stiffness_.block<6, 6>(6 * piece[i], 6 * piece[j]).noalias() +=
            point.weight / (size * size) * row[i] * row[j].transpose();
  }

  std::string describe(const Eigen::MatrixXd& modes) const {
    Eigen::Index chosen = 0;  // the piece that moves most
    double most = -1;
    for (std::size_t k = 0; k < pieces_.list.size(); ++k) {
      const double share = modes.middleRows<6>(static_cast<Eigen::Index>(6 * k)).norm();
      if (share > most * (1 + negligible)) chosen = static_cast<Eigen::Index>(k);
      most = std::max(most, share);
    }
    const Piece& piece = pieces_.list[chosen];
    const Eigen::MatrixXd own = modes.middleRows<6>(6 * chosen);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(own, Eigen::ComputeThinU | Eigen::ComputeThinV);
    Eigen::Index dimension = 0;
    while (dimension < svd.singularValues().size() && svd.singularValues()[dimension] > negligible) ++dimension;
    const Eigen::MatrixXd free = svd.matrixU().leftCols(dimension);
    if (dimension == 6)
      return fmt::format(
          "{} is not held at all: it is free to move and rotate in every direction: add supports or "
          "contacts that hold it{}",
          piece_text(chosen), advice(chosen, free));
    std::string text;
    const std::vector<Motion> motions = readable_motions(free);
    for (std::size_t k = 0; k < motions.size(); ++k)
      text += (k == 0 ? "" : k + 1 < motions.size() ? ", to " : " and to ") + motion_text(piece, motions[k]);
    // The whole motion in which this piece does the first one and the others as little as they can.
    const Eigen::VectorXd share = (free.transpose() * motions[0]).cwiseQuotient(svd.singularValues().head(dimension));
    const Eigen::VectorXd together = modes * (svd.matrixV().leftCols(dimension) * share);
    return fmt::format("{} is free to {}{}: add a support or a contact that holds it{}", piece_text(chosen), text,
                       companions_text(chosen, together), advice(chosen, free));
  }

  std::string piece_text(Eigen::Index k) const {
    const Piece& piece = pieces_.list[k];
    const std::string name = fmt::format("body \"{}\"", scene_.bodies[piece.body].name);
    const auto same = [&](const Piece& other) { return other.body == piece.body; };
    const auto count = std::count_if(pieces_.list.begin(), pieces_.list.end(), same);
    if (count == 1) return name;
    const auto number = std::count_if(pieces_.list.begin(), pieces_.list.begin() + k + 1, same);
    return fmt::format("{} is in {} separate pieces: piece {}, from {} to {} m,", name, count, number,
                       as_text(piece.low), as_text(piece.high));
  }

  std::string companions_text(Eigen::Index chosen, const Eigen::VectorXd& motion) const {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < pieces_.list.size(); ++k) {
      const auto index = static_cast<Eigen::Index>(k);
      const std::string name = '"' + scene_.bodies[pieces_.list[k].body].name + '"';
      if (index != chosen && motion.segment<6>(6 * index).norm() > negligible * motion.norm() &&
          std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
    }
    return names.empty() ? "" : fmt::format(" (together with {})", fmt::join(names, ", "));
  }

  /// Supports that would hold the motions, chosen one by one: faces held along their normal if that resists, else in a
  /// global direction.
  std::string advice(Eigen::Index chosen, Eigen::MatrixXd free) const {
    std::map<std::string, Eigen::Matrix<double, 6, 6>> resistance;  // of "face", symmetry ... per unit area
    std::map<std::string, double> area;
    const Piece& piece = pieces_.list[chosen];
    const BodyModel& body = bodies_[piece.body];
    for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p) {
      if (pieces_.of_cell[piece.body][body.cut_cells.boundary.cell[p]] != chosen) continue;
      if (body.boundary.pair_of_point[p] >= 0) continue;
      for (const std::string& name : body.surface_names(p)) {
        const std::string face = fmt::format("{{face = \"{}.{}\", ", scene_.bodies[piece.body].name, name);
        const auto add = [&](const std::string& how, const Vec3& d) {
          const Motion q = piece.row(body.point(p), d);
          const auto entry = resistance.emplace(face + how, Eigen::Matrix<double, 6, 6>::Zero()).first;
          entry->second.noalias() += body.area(p) * q * q.transpose();
          area[face + how] += body.area(p);
        };
        add("symmetry = true}", body.normal(p));
        for (int k = 0; k < 3; ++k) add(fmt::format("displacement = {{{} = 0}}}}", "xyz"[k]), Vec3::Unit(k));
      }
    }
    std::string text;
    while (free.cols() > 0) {
      std::string best;
      double most = worth_holding;
      for (const bool by_symmetry : {true, false})
        for (const auto& [how, sum] : resistance) {
          if ((how.find("symmetry") != std::string::npos) != by_symmetry || (!by_symmetry && !best.empty())) continue;
          const Eigen::MatrixXd gram = free.transpose() * sum * free / area[how];
          const double held = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram).eigenvalues().maxCoeff();
          if (held > most * (1 + negligible)) best = how;
          most = std::max(most, held);
        }
      if (best.empty()) break;
      text += (text.empty() ? ", for example [[support]] " : " and ") + best;
      free = not_resisted(free, resistance[best] / area[best]);
    }
    return text;
  }

  const Scene& scene_;
  const std::vector<BodyModel>& bodies_;
  const Pieces pieces_;
  Eigen::MatrixXd stiffness_;
};

}  // namespace

std::vector<int> find_pieces(const CutCells& cut_cells, int& count) {
  std::vector<int> piece(cut_cells.cells.size(), -1), waiting;
  count = 0;
  for (std::size_t start = 0; start < piece.size(); ++start) {
    if (piece[start] >= 0) continue;
    piece[start] = count;
    waiting.push_back(static_cast<int>(start));
    while (!waiting.empty()) {
      const Index3 cell = cut_cells.cells[waiting.back()];
      waiting.pop_back();
      for (int f = 0; f < 6; ++f) {
        Index3 next = cell;
        next[f / 2] += f % 2 == 0 ? -1 : 1;
        const int neighbour = cut_cells.find(next);
        if (neighbour < 0 || piece[neighbour] >= 0) continue;
        piece[neighbour] = count;
        waiting.push_back(neighbour);
      }
    }
    ++count;
  }
  return piece;
}

std::string find_free_motion(const Scene& scene, const std::vector<BodyModel>& bodies,
                             const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs) {
  return FreeMotion(scene, bodies, supports, pairs).describe();
}

}  // namespace cgcontact

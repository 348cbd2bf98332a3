#include "core/drawing/contact_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cgcontact {

namespace {

/// Rows whose normals differ by more (cosine) lie on another face.
constexpr double same_face = 0.7;
/// Added to the squares of the coordinates in units of the reach: without enough rows across the slope is zero.
constexpr double ridge = 1e-3;

/// Fractions of a cell that are tried in turn, until there are enough rows: fits over more flatten a peak.
constexpr double reaches[] = {0.25, 0.35, 0.5, 0.7, 1};
constexpr std::size_t enough_rows = 6;

/// Returns whether the other face lies opposite: at its end the pressure jumps.
bool is_opposite(const ContactRow& row) { return std::isfinite(row.distance); }

}  // namespace

/// Rows near a point with their weights and coordinates in the plane of the face.
struct ContactFit::Neighbours {
  std::vector<const ContactRow*> rows;
  std::vector<double> weight;
  std::vector<Vec3> coordinates;  ///< 1, and two in units of the reach

  /// Returns the fit at the point; NaN without rows that have the value.
  template <class Get>
  double fit(const Get& get) const {
    Mat3 squares = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    double low = std::numeric_limits<double>::max(), high = -low, total = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double value = get(*rows[i]);
      if (!std::isfinite(value)) continue;
      squares += weight[i] * coordinates[i] * coordinates[i].transpose();
      right += weight[i] * value * coordinates[i];
      total += weight[i];
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (!(total > 0)) return std::nan("");
    squares.diagonal().tail<2>().array() += ridge * total;
    return std::clamp((squares.inverse() * right)[0], low, high);
  }
};

ContactFit::ContactFit(const Results& results, int body) {
  for (const ContactRow& row : results.contact_rows)
    if (row.body == body) rows_.push_back(&row);
}

const PointBuckets& ContactFit::buckets(double reach) {
  const auto [found, is_new] = buckets_.try_emplace(reach, reach);
  if (is_new)
    for (std::size_t i = 0; i < rows_.size(); ++i) found->second.add(rows_[i]->x, static_cast<int>(i));
  return found->second;
}

/// Finds those on the face of the nearest one.
ContactFit::Neighbours ContactFit::neighbours_of(const Vec3& x, double reach) {
  const PointBuckets& near = buckets(reach);
  const ContactRow* nearest = nullptr;
  near.each_near(x, [&](int i) {
    if (!nearest || (rows_[i]->x - x).squaredNorm() < (nearest->x - x).squaredNorm()) nearest = rows_[i];
  });
  Neighbours neighbours;
  if (!nearest) return neighbours;
  const Vec3 first = nearest->normal.unitOrthogonal(), second = nearest->normal.cross(first);
  near.each_near(x, [&](int i) {
    const Vec3 way = (rows_[i]->x - x) / reach;
    const double left = 1 - way.squaredNorm();
    if (left <= 0 || rows_[i]->pair != nearest->pair || rows_[i]->normal.dot(nearest->normal) < same_face ||
        is_opposite(*rows_[i]) != is_opposite(*nearest))
      return;
    neighbours.rows.push_back(rows_[i]);
    neighbours.weight.push_back(left * left);
    neighbours.coordinates.emplace_back(1, way.dot(first), way.dot(second));
  });
  return neighbours;
}

std::optional<ContactFit::Values> ContactFit::at(const Vec3& x, double cell) {
  Neighbours neighbours;
  for (const double reach : reaches) {
    neighbours = neighbours_of(x, reach * cell);
    if (neighbours.rows.size() >= enough_rows) break;
  }
  if (neighbours.rows.empty()) return std::nullopt;
  return Values{neighbours.fit([](const ContactRow& row) { return row.gap; }),
                neighbours.fit([](const ContactRow& row) { return row.pressure_sprc; }),
                neighbours.fit([](const ContactRow& row) { return row.pressure_error; }),
                neighbours.fit([](const ContactRow& row) { return row.shear_sprc.norm(); }),
                neighbours.fit([](const ContactRow& row) { return row.active ? row.slip.norm() : std::nan(""); }),
                neighbours.fit([](const ContactRow& row) { return row.active ? row.wear : std::nan(""); })};
}

}  // namespace cgcontact

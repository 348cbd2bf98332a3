#include "contact/results/estimates/peak_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {
namespace {

/// Fraction of the largest pressure, and cells away from it, that belong to the peak.
constexpr double near_largest = 0.9, peak_reach = 4;
/// Fraction of the largest singular value: directions below have no rows that fix the fit's coefficients (a row of
/// cells).
constexpr double rank_tolerance = 1e-6;
constexpr int num_coefficients = 6;

/// Rows whose pressure is about the largest of their pair: any of them may have the largest of the exact one.
std::vector<const ContactRow*> rows_near_largest(const std::vector<ContactRow>& rows, int pair,
                                                 const PairFigures& figures) {
  std::vector<const ContactRow*> near;
  for (const ContactRow& row : rows)
    if (row.pair == pair && row.touching && row.pressure_sprc >= near_largest * figures.max_pressure)
      near.push_back(&row);
  return near;
}

/// Those around the largest pressure.
std::vector<const ContactRow*> rows_of_peak(std::vector<const ContactRow*> rows, const PairFigures& figures) {
  rows.erase(std::remove_if(rows.begin(), rows.end(),
                            [&](const ContactRow* row) {
                              return (row->x - figures.max_pressure_at).norm() > peak_reach * row->larger_cell;
                            }),
             rows.end());
  return rows;
}

/// Largest value at the rows of the quadratic function that fits them best, weighted by their areas, Pa.
double largest_of_fit(const std::vector<const ContactRow*>& peak, const PairFigures& figures) {
  const Vec3 n = (*std::max_element(peak.begin(), peak.end(), [](const ContactRow* a, const ContactRow* b) {
                   return a->pressure_sprc < b->pressure_sprc;
                 }))->normal;
  const Vec3 t1 = n.unitOrthogonal(), t2 = n.cross(t1);
  double scale = 0;
  for (const ContactRow* row : peak) scale = std::max(scale, (row->x - figures.max_pressure_at).norm());
  if (!(scale > 0)) return figures.max_pressure;
  const Eigen::Index count = static_cast<Eigen::Index>(peak.size());
  Eigen::MatrixXd values(count, num_coefficients);
  Eigen::VectorXd pressure(count), root(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ContactRow& row = *peak[i];
    const Vec3 d = (row.x - figures.max_pressure_at) / scale;
    const double u = d.dot(t1), v = d.dot(t2);
    values.row(i) << 1, u, v, u * u, u * v, v * v;
    pressure[i] = row.pressure_sprc;
    root[i] = std::sqrt(row.weight);
  }
  return (values * least_squares(root.asDiagonal() * values, root.cwiseProduct(pressure), rank_tolerance)).maxCoeff();
}

bool is_singular(const Results& results, const Vec3& x) {
  return std::any_of(results.singular_points.begin(), results.singular_points.end(),
                     [&](const SingularPoint& point) { return (point.x - x).norm() <= peak_reach * point.cell; });
}

}  // namespace

void estimate_peak_errors(Results& results) {
  for (std::size_t p = 0; p < results.pairs.size(); ++p) {
    PairFigures& figures = results.pairs[p];
    figures.max_pressure_error_estimate.reset();
    if (!(figures.max_pressure > 0) || results.verdict.pairs[p].state != Verdict::State::resolved ||
        is_singular(results, figures.max_pressure_at))
      continue;
    const auto near = rows_near_largest(results.contact_rows, static_cast<int>(p), figures);
    double largest_error = 0;
    for (const ContactRow* row : near) largest_error = std::max(largest_error, row->pressure_error);
    const double excess = std::abs(figures.max_pressure - largest_of_fit(rows_of_peak(near, figures), figures));
    figures.max_pressure_error_estimate =
        std::hypot((excess + largest_error) / figures.max_pressure, figures.force_error_of_pressure);
  }
}

}  // namespace cgcontact

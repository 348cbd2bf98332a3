/// Fewer points with the same integrals: positive rules by elimination (Caratheodory's theorem).
#pragma once

#include <vector>

namespace cgcontact {

/// Values of several functions at the points of a rule; the values of one function lie together.
struct FunctionTable {
  int num_functions = 0, num_points = 0;
  std::vector<double> values;
  void resize(int functions, int points) {
    num_functions = functions;
    num_points = points;
    values.assign(static_cast<std::size_t>(functions) * points, 0.0);
  }
  double* operator[](int f) { return values.data() + static_cast<std::size_t>(f) * num_points; }
  const double* operator[](int f) const { return values.data() + static_cast<std::size_t>(f) * num_points; }
};

/// Changes the positive `weights` such that the integrals of all functions stay the same and at most as many points as
/// there are linearly independent functions keep a positive weight (the others get 0). Leaves the weights alone if
/// it cannot reach rounding accuracy. The functions should be of size one.
void compress_weights(const FunctionTable& functions, std::vector<double>& weights);

/// The same for many points in batches: time proportional to the number of points.
void compress_many_weights(FunctionTable functions, std::vector<double>& weights);

/// Changes the positive `weights` of the first points of the table as little as possible, each by its own measure, to
/// add the integrals of the points after them, whose weights (of any sign) are `others`. False, and nothing is changed,
/// if a weight would not be positive or rounding accuracy is not reached.
bool take_integrals(const FunctionTable& functions, const std::vector<double>& others, std::vector<double>& weights);

/// Tabulates the polynomials of total degree <= degree in (s, t), and with `curved` also those of degree <= degree - 1
/// times the height: on a plane, a sphere or a cylinder these are all polynomials of that degree in space. `points`: s,
/// t, height of all points; scaled in place, the height by the extent along the face.
FunctionTable surface_polynomials(std::vector<double> (&points)[3], int degree, bool curved);

}  // namespace cgcontact

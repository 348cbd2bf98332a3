/// All roots of a smooth function on a short interval.
#pragma once

#include <algorithm>
#include <cmath>

namespace cgcontact {

/// Value and slope of a function at x.
struct FunctionSample {
  double x, value, slope;
};

/// Finds the root between two samples of opposite sign: Newton steps, bisection where they fail.
template <class Function>
double bracketed_root(const Function& f, FunctionSample a, FunctionSample b) {
  FunctionSample best = std::abs(a.value) < std::abs(b.value) ? a : b;
  const double tolerance = 2e-16 * (std::abs(a.x) + std::abs(b.x));
  for (int iteration = 0; iteration < 100 && b.x - a.x > tolerance; ++iteration) {
    double x = best.x - best.value / best.slope;
    if (iteration % 6 == 5 || !(x > a.x && x < b.x)) x = 0.5 * (a.x + b.x);
    if (x == a.x || x == b.x) break;
    const double step = std::abs(x - best.x);
    best = f(x);
    if (best.value == 0 || step <= tolerance) break;
    ((best.value < 0) == (a.value < 0) ? a : b) = best;
  }
  return best.x;
}

/// Finds a point between two samples of equal sign where the function has the other sign, if its extremum there reaches
/// it.
template <class Function>
bool cross_extremum(const Function& f, FunctionSample a, FunctionSample b, FunctionSample& found) {
  const bool negative = a.value < 0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double length = b.x - a.x;
    const bool towards = (a.slope > 0) == negative && (b.slope > 0) != negative && a.slope != 0 && b.slope != 0;
    // the function lies beyond its tangents where it is convex
    if (!towards || std::abs(a.value) >= std::abs(a.slope) * length || std::abs(b.value) >= std::abs(b.slope) * length)
      return false;
    double x = a.x + length * a.slope / (a.slope - b.slope);
    if (iteration % 4 == 3 || !(x > a.x && x < b.x)) x = 0.5 * (a.x + b.x);
    if (x <= a.x || x >= b.x) return false;
    found = f(x);
    if ((found.value < 0) != negative) return true;
    ((found.slope > 0) == (a.slope > 0) ? a : b) = found;
  }
  return false;
}

/// Roots in (a,b), ascending; sees pairs of roots near a local extremum between samples. Returns their number.
template <class Function>
int find_roots(const Function& f, double a, double b, double* roots, int max_roots) {
  constexpr int samples = 6;
  int n = 0;
  FunctionSample previous = f(a);
  for (int i = 1; i <= samples; ++i) {
    const FunctionSample next = f(a + (b - a) * i / samples);
    FunctionSample middle;
    if ((previous.value < 0) != (next.value < 0)) {
      if (n < max_roots) roots[n++] = bracketed_root(f, previous, next);
    } else if (n + 1 < max_roots && cross_extremum(f, previous, next, middle)) {
      roots[n++] = bracketed_root(f, previous, middle);
      roots[n++] = bracketed_root(f, middle, next);
    }
    previous = next;
  }
  return n;
}

}  // namespace cgcontact

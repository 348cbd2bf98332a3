/// Error estimate in the energy norm: |e|^2 = int (sigma* - sigma_h) : D^-1 : (sigma* - sigma_h) (Zienkiewicz-Zhu).
#pragma once

#include <functional>

#include "recovery/spr/spr.hpp"

namespace cgcontact {

/// Squares of energy norms, in units of Scales::stress * Scales::length^3.
struct EnergySums {
  std::vector<double> error_of_cell;     ///< |sigma* - sigma_h|^2 per active cell
  std::vector<double> solution_of_cell;  ///< |sigma_h|^2 per active cell
  double error = 0;                      ///< their sum
  double solution = 0;                   ///< |sigma_h|^2
  double exact_error = 0;                ///< |sigma_exact - sigma_h|^2 when an exact stress is given
  double recovered_error = 0;            ///< |sigma_exact - sigma*|^2
};

/// Exact stress at x (m, global axes) in Pa; grid axes conversion is done here. May be called by several threads at
/// once.
using ExactStress = std::function<Sym3(const Vec3& x)>;

/// Integrates the error. With linear polynomials the integrals are exact: sigma* is of degree 2 per variable, so 3
/// points per direction serve interior cells and weights fitted to moments of degree 4 serve cut cells. Next to nodes
/// of degree 2 sigma* is of degree 3 per variable and its square of degree 6: exact in interior cells (5 points per
/// direction), while cut cells integrate the interpolation of the square of degree 4 per variable. With an exact stress
/// all cells get 5 points per direction.
EnergySums estimate_error(const BodyMesh& mesh, const Scales& scales, const RecoveredField& recovered,
                          const RealView& u, const ExactStress& exact);

}  // namespace cgcontact

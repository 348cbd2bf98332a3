/// Points where the recovered pressure cannot be right, whatever its estimated error in the mean.
#pragma once

#include <vector>

#include "core/results/results.hpp"
#include "core/settings/result_options.hpp"

namespace cgcontact {

/// Worst point of a pair, where the recovered pressure leaves the range that the finite element stress, plain SPR and
/// the transmitted forces have around it.
struct PressureJump {
  int pair = 0;
  Vec3 x = Vec3::Zero();                     ///< m
  double pressure = 0;                       ///< Pa, recovered by SPR-C
  double around_least = 0, around_most = 0;  ///< Pa, range of the others within ResultOptions::spoilt_at_edge cells
  double cell = 0;                           ///< m, size of the larger cell there
  double force_fraction = 0;                 ///< of the pair's force, by which all such points of it leave the range
  /// Returns whether the largest pressure of the pair may be this point's.
  bool is_spike() const { return pressure > around_most; }
};

/// Finds one for each pair that has any. A row is examined if all rows of its face within ResultOptions::spoilt_at_edge
/// cells are closed. Inside a zone SPR-C corrects the others by some per cent of the pair's largest pressure, and by
/// more where they are unsure, so it may leave their range by ResultOptions::largest_jump of that and by the difference
/// of the finite element stress and plain SPR there. Where these two are wrong together, as in bodies that lock, SPR-C
/// follows the forces. An estimate of the mean error misses a hole or a spike (docs/recovery.md, "Error figures").
/// `max_pressures`: of each pair, Pa.
std::vector<PressureJump> pressure_jumps(const std::vector<ContactRow>& rows, const std::vector<double>& max_pressures,
                                         const ResultOptions& options);

}  // namespace cgcontact

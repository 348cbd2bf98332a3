/// Sizes of the next grid from the estimated error of the energy norm (ZZ).
#pragma once

#include <memory>
#include <vector>

#include "core/cells/size_field.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Returns a body's estimated error relative to its own energy norm.
double energy_error_of_body(const BodyFields& body);

/// Returns the relative error of the energy norm expected once the cells are as small as `zones` (of each body) ask:
/// the local error falls like the size of the cells.
double expected_energy_error(const Results& results, const std::vector<std::unique_ptr<SizeField>>& zones);
/// Returns the same of one body.
double expected_energy_error(const BodyFields& body, const SizeField& zones);

/// Returns for each body the sizes of the grid of fewest cells with a relative error of `target` in the energy norm of
/// all bodies (Fuenmayor and Oliver, IJNME 39 (1996) 4039, with p = 1 in three dimensions): error_of_cell falls with
/// the size to the power 1 + 3/2, so h_new/h = E e^(-2/5) (sum of e^(6/5))^(-1/2); on quadtrees to the power 2, so
/// h_new/h = E e^(-1/2) (sum of e)^(-1/2). Only sizes below the body's first cells (m). Cells at a contact are asked
/// for the sizes of their partner's, too: contact holds in the mean over the larger cell of the two, so that fine cells
/// opposite coarse ones (of a rigid body, whose energy asks for nothing) are loaded by steps of the coarse ones.
std::vector<std::vector<SizedBall>> energy_sizes(const Results& results, double target,
                                                 const std::vector<double>& first_sizes);
/// Returns the same of one body, whose own error is to be `target` of its own energy norm. first_size: m.
std::vector<SizedBall> energy_sizes(const BodyFields& body, double target, double first_size);

}  // namespace cgcontact

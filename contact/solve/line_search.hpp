/// Line search along the step of a linear solve.
#pragma once

#include "contact/solve/iterate.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace cgcontact {

/// Goes from `before` as far towards iterate.u as the energy u . K u / 2 - f . u + sum over contact points of w [p* - k
/// gap]_+^2 / (2 k) falls, so that the active set cannot cycle while p* stays. The linear system (`solver` has solved
/// it) minimises the energy with the present closed contact; points that the step closes or opens bend it. With
/// friction that slips there is no energy: as far as the residual along the step keeps its sign, or whole where the
/// matrix is not positive along it. Returns the fraction of the step, 1 if whole.
double search_along_step(const LinearSolver& solver, const RealView& before, Iterate& iterate);

}  // namespace cgcontact

/// Systems with constrained nodes: consistent vectors, products by the fast operator and by the assembled matrix.
#pragma once

#include <gtest/gtest.h>

#include <Tpetra_Core.hpp>

#include "kernels/assembled/assembly.hpp"
#include "kernels/reference/plain_operator.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test {

inline ElasticSystem make_system(const CutCells& cells, double ghost_penalty = 0.01) {
  return make_elastic_system({&cells}, {Material{2.0, 0.3}}, Scales{1.0, 1.0}, ghost_penalty);
}

inline RealView consistent(const ElasticSystem& system, const RealView& x) {
  RealView y("y", x.extent(0));
  Kokkos::deep_copy(y, x);
  apply_constraints(ExecSpace(), system.dofs, y);
  return y;
}

/// Zero at constrained nodes and components.
inline RealView random_force(const ElasticSystem& system, unsigned seed) {
  RealView f = random_vector(system.num_dofs(), seed);
  for (const NodeConstraint& c : system.constraints)
    for (int i = 0; i < 3; ++i) f(dof_of(c.node, i)) = 0;
  for (const int dof : system.zero_dofs) f(dof) = 0;
  return f;
}

inline RealView apply(const ElasticSystem& system, const RealView& x) {
  RealView y("y", x.extent(0));
  FastOperator<double>(system).apply(ExecSpace(), x, y);
  return y;
}

/// By the assembled matrix, which has the identity at constrained nodes.
inline RealView apply_assembled(const ElasticSystem& system, const RealView& x) {
  const auto map = system.dofs.vector_map(Tpetra::getDefaultComm());
  const auto matrix = assemble_matrix(system, map);
  TpetraVector in(map, 1), out(map, 1);
  {
    auto view = in.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t i = 0; i < x.extent(0); ++i) view(i, 0) = x(i);
  }
  matrix->apply(in, out);
  RealView y("y", x.extent(0));
  const auto view = out.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t i = 0; i < x.extent(0); ++i) y(i) = view(i, 0);
  return y;
}

inline RealView difference(const RealView& a, const RealView& b) {
  RealView d("d", a.extent(0));
  for (std::size_t i = 0; i < a.extent(0); ++i) d(i) = a(i) - b(i);
  return d;
}

/// Expects the fast operator to have the products of its plain reference and of the assembled matrix, up to so many
/// roundings.
inline void expect_same_products(const ElasticSystem& system, double roundings) {
  const double tolerance = roundings * 2.2e-16;
  const RealView x = consistent(system, random_vector(system.num_dofs(), 4));
  RealView plain("plain", x.extent(0));
  PlainOperator(system).apply(ExecSpace(), x, plain);
  EXPECT_LT(norm(difference(apply(system, x), plain)), tolerance * norm(plain));
  const RealView f = random_force(system, 5), y = apply(system, consistent(system, f));
  EXPECT_LT(norm(difference(y, apply_assembled(system, f))), tolerance * norm(y));
}

}  // namespace cgcontact::test

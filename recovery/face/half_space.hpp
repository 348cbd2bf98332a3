/// Compliance of two half-spaces pressed together on a grid of patches: how far the faces give way where the patches
/// press (Love 1929 for rectangles; in plane strain Johnson, Contact Mechanics, 1985, equation 2.24).
#pragma once

#include "kernels/mesh/views.hpp"
#include "recovery/face/face_grid.hpp"

namespace cgcontact {

/// S p with S_ij the displacement at the centre of patch i by unit pressure on patch j and on its images behind the
/// symmetry planes. Displacements of plane strain, and of periodic zones, have no absolute value: they are known up to
/// a constant, which the force of the zone fixes.
class HalfSpace {
 public:
  using Memory = MemSpace;
  /// (rows, columns)
  using Patches = Kokkos::View<double**, Kokkos::LayoutRight, Memory>;

  /// modulus: E* of both bodies, Pa.
  HalfSpace(const FaceGrid& grid, double modulus);

  /// (rows, columns); 0 or 1
  using Marks = Kokkos::View<char**, Kokkos::LayoutRight, Memory>;

  /// u = S p, m, at the marked patches and some beside them. p: Pa. Each patch sums in a fixed order.
  template <class Exec>
  void apply(const Exec& exec, const Patches& p, const Marks& at, const Patches& u) const;

  /// Gives the table at an offset of patches, m/Pa; for tests.
  double influence(int rows, int columns) const;

 private:
  FaceGrid grid_;
  /// (offsets along axis 0 from 0, signed offsets along axis 1 from the most negative one)
  Kokkos::View<double**, Kokkos::LayoutRight, Memory> table_;
  Patches extended_;                                           ///< pressures with their images
  Kokkos::View<int* [2], Kokkos::LayoutRight, Memory> range_;  ///< of each row of these, what is not zero
};

}  // namespace cgcontact

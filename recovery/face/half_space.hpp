/// Compliance of two half-spaces pressed together on a grid of patches: how far the faces give way where the patches
/// press (Love 1929 for rectangles; in plane strain Johnson, Contact Mechanics, 1985, equation 2.24; around an axis of
/// revolution its section 3.8: rings, by elliptic integrals).
#pragma once

#include "kernels/mesh/views.hpp"
#include "recovery/face/cosine_transform.hpp"
#include "recovery/face/face_grid.hpp"

namespace cgcontact {

/// S p with S_ij the displacement at the centre of patch i by unit pressure on patch j and on its images behind the
/// symmetry planes. Displacements of plane strain, and of periodic zones, have no absolute value: they are known up to
/// a constant, which the force of the zone fixes.
///
/// Rings have a dense S: the displacement by a ring of pressure, 4 r' / D K(k) / (pi E*) along its line, D the longest
/// distance to it, as if the half-space lay around the axis.
///
/// Elsewhere S depends on the distance of the patches alone. Pressures that are mirrored at both ends of each axis make
/// it diagonal in cosines; a free end becomes one of those by room for as many patches again, beyond which nothing
/// acts.
class HalfSpace {
 public:
  using Memory = MemSpace;
  /// (rows, columns)
  using Patches = Kokkos::View<double**, Kokkos::LayoutRight, Memory>;
  /// (rows, columns); 0 or 1
  using Marks = Kokkos::View<char**, Kokkos::LayoutRight, Memory>;

  /// modulus: E* of both bodies, Pa.
  template <class Exec>
  HalfSpace(const Exec& exec, const FaceGrid& grid, double modulus);

  /// u = S p, m, at all patches. p: Pa. Each patch sums in a fixed order. Accuracy: rounding, relative to the largest
  /// value (some 1e-14).
  template <class Exec>
  void apply(const Exec& exec, const Patches& p, const Patches& u) const;

  /// Gives S between a patch and one (rows, columns) beyond, without images but with periods, m/Pa.
  static double influence(const FaceGrid& grid, double modulus, int rows, int columns);

 private:
  Patches rings_;                           ///< S of rings; empty: none
  std::array<CosineTransform, 2> cosines_;  ///< along each axis
  Patches spectrum_;                        ///< (cosines of axis 0, of axis 1)
  Patches along_, both_;                    ///< work: (patches of axis 1, cosines of axis 0); (cosines, cosines)
};

}  // namespace cgcontact

/// From the mesh and the boundary to the constrained fit of one patch: its kind, its auxiliary patch in the other body,
/// its constraint rows (paper, equations 4, 5, 12, 13).
#pragma once

#include "kernels/operator/system.hpp"
#include "recovery/constrained/boundary_pieces.hpp"
#include "recovery/constrained/contact_cells.hpp"
#include "recovery/patch/contact_edge.hpp"
#include "recovery/patch/known_pressures.hpp"
#include "recovery/patch/patch_arrays.hpp"
#include "recovery/spr/recovery_input.hpp"

namespace cgcontact {

/// Cells that the polynomial of a node is fitted to, ascending: its patch, and so many rings of cells around the node.
void fit_cells(const RecoveryBody& body, int node, PatchPolynomial polynomial, std::vector<int>& cells);

/// Integrals over all cells near the closed contact points (as far as the auxiliary depth and two cells more), which
/// auxiliary patches may consist of, and over those that polynomials of degree 2 are fitted to.
StressIntegrals integrate_stress(const RecoveryBody& body, const std::vector<PatchPolynomial>& polynomials,
                                 const CellStress& stress, const RecoveryOptions& options);

/// Whether a patch holds points of a contact face, closed or open.
bool touches_contact(const RecoveryBody& body, int node);

/// Mean square of what a fit leaves of sigma_h; not less than the part of it that rounding may leave of a good fit.
/// 0 if the integrals over some of the cells are not known.
double fit_variance(const BodyMesh& mesh, const StressIntegrals& integrals, const std::vector<int>& cells,
                    const PatchFit& fit);

/// Contact points of one pair inside a patch.
struct PairState {
  int pair = -1, other_body = -1;
  double area = 0, closed_area = 0, unknown_area = 0;  ///< m^2; as of ContactPiece
  bool is_closed(double fraction) const;               ///< RecoveryOptions::closed_fraction
  bool is_mixed() const { return closed_area > 0 && closed_area < area * (1 - 1e-12); }
};

/// The polynomial of every node of a body. Automatic at the contact: degree 2 in patches with closed points where both
/// bodies are at least four cells thick in all directions of their grids, over as many rings as suit that thickness
/// where nothing knows the pressure; `known` may be null. Elsewhere one ring.
std::vector<PatchPolynomial> patch_polynomials(const std::vector<RecoveryBody>& bodies, std::size_t index,
                                               const KnownPressures* known, const RecoveryOptions& options);

/// Memory that is used again for patch after patch.
struct PatchWorkspace {
  std::vector<ConstraintGroup> groups;
  std::vector<PairState> states;
  std::vector<char> modes;          ///< of states
  std::vector<int> own, auxiliary;  ///< cells that the polynomials are fitted to
  std::vector<char> box;            ///< marks of the cells in a box
};

/// What assembling one patch gives; its rows are appended to a list of many patches.
struct PatchProblem {
  int node = -1;
  PatchKind kind = PatchKind::interior;
  PatchStatus status = PatchStatus::exact;
  bool coupled = false;                                         ///< with an auxiliary patch
  bool bonded = false;                                          ///< to that
  bool lowered = false;                                         ///< degree 2 was asked for
  PatchFit fit[2];                                              ///< own, auxiliary
  std::array<double, Polynomial<2>::num_interior> interior[2];  ///< Polynomial::interior_values; own, auxiliary
  std::size_t first_row = 0;                                    ///< in the list
  int num_rows = 0;
  int pair = -1, other_body = -1;  ///< of the auxiliary patch
  bool has_edge = false;           ///< the term of the contact edge is part of the stress
  ContactEdge edge;
  double factor = 0;
  std::vector<int> pressed;     ///< pairs that are not open, ascending
  std::vector<int> known;       ///< those of them whose pressure is given
  std::vector<int> open_sides;  ///< surfaces of these that are open all the same
  bool loose = false;           ///< after the solution: not all rows are met

  PatchProblem() {}  // not "= default", which zeroes 4 kB of matrices first
  int degree() const { return fit[0].degree; }
};

/// Assembles the patches of one body.
class PatchAssembly {
 public:
  /// `integrals`, `polynomials`: by body. known: may be null: all contact is coupled with the other body.
  PatchAssembly(const std::vector<RecoveryBody>& bodies, const std::vector<StressIntegrals>& integrals,
                const std::vector<std::vector<PatchPolynomial>>& polynomials, int index, const Scales& scales,
                const RecoveryOptions& options, const KnownPressures* known);

  /// What div sigma must be at a place, per `unit` of length (both in grid coordinates of a body).
  Vec3 divergence(const RecoveryBody& body, const Vec3& centre, double unit) const;

  /// The patch of a node into a new `problem`, its rows appended to `rows`.
  void assemble(int node, PatchWorkspace& workspace, std::vector<PatchRow>& rows, PatchProblem& problem) const;
  /// Contact points by pair in the patch of a node.
  void pair_states(int node, std::vector<PairState>& states) const;
  const RecoveryBody& body() const { return body_; }
  int index() const { return index_; }  ///< of the body
  const RecoveryBody& body_of(int index) const { return bodies_[index]; }
  const Grid& grid() const { return grid_; }

 private:
  enum class ContactMode { open, closed, edge, unclear };
  void assemble(int node, PatchPolynomial polynomial, PatchWorkspace& workspace, std::vector<PatchRow>& rows,
                PatchProblem& problem) const;
  void interior_values(const RecoveryBody& body, const PatchFit& fit, double* values) const;
  /// Whether any point of the group's pair is closed on the same side of the body.
  bool has_closed_points(const ConstraintGroup& group, const int* cells, int num_cells) const;
  /// An edge (global axes, m) seen from a body; `unit`: m.
  ContactEdge seen_from(const RecoveryBody& body, const Vec3& face_point, const Vec3& normal, const EdgePiece& piece,
                        double unit) const;
  ContactMode mode_of_pair(const PairState& state, const int* cells, int num_cells, PatchProblem& problem) const;
  bool knows(const PairState& state) const { return known_ && state.unknown_area == 0; }
  void own_fit(int node, int degree, const std::vector<int>& cells, PatchFit& fit) const;
  void auxiliary_fit(int node, const PairState& state, PatchPolynomial polynomial, PatchWorkspace& workspace,
                     PatchFit& fit) const;
  void add_known_traction(const ConstraintGroup& group, const PatchFit& own, std::vector<PatchRow>& rows) const;
  void add_plane_strain(int degree, std::vector<PatchRow>& rows) const;
  void add_zero_shear(const ConstraintGroup& group, const PatchFit& own, std::vector<PatchRow>& rows) const;
  void add_contact(const ConstraintGroup& group, int node, const PatchFit& own, const PatchFit* auxiliary,
                   const PairState* state, ContactMode mode, std::vector<PatchRow>& rows) const;
  /// Equation 5 with the pressure that the problem on the face gives, less what the term of the edge carries.
  void add_known_pressure(const ConstraintGroup& group, const PatchProblem& problem, std::vector<PatchRow>& rows) const;
  void add_bond(const ConstraintGroup& group, int node, const PatchFit& own, const PatchFit& auxiliary,
                const PairState& state, std::vector<PatchRow>& rows) const;
  /// The contact point of a pair in a patch that is nearest to a constraint point on the same side of the body; null:
  /// none.
  const PatchContactPoint* nearest_point(int node, int pair, const Vec3& x, const Vec3& n, double unit) const;

  const std::vector<RecoveryBody>& bodies_;
  const std::vector<StressIntegrals>& integrals_;  ///< by body
  const RecoveryBody& body_;
  const std::vector<PatchPolynomial>& polynomials_;  ///< by node
  int index_;
  const PatchArrays<Kokkos::HostSpace> arrays_;
  const Grid& grid_;
  const Scales& scales_;
  const RecoveryOptions& options_;
  const BoundaryPieces pieces_;
  const KnownPressures* known_;
  const ContactCells contact_;
};

}  // namespace cgcontact

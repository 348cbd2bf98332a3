/// All bodies' stiffness, ghost penalty, supports and contact terms as one linear system (dimensionless, Scales).
#pragma once

#include <vector>

#include "kernels/apply.hpp"

namespace cgcontact {

/// Boundary condition term k (u . d)(v . d) at one support point, condensed into the cell's matrix.
struct SupportTerm {
  int cell;          ///< active cell
  Vec3 xi;           ///< cell coordinates
  Vec3 direction;    ///< unit, grid axes
  double stiffness;  ///< kappa E/h times the point's weight, Scales::stress * Scales::length
};

/// One contact group: mean normal gap over a boundary piece of the coarser body's cell, as a sparse row on the DoFs.
struct GroupRow {
  std::vector<std::pair<int, double>> entries;  ///< (DoF, coefficient), sorted by DoF
};

struct ElasticSystem {
  std::vector<BodyMesh> meshes;
  std::vector<CellMatrixView> matrices;
  std::vector<std::vector<SupportTerm>> supports;  ///< per body
  double ghost_penalty = 0;
  std::vector<GhostMatrix> ghosts;
  GroupRows groups;
  std::vector<GroupRow> group_rows;  ///< host copy of the rows of `groups`
  int num_nodes = 0;

  int num_dofs() const { return 3 * num_nodes; }

  /// y = A x, matrix-free.
  template <class Exec, class X, class Y>
  void apply(const Exec& exec, const X& x, const Y& y) const {
    Kokkos::deep_copy(exec, y, 0.0);
    for (std::size_t b = 0; b < meshes.size(); ++b) {
      apply_cells(exec, meshes[b], matrices[b], x, y);
      apply_ghost_faces(exec, meshes[b], ghosts[b], x, y);
    }
    apply_groups(exec, groups, x, y);
  }
};

/// Meshes, cell matrices and ghost terms of all bodies.
ElasticSystem make_elastic_system(const std::vector<const CutCells*>& bodies, const std::vector<Material>& materials,
                                  const Scales& scales, double ghost_penalty);

/// Adds the support terms to the cell matrices of a body; support points lie in cut cells only.
void add_support_terms(ElasticSystem& system, int body, const std::vector<SupportTerm>& terms);

/// Sets the rows of the contact groups; stiffnesses start at zero.
void set_group_rows(ElasticSystem& system, std::vector<GroupRow> rows);

/// Sets the stiffness of each group (Scales::stress * Scales::length).
void set_group_stiffness(ElasticSystem& system, const std::vector<double>& stiffness);

}  // namespace cgcontact

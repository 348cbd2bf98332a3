/// All bodies' stiffness, ghost penalty, supports and contact terms as one linear system (dimensionless, Scales).
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "kernels/mesh/dof_map.hpp"
#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

/// Boundary condition term k (u . d)(v . d) at one support point.
struct SupportTerm {
  int cell;           ///< active cell
  Vec3 xi;            ///< cell coordinates
  Vec3 direction;     ///< unit, grid axes
  double stiffness;   ///< kappa E/h times the point's weight, Scales::stress * Scales::length
  bool thin = false;  ///< the body is about one cell thick: the smoother holds the support's unknowns together
  bool soft = false;  ///< holds what contact alone holds: firm on coarse grids (RigidCoarseSpace)
};

class RowSums;

/// One contact group: mean normal gap over a boundary facet in a cell of the coarser body, as a sparse row on the DoFs.
struct GroupRow {
  std::vector<std::pair<int, double>> entries;  ///< (DoF, coefficient), sorted by DoF
  int level = 0, cell = 0;                      ///< of the facet, in the coarser body; level: index into level_meshes()
  int family = 0;                               ///< rows of one family may be merged on coarser grids
  int coupled = -1;                             ///< row whose gap may change this one's force too; -1: none
};

/// Sparse rows (one per contact group) and their transpose, both compressed: coefficients of the mean gap.
struct GroupRows {
  IntView row_begin, row_dof;  ///< group -> entries; (num_groups + 1), (num_entries)
  RealView row_value;
  IntView dof_begin, dof_list;  ///< touched DoF -> entries of the transpose; dof_list: the touched DoFs
  IntView column_group;
  RealView column_value;
  RealView stiffness;  ///< k of each group; 0 where the group is open
  RealView scratch;    ///< (num_groups)
  /// Coupled row of each group, or -1, and force per gap of that. Empty: no row has any, the matrix is symmetric.
  IntView coupled_row;
  RealView coupling;
};

struct ElasticSystem {
  std::vector<BodyMesh> meshes;                    ///< of each body
  std::vector<std::vector<SupportTerm>> supports;  ///< of each level, with its cells
  double ghost_penalty = 0;
  std::vector<Material> materials;
  Scales scales;
  GroupRows groups;
  /// Sums of the rows that ranks share, of a system of several ranks, where rows have entries at own nodes only;
  /// nullptr: none are shared.
  std::shared_ptr<const RowSums> group_sums;
  std::vector<GroupRow> group_rows;          ///< host copy of the rows of `groups`
  std::vector<double> full_group_stiffness;  ///< of each group when closed
  /// Flags of groups whose row has changed since the solver was last updated; empty: none has.
  std::vector<char> changed_rows;
  int num_nodes = 0;  ///< DofMap::num_nodes
  DofMap dofs;
  /// Constraints of all bodies, ascending in node; of each node the index of its constraint or -1 (empty: none).
  std::vector<NodeConstraint> constraints;
  std::vector<int> constraint_of_node;
  std::vector<int> zero_dofs;  ///< ascending: across bodies in plane strain, away from axes of revolution on them

  /// Returns the meshes that the kernels run on, in turn: bodies of one level, and the levels of the others.
  std::vector<const BodyMesh*> level_meshes() const;
  /// Returns the level (index into level_meshes()) with an active cell of a body, and the cell's number there.
  std::pair<int, int> locate_cell(int body, int cell) const;

  int num_dofs() const { return dofs.num_dofs(); }
  /// Counts the degrees of freedom that neither constraints nor plane strain give.
  int num_free_dofs() const;
  bool is_zero(int dof) const;
  /// Return whether this rank computes forces on a node, on one of this cell of a level.
  bool needs(int node) const;
  bool needs_cell(const BodyMesh& level, int cell) const;
};

/// Makes the meshes of all bodies.
ElasticSystem make_elastic_system(const std::vector<const CutCells*>& bodies, const std::vector<Material>& materials,
                                  const Scales& scales, double ghost_penalty);

/// Moves entries of a row (DoF, coefficient), in any order, from constrained nodes to their masters, without those that
/// are zero; sorted by DoF, each once.
void resolve_constraints(const ElasticSystem& system, std::vector<std::pair<int, double>>& entries);

/// Adds support terms to a body; support points lie in cut cells only. cell: of the body.
void add_support_terms(ElasticSystem& system, int body, const std::vector<SupportTerm>& terms);

/// Sets the rows of the contact groups, their constraints resolved; stiffnesses start at zero.
void set_group_rows(ElasticSystem& system, std::vector<GroupRow> rows);

/// Compresses group_rows after changes, with their constraints resolved. Stiffnesses start at zero.
void compress_group_rows(ElasticSystem& system);

/// Returns the present stiffness of each group.
std::vector<double> group_stiffness(const ElasticSystem& system);
/// Returns whether the stiffnesses have changed so much that a matrix factorised with the old ones is a bad
/// preconditioner.
bool changed_much(const std::vector<double>& before, const std::vector<double>& now);

/// Sets the stiffness of each group (Scales::stress * Scales::length).
void set_group_stiffness(ElasticSystem& system, const std::vector<double>& stiffness);

/// Sets the force of each group per gap of its coupled row (Scales::stress * Scales::length): all zero or empty leave
/// the matrix symmetric. Preconditioners and assembled matrices do not have it.
void set_group_coupling(ElasticSystem& system, const std::vector<double>& coupling);

}  // namespace cgcontact

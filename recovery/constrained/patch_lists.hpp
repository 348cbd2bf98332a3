/// Lists that the patches of a body are fitted to: their cells, the contact points in them, the auxiliary patch in the
/// other body, the edge of the contact zone. Found on the host by search in the grids; what follows are loops over
/// these lists.
#pragma once

#include "core/base/process/parallel.hpp"
#include "recovery/constrained/patch_context.hpp"

namespace cgcontact {

/// State of a contact pair in a patch.
enum class ContactMode : char {
  open,
  closed,
  edge,    ///< the zone ends there, and a term beside the polynomials follows how
  unclear  ///< the zone ends there, and nothing follows it
};

/// Contact points of one pair inside a patch.
struct PairState {
  int pair = -1, other_body = -1;
  double area = 0, closed_area = 0, unknown_area = 0;  ///< m^2; as of ContactFacet
  ContactMode mode = ContactMode::open;
  bool couples = false;                   ///< the pressure comes from both bodies' stress, not from the face
  bool is_closed(double fraction) const;  ///< RecoveryOptions::closed_fraction
  bool is_mixed() const { return closed_area > 0 && closed_area < area * (1 - 1e-12); }
};

/// Some patches of a body; entry i of every list is of patch i.
struct PatchLists {
  std::vector<int> node;
  std::vector<PatchPolynomial> polynomial;
  std::vector<Vec3> centre, auxiliary_centre;  ///< of the polynomials, grid coordinates of their body
  std::vector<double> unit, auxiliary_unit;    ///< of their coordinates, grid coordinates: the patch's largest cells
  FlatLists<int> cells, auxiliary_cells;       ///< ascending; no auxiliary ones: not asked for, or too few
  FlatLists<PairState> pairs;                  ///< ascending
  std::vector<int> coupled;                    ///< index among these of that with the auxiliary patch, or -1
  std::vector<int> edge;                       ///< index among the edges, or -1
  std::vector<EdgeTerms::Term> edges;
  std::vector<PatchKind> kind;
  std::vector<PatchStatus> status;
  std::vector<char> fitted;  ///< set by fit_constrained

  std::size_t size() const { return node.size(); }
  void append(const PatchLists& other);
  void clear();
  void raise(std::size_t i, PatchStatus least) { status[i] = std::max(status[i], least); }
  bool has_auxiliary(std::size_t i) const { return !auxiliary_cells[i].empty(); }
  /// Returns the pair and body that patch i, with an auxiliary patch, is coupled with.
  const PairState& other(std::size_t i) const { return pairs[i][coupled[i]]; }
};

/// Finds the cells that the polynomial of a node is fitted to, ascending: its patch, and its rings of cells around the
/// node.
void fit_cells(const RecoveryBody& body, int node, PatchPolynomial polynomial, std::vector<int>& cells);

/// Appends the patch of a node. Work space is kept by thread.
void add_patch(const PatchContext& context, int node, PatchPolynomial polynomial, PatchLists& lists);

/// Lists the patches of some nodes, made side by side; polynomial_of(node): of each. chunks: work space.
template <class PolynomialOf>
void list_patches(const PatchContext& context, const int* nodes, std::size_t count, const PolynomialOf& polynomial_of,
                  std::vector<PatchLists>& chunks, PatchLists& lists) {
  const std::size_t num = num_chunks(count, grain_of_heavy);
  if (chunks.size() < num) chunks.resize(num);
  parallel_chunks("cgcontact::patch_lists::list", count, grain_of_heavy,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    chunks[chunk].clear();
                    for (std::size_t i = begin; i < end; ++i)
                      add_patch(context, nodes[i], polynomial_of(nodes[i]), chunks[chunk]);
                  });
  lists.clear();
  for (std::size_t chunk = 0; chunk < num; ++chunk) lists.append(chunks[chunk]);
}

}  // namespace cgcontact

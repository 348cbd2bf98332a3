#include "kernels/assembled/muelu.hpp"

#include <MueLu_CreateTpetraPreconditioner.hpp>
#include <algorithm>

namespace cgcontact {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;

/// Node positions in global axes, units of Scales::length.
RCP<TpetraVector> node_positions(const ElasticSystem& system, const RCP<const TpetraMap>& map) {
  auto x = rcp(new TpetraVector(system.dofs.node_map(map->getComm()), 3));
  auto view = x->getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (const BodyMesh* level : system.level_meshes()) {
    const BodyMesh& mesh = *level;
    const Grid& grid = mesh.cut_cells->grid;
    for (int n = 0; n < mesh.num_nodes; ++n) {
      const Vec3 position = grid.to_global(Vec3(mesh.nodes[n][0], mesh.nodes[n][1], mesh.nodes[n][2])) / mesh.length;
      for (int i = 0; i < 3; ++i) view(mesh.first_node + n, i) = position[i];
    }
  }
  return x;
}

/// Six rigid-body modes of the assembly, components in each body's grid axes.
RCP<TpetraVector> rigid_body_modes(const ElasticSystem& system, const RCP<const TpetraMap>& map,
                                   const TpetraVector& positions) {
  auto modes = rcp(new TpetraVector(map, 6));
  auto view = modes->getLocalViewHost(Tpetra::Access::OverwriteAll);
  const auto x = positions.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto position = [&](int n) { return Vec3(x(n, 0), x(n, 1), x(n, 2)); };
  Vec3 centre = Vec3::Zero();
  for (int n = 0; n < system.num_nodes; ++n) centre += position(n) / system.num_nodes;
  for (const BodyMesh* level : system.level_meshes()) {
    const BodyMesh& mesh = *level;
    const Mat3 to_local = mesh.cut_cells->grid.rotation.transpose();
    for (int n = mesh.first_node; n < mesh.first_node + mesh.num_nodes; ++n)
      for (int m = 0; m < 3; ++m) {
        const Vec3 e = Vec3::Unit(m);
        const Vec3 translation = to_local * e, rotation = to_local * e.cross(position(n) - centre);
        for (int i = 0; i < 3; ++i) {
          view(dof_of(n, i), m) = translation[i];
          view(dof_of(n, i), 3 + m) = rotation[i];
        }
      }
  }
  return modes;
}

}  // namespace

int factorised_unknowns(const ElasticSystem& system) {
  const bool in_a_plane = std::all_of(system.meshes.begin(), system.meshes.end(),
                                      [](const BodyMesh& mesh) { return mesh.rigid || mesh.is_one_layer(); });
  return in_a_plane ? 100000 : 4000;
}

RCP<TpetraOperator> make_muelu(const ElasticSystem& system, const RCP<const TpetraMap>& map,
                               const RCP<TpetraMatrix>& assembled) {
  const RCP<TpetraOperator> matrix = assembled;
  Teuchos::ParameterList list;
  list.set("verbosity", "none");
  list.set("number of equations", dofs_per_node);
  list.set("use kokkos refactor", false);
  list.set("problem: symmetric", true);
  list.set("coarse: max size", factorised_unknowns(system));
  // Chebyshev runs on SpMV, 2-3 times faster here than Gauss-Seidel sweeps; with MueLu's default of 10 power iterations
  // the preconditioner can become indefinite, 30 are safe.
  list.set("smoother: type", "CHEBYSHEV");
  Teuchos::ParameterList& smoother = list.sublist("smoother: params");
  smoother.set("chebyshev: degree", 3);
  smoother.set("chebyshev: ratio eigenvalue", 20.0);
  smoother.set("chebyshev: eigenvalue max iterations", 30);
  const RCP<TpetraVector> positions = node_positions(system, map);
  list.sublist("user data").set("Nullspace", rigid_body_modes(system, map, *positions));
  list.sublist("user data").set("Coordinates", positions);
  return MueLu::CreateTpetraPreconditioner<double>(matrix, list);
}

RCP<TpetraOperator> make_muelu(const ElasticSystem& system, const RCP<const TpetraMap>& map) {
  return make_muelu(system, map, assemble_matrix(system, map));
}

std::vector<int> muelu_levels(const TpetraOperator& muelu) {
  using Map = TpetraMap;
  using Operator = Xpetra::Operator<double, Map::local_ordinal_type, Map::global_ordinal_type, Map::node_type>;
  const auto hierarchy = dynamic_cast<const MueLu::TpetraOperator<double>&>(muelu).GetHierarchy();
  std::vector<int> unknowns;
  for (int l = 0; l < hierarchy->GetNumLevels(); ++l)
    unknowns.push_back(
        static_cast<int>(hierarchy->GetLevel(l)->Get<RCP<Operator>>("A")->getDomainMap()->getGlobalNumElements()));
  return unknowns;
}

}  // namespace cgcontact

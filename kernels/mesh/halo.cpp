#include "kernels/mesh/halo.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Distributor.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>

#include "core/base/ranks.hpp"
#include "kernels/mesh/dof_map.hpp"
#include "kernels/mesh/host_copy.hpp"

namespace cgcontact {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;
using Map = Tpetra::Map<>;
using Number = Map::global_ordinal_type;

RCP<const Map> map_of(const std::vector<Number>& numbers, const Halo::Comm& comm) {
  return rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                     Teuchos::ArrayView<const Number>(numbers.data(), static_cast<Teuchos_Ordinal>(numbers.size())), 0,
                     comm));
}

}  // namespace

Halo::Comm comm_of_this_rank() { return rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)); }

Halo::Halo(const Comm& comm, const std::vector<int>& numbers, const std::vector<int>& owners,
           const std::vector<Role>& roles, std::vector<char> needed)
    : needed_(std::move(needed)) {
  std::vector<int> owned, ghosts, others;
  std::vector<Number> owned_numbers, ghost_numbers;
  Teuchos::Array<int> ghost_owners;
  for (int n = 0; n < static_cast<int>(roles.size()); ++n) {
    if (roles[n] == Role::owned) {
      owned.push_back(n);
      owned_numbers.push_back(numbers[n]);
      continue;
    }
    if (roles[n] != Role::constrained) others.push_back(n);
    if (roles[n] != Role::ghost) continue;
    ghosts.push_back(n);
    ghost_numbers.push_back(numbers[n]);
    ghost_owners.push_back(owners[n]);
  }
  import_ = rcp(new Tpetra::Import<>(map_of(owned_numbers, comm), map_of(ghost_numbers, comm), ghost_owners));
  std::vector<int> sent, received;
  for (const int n : import_->getExportLIDs()) sent.push_back(owned[n]);
  for (const int n : import_->getRemoteLIDs()) received.push_back(ghosts[n]);
  owned_ = copy_to_view<IntView>("cgcontact::halo::owned", owned);
  ghosts_ = copy_to_view<IntView>("cgcontact::halo::ghosts", ghosts);
  others_ = copy_to_view<IntView>("cgcontact::halo::others", others);
  sent_ = copy_to_view<IntView>("cgcontact::halo::sent", sent);
  received_ = copy_to_view<IntView>("cgcontact::halo::received", received);
  out_ = decltype(out_)("cgcontact::halo::out", dof_offset(sent.size()));
  in_ = decltype(in_)("cgcontact::halo::in", dof_offset(received.size()));
  out_single_ = decltype(out_single_)("cgcontact::halo::out_single", dof_offset(sent.size()));
  in_single_ = decltype(in_single_)("cgcontact::halo::in_single", dof_offset(received.size()));
}

Halo::~Halo() = default;

template <class Real>
void Halo::exchange(Real* x, const Kokkos::View<Real*, MemSpace>& out, const Kokkos::View<Real*, MemSpace>& in) const {
  const ExecSpace exec;
  const IntView sent = sent_, received = received_;
  Kokkos::parallel_for(
      "cgcontact::halo::pack", Kokkos::RangePolicy<ExecSpace>(exec, 0, sent.extent(0)), KOKKOS_LAMBDA(const int n) {
        for (int i = 0; i < dofs_per_node; ++i) out(dof_offset(n, i)) = x[dof_offset(sent(n), i)];
      });
  exec.fence();
  work_of_rank().messages += num_messages();
  work_of_rank().sent_bytes += static_cast<double>(out.size() * sizeof(Real));
  using Constant = Kokkos::View<const Real*, MemSpace>;
  import_->getDistributor().doPostsAndWaits(Constant(out), dofs_per_node, in);
  Kokkos::parallel_for(
      "cgcontact::halo::unpack", Kokkos::RangePolicy<ExecSpace>(exec, 0, received.extent(0)),
      KOKKOS_LAMBDA(const int n) {
        for (int i = 0; i < dofs_per_node; ++i) x[dof_offset(received(n), i)] = in(dof_offset(n, i));
      });
}

void Halo::import_ghosts(double* x) const { exchange(x, out_, in_); }
void Halo::import_ghosts(float* x) const { exchange(x, out_single_, in_single_); }

void Halo::sum(double* values, std::size_t count) const {
  Kokkos::fence();
  sum_over_ranks(values, count);
}
void Halo::sum(float* values, std::size_t count) const {
  Kokkos::fence();
  sum_over_ranks(values, count);
}

void import_ghosts(const Halo& halo, double* x) { halo.import_ghosts(x); }
void import_ghosts(const Halo& halo, float* x) { halo.import_ghosts(x); }
const IntView& nodes_of_others(const Halo& halo) { return halo.others(); }

int Halo::num_messages() const { return static_cast<int>(import_->getDistributor().getNumSends()); }

}  // namespace cgcontact

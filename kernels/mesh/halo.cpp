#include "kernels/mesh/halo.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include "kernels/mesh/dof_map.hpp"
#include "kernels/mesh/host_copy.hpp"

namespace cgcontact {

Messages::Comm comm_of_this_rank() { return Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)); }

Halo::Halo(const Comm& comm, const std::vector<int>& numbers, const std::vector<int>& owners,
           const std::vector<Role>& roles, std::vector<char> needed)
    : comm_(comm), needed_(std::move(needed)) {
  std::vector<int> owned, ghosts, others, owned_numbers, ghost_numbers, ghost_owners;
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
  messages_ = Messages(comm, owned_numbers, ghost_numbers, ghost_owners);
  std::vector<int> sent, received;
  for (const int n : messages_.sent()) sent.push_back(owned[n]);
  for (const int n : messages_.received()) received.push_back(ghosts[n]);
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

template <class Real>
void Halo::exchange(Real* x, const Kokkos::View<Real*, MemSpace>& out, const Kokkos::View<Real*, MemSpace>& in) const {
  const ExecSpace exec;
  const IntView sent = sent_, received = received_;
  Kokkos::parallel_for(
      "cgcontact::halo::pack", Kokkos::RangePolicy<ExecSpace>(exec, 0, sent.extent(0)), KOKKOS_LAMBDA(const int n) {
        for (int i = 0; i < dofs_per_node; ++i) out(dof_offset(n, i)) = x[dof_offset(sent(n), i)];
      });
  exec.fence();
  messages_.exchange(out, dofs_per_node, in);
  Kokkos::parallel_for(
      "cgcontact::halo::unpack", Kokkos::RangePolicy<ExecSpace>(exec, 0, received.extent(0)),
      KOKKOS_LAMBDA(const int n) {
        for (int i = 0; i < dofs_per_node; ++i) x[dof_offset(received(n), i)] = in(dof_offset(n, i));
      });
}

void Halo::import_ghosts(double* x) const { exchange(x, out_, in_); }
void Halo::import_ghosts(float* x) const { exchange(x, out_single_, in_single_); }

void import_ghosts(const Halo& halo, double* x) { halo.import_ghosts(x); }
void import_ghosts(const Halo& halo, float* x) { halo.import_ghosts(x); }
const IntView& nodes_of_others(const Halo& halo) { return halo.others(); }

}  // namespace cgcontact

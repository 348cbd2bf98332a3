#include "kernels/mesh/messages.hpp"

#include <Tpetra_Distributor.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>

#include "core/base/process/ranks.hpp"

namespace cgcontact {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;
using Map = Tpetra::Map<>;
using Number = Map::global_ordinal_type;

RCP<const Map> map_of(const std::vector<int>& entries, const Messages::Comm& comm) {
  const std::vector<Number> numbers(entries.begin(), entries.end());
  return rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                     Teuchos::ArrayView<const Number>(numbers.data(), static_cast<Teuchos_Ordinal>(numbers.size())), 0,
                     comm));
}

}  // namespace

Messages::Messages(const Comm& comm, const std::vector<int>& own, const std::vector<int>& wanted,
                   const std::vector<int>& ranks_of_wanted) {
  Teuchos::Array<int> ranks(ranks_of_wanted.begin(), ranks_of_wanted.end());
  import_ = rcp(new Tpetra::Import<>(map_of(own, comm), map_of(wanted, comm), ranks));
}

std::vector<int> Messages::sent() const {
  const auto entries = import_->getExportLIDs();
  return {entries.begin(), entries.end()};
}

std::vector<int> Messages::received() const {
  const auto entries = import_->getRemoteLIDs();
  return {entries.begin(), entries.end()};
}

int Messages::num_messages() const { return static_cast<int>(import_->getDistributor().getNumSends()); }

template <class Real>
void Messages::exchange(const Kokkos::View<Real*, MemSpace>& out, int width,
                        const Kokkos::View<Real*, MemSpace>& in) const {
  work_of_rank().messages += num_messages();
  work_of_rank().sent_bytes += static_cast<double>(out.size() * sizeof(Real));
  using Constant = Kokkos::View<const Real*, MemSpace>;
  import_->getDistributor().doPostsAndWaits(Constant(out), width, in);
}

template void Messages::exchange(const Kokkos::View<float*, MemSpace>&, int,
                                 const Kokkos::View<float*, MemSpace>&) const;
template void Messages::exchange(const Kokkos::View<double*, MemSpace>&, int,
                                 const Kokkos::View<double*, MemSpace>&) const;

}  // namespace cgcontact

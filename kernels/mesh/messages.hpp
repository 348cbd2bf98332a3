/// Messages of a rank to its neighbours: entries of one rank of which others want the values, one message per
/// neighbour, planned once.
#pragma once

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>
#include <Tpetra_Import_fwd.hpp>
#include <vector>

#include "kernels/mesh/views.hpp"

namespace cgcontact {

class Messages {
 public:
  using Comm = Teuchos::RCP<const Teuchos::Comm<int>>;

  /// None at all.
  Messages() = default;
  /// Makes the plan from the numbers of this rank's entries, each of one rank only, those of the entries that it wants
  /// from others, each once, and their ranks. Collective; some rank wants an entry.
  Messages(const Comm& comm, const std::vector<int>& own, const std::vector<int>& wanted,
           const std::vector<int>& ranks_of_wanted);

  /// Return the entries in the order of the messages: indices into `own` and `wanted`.
  std::vector<int> sent() const;
  std::vector<int> received() const;
  /// Returns the number of messages that this rank sends each time.
  int num_messages() const;

  /// Sends `width` values per entry, in the order of sent(), and receives those of received(). Collective.
  template <class Real>
  void exchange(const Kokkos::View<Real*, MemSpace>& out, int width, const Kokkos::View<Real*, MemSpace>& in) const;

 private:
  Teuchos::RCP<const Tpetra::Import<>> import_;
};

}  // namespace cgcontact

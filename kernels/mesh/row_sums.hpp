/// Sums of rows (contact groups) of which several ranks have entries: each such rank has its part of the sum.
/// Neighbours exchange their parts, and each adds them up in the order of the ranks: the same bits everywhere.
#pragma once

#include <vector>

#include "kernels/mesh/messages.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact {

/// The part of a row that a rank has.
struct RowPart {
  int row, rank;
  int number;  ///< among the parts of all ranks
};

/// Returns the parts of all rows of which several ranks have entries, by row, then by rank. own: rows with entries of
/// this rank, each once. Collective.
std::vector<RowPart> parts_of_shared_rows(const std::vector<int>& own);

class RowSums {
 public:
  /// parts: of all shared rows, some; wanted: some of these rows, ascending. Collective.
  RowSums(const Messages::Comm& comm, const std::vector<RowPart>& parts, const std::vector<int>& wanted);

  /// Sets the values of the wanted rows to the sums of all parts; values: by row, those that this rank has a part of
  /// are its part. Collective.
  void sum(const ExecSpace& exec, double* values) const;
  void sum(const ExecSpace& exec, float* values) const;

 private:
  template <class Real>
  void exchange(const ExecSpace& exec, Real* values, const Kokkos::View<Real*, MemSpace>& out,
                const Kokkos::View<Real*, MemSpace>& in) const;

  Messages messages_;
  IntView sent_;            ///< rows in the order of the messages
  IntView wanted_, begin_;  ///< wanted rows; first part of each, and the end
  IntView source_;          ///< of each part: where it is received, -1: this rank's
  Kokkos::View<double*, MemSpace> out_, in_;
  Kokkos::View<float*, MemSpace> out_single_, in_single_;
};

}  // namespace cgcontact

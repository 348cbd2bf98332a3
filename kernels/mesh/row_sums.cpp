#include "kernels/mesh/row_sums.hpp"

#include <algorithm>

#include "core/base/process/ranks.hpp"
#include "kernels/mesh/host_copy.hpp"

namespace cgcontact {

std::vector<RowPart> parts_of_shared_rows(const std::vector<int>& own) {
  const std::vector<int> rows = gather(own), counts = gather(std::vector<int>{static_cast<int>(own.size())});
  std::vector<RowPart> parts, shared;
  for (int rank = 0; rank < static_cast<int>(counts.size()); ++rank)
    for (int k = 0; k < counts[rank]; ++k) {
      const int number = static_cast<int>(parts.size());
      parts.push_back({rows[number], rank, number});
    }
  std::stable_sort(parts.begin(), parts.end(), [](const RowPart& a, const RowPart& b) { return a.row < b.row; });
  for (auto first = parts.begin(), last = first; first != parts.end(); first = last) {
    while (last != parts.end() && last->row == first->row) ++last;
    if (last - first > 1) shared.insert(shared.end(), first, last);
  }
  return shared;
}

RowSums::RowSums(const Messages::Comm& comm, const std::vector<RowPart>& parts, const std::vector<int>& wanted) {
  std::vector<int> own_rows, own_numbers, begin{0}, received_part, numbers, ranks;
  std::vector<int> source;
  auto next = wanted.begin();
  for (const RowPart& part : parts) {
    const bool is_own = part.rank == this_rank();
    if (is_own) {
      own_rows.push_back(part.row);
      own_numbers.push_back(part.number);
    }
    while (next != wanted.end() && *next < part.row) {
      begin.push_back(static_cast<int>(source.size()));
      ++next;
    }
    if (next == wanted.end() || *next != part.row) continue;
    source.push_back(-1);
    if (is_own) continue;
    received_part.push_back(static_cast<int>(source.size()) - 1);
    numbers.push_back(part.number);
    ranks.push_back(part.rank);
  }
  begin.resize(wanted.size() + 1, static_cast<int>(source.size()));
  messages_ = Messages(comm, own_numbers, numbers, ranks);
  std::vector<int> sent;
  for (const int entry : messages_.sent()) sent.push_back(own_rows[entry]);
  const std::vector<int> received = messages_.received();
  for (std::size_t k = 0; k < received.size(); ++k) source[received_part[received[k]]] = static_cast<int>(k);
  sent_ = copy_to_view<IntView>("cgcontact::row_sums::sent", sent);
  wanted_ = copy_to_view<IntView>("cgcontact::row_sums::wanted", wanted);
  begin_ = copy_to_view<IntView>("cgcontact::row_sums::begin", begin);
  source_ = copy_to_view<IntView>("cgcontact::row_sums::source", source);
  out_ = decltype(out_)("cgcontact::row_sums::out", sent.size());
  in_ = decltype(in_)("cgcontact::row_sums::in", received.size());
  out_single_ = decltype(out_single_)("cgcontact::row_sums::out_single", sent.size());
  in_single_ = decltype(in_single_)("cgcontact::row_sums::in_single", received.size());
}

template <class Real>
void RowSums::exchange(const ExecSpace& exec, Real* values, const Kokkos::View<Real*, MemSpace>& out,
                       const Kokkos::View<Real*, MemSpace>& in) const {
  const IntView sent = sent_, wanted = wanted_, begin = begin_, source = source_;
  Kokkos::parallel_for(
      "cgcontact::row_sums::pack", Kokkos::RangePolicy<ExecSpace>(exec, 0, sent.extent(0)),
      KOKKOS_LAMBDA(const int k) { out(k) = values[sent(k)]; });
  exec.fence();
  messages_.exchange(out, 1, in);
  Kokkos::parallel_for(
      "cgcontact::row_sums::sum", Kokkos::RangePolicy<ExecSpace>(exec, 0, wanted.extent(0)),
      KOKKOS_LAMBDA(const int w) {
        Real sum = 0;
        for (int p = begin(w); p < begin(w + 1); ++p) sum += source(p) < 0 ? values[wanted(w)] : in(source(p));
        values[wanted(w)] = sum;
      });
}

void RowSums::sum(const ExecSpace& exec, double* values) const { exchange(exec, values, out_, in_); }
void RowSums::sum(const ExecSpace& exec, float* values) const { exchange(exec, values, out_single_, in_single_); }

}  // namespace cgcontact

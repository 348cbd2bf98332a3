/// Processes ("ranks", MPI) that share one run. Without mpirun, and before and after MPI runs, there is one. Every
/// function that exchanges is collective, in the same order on all ranks.
///
/// Every rank has what is small beside the volume (scene, surfaces, contact); computing it is shared in ranges, which
/// are then exchanged (share_out, put_together). Only ranks.cpp sees MPI itself; Tpetra's maps know it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace cgcontact {

int num_ranks();
int this_rank();
/// Returns whether this rank prints and writes.
inline bool is_first_rank() { return this_rank() == 0; }
/// Returns the number of ranks and this one as mpirun's environment states them, before MPI runs. 1 and 0 without
/// mpirun.
std::pair<int, int> ranks_of_mpirun();

/// Takes over the number of ranks from MPI, which runs; gives it back at the end of its life, before MPI ends.
class RankScope {
 public:
  RankScope();
  ~RankScope();
  RankScope(const RankScope&) = delete;
  RankScope& operator=(const RankScope&) = delete;
};

/// Work of this rank: on the finest grid that was divided last its own unknowns, those that it sees of others and the
/// cut cells that it computes; what it has sent to neighbours (Messages) and summed over all ranks since RankScope
/// began.
struct RankWork {
  double unknowns = 0, ghosts = 0, cut_cells = 0;
  double messages = 0, sent_bytes = 0, reductions = 0, reduced_bytes = 0;
};
RankWork& work_of_rank();

/// Sums over all ranks, in place; the same bits on every rank.
void sum_over_ranks(double* values, std::size_t count);
double largest_over_ranks(double value);
/// Returns the first rank's value.
double of_first_rank(double value);

/// Error of another rank, which reports it.
struct OtherRankFailed : std::runtime_error {
  OtherRankFailed() : std::runtime_error("another rank failed") {}
};
/// Does something on the first rank only; its exceptions are those of all ranks (OtherRankFailed on the others).
void on_first_rank(const std::function<void()>& what);
/// Runs `what` on every rank; an InputError of one of them is thrown on all.
void on_all_ranks(const std::function<void()>& what);
/// Returns the first rank's text.
std::string text_of_first_rank(const std::string& own);
/// Returns the number of ranks on this machine. Collective.
int ranks_on_this_machine();

/// Bytes of all ranks in turn.
std::vector<char> gather_bytes(const void* own, std::size_t size);

/// Gathers the entries of all ranks in turn.
template <class T>
std::vector<T> gather(const std::vector<T>& own) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (num_ranks() == 1) return own;
  const std::vector<char> bytes = gather_bytes(own.data(), own.size() * sizeof(T));
  std::vector<T> all(bytes.size() / sizeof(T));
  const T* from = reinterpret_cast<const T*>(bytes.data());
  std::copy(from, from + all.size(), all.begin());
  return all;
}

/// Returns the range of n items that a rank computes.
std::pair<std::size_t, std::size_t> share_out(std::size_t n);

/// Exchanges `all` (n items of `size` bytes), of which every rank has its own range by share_out.
void put_together(void* all, std::size_t n, std::size_t size);

template <class T>
void put_together(std::vector<T>& all) {
  static_assert(std::is_trivially_copyable_v<T>);
  put_together(all.data(), all.size(), sizeof(T));
}

/// Exchanges chunks of `grain` items that were shared out.
void put_chunks_together(std::vector<double>& all, std::size_t grain);

/// Returns whether all ranks have an exception, as this one (within a few seconds). Then it is the same, one of them
/// reports it, and all end as usual. Else the others wait in vain.
bool failed_on_all_ranks();
/// Ends all ranks at once.
[[noreturn]] void abort_all_ranks(int exit_code);

}  // namespace cgcontact

#include "core/base/process/ranks.hpp"

#ifndef CGCONTACT_CORE_ONLY
#include <mpi.h>
#endif

#include <algorithm>
#include <chrono>
#include <climits>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <thread>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

int ranks = 1, own_rank = 0;

int number_in(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

}  // namespace

RankWork& work_of_rank() {
  static RankWork work;
  return work;
}

int num_ranks() { return ranks; }
int this_rank() { return own_rank; }

/// Open MPI, MPICH and its relatives (Hydra), Slurm's srun.
std::pair<int, int> ranks_of_mpirun() {
  for (const auto& [size, rank] :
       {std::pair{"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"}, std::pair{"PMI_SIZE", "PMI_RANK"}})
    if (std::getenv(size)) return {number_in(size, 1), number_in(rank, 0)};
  if (std::getenv("PMIX_RANK")) return {number_in("SLURM_NTASKS", 1), number_in("PMIX_RANK", 0)};
  return {1, 0};
}

std::string text_of_first_rank(const std::string& own) {
  const std::vector<char> all = gather_bytes(own.data(), is_first_rank() ? own.size() : 0);
  return {all.begin(), all.end()};
}

void put_chunks_together(std::vector<double>& all, std::size_t grain) {
  if (ranks == 1) return;
  const std::size_t size = all.size();
  all.resize((size + grain - 1) / grain * grain);
  put_together(all.data(), all.size() / grain, grain * sizeof(double));
  all.resize(size);
}

void on_first_rank(const std::function<void()>& what) {
  std::exception_ptr error;
  if (is_first_rank()) try {
      what();
    } catch (...) {
      error = std::current_exception();
    }
  const bool failed = of_first_rank(error ? 1 : 0) != 0;
  if (error) std::rethrow_exception(error);
  if (failed) throw OtherRankFailed();
}

void on_all_ranks(const std::function<void()>& what) {
  if (ranks == 1) return what();
  std::string error;
  try {
    what();
  } catch (const InputError& failed) {
    error = failed.what();
  }
  const std::vector<char> all = gather_bytes(error.data(), error.size());
  if (!error.empty()) throw InputError(error);
  if (!all.empty()) throw InputError(std::string(all.begin(), all.end()));
}

std::pair<std::size_t, std::size_t> share_out(std::size_t n) {
  const auto size = static_cast<std::size_t>(ranks), own = static_cast<std::size_t>(own_rank);
  return {n * own / size, n * (own + 1) / size};
}

#ifdef CGCONTACT_CORE_ONLY

RankScope::RankScope() = default;
RankScope::~RankScope() = default;
void sum_over_ranks(double*, std::size_t) {}
double largest_over_ranks(double value) { return value; }
double of_first_rank(double value) { return value; }
int ranks_on_this_machine() { return 1; }
std::vector<char> gather_bytes(const void* own, std::size_t size) {
  const char* bytes = static_cast<const char*>(own);
  return {bytes, bytes + size};
}
void put_together(void*, std::size_t, std::size_t) {}
bool failed_on_all_ranks() { return true; }
void abort_all_ranks(int exit_code) { std::_Exit(exit_code); }

#else

namespace {

/// For the end of a run that failed: what others are waiting for goes on apart from it.
MPI_Comm failures = MPI_COMM_NULL;

/// Seconds that the ranks may be apart when all of them fail.
constexpr double patience = 5;

/// MPI counts in int: longer arrays go in chunks.
constexpr std::size_t max_count = INT_MAX / 2;

void reduce(double* values, std::size_t count, MPI_Op operation) {
  if (ranks == 1) return;
  work_of_rank().reductions += 1;
  work_of_rank().reduced_bytes += static_cast<double>(count * sizeof(double));
  for (std::size_t done = 0; done < count; done += max_count)
    MPI_Allreduce(MPI_IN_PLACE, values + done, static_cast<int>(std::min(max_count, count - done)), MPI_DOUBLE,
                  operation, MPI_COMM_WORLD);
}

/// All ranks know all sizes.
void gather_shares(const char* own, const std::vector<std::size_t>& sizes, char* all, bool in_place) {
  std::size_t total = 0;
  for (const std::size_t size : sizes) total += size;
  if (total > max_count) {  // rank after rank
    std::size_t begin = 0;
    for (int r = 0; r < ranks; ++r) {
      if (r == own_rank && !in_place) std::copy(own, own + sizes[r], all + begin);
      for (std::size_t done = 0; done < sizes[r]; done += max_count)
        MPI_Bcast(all + begin + done, static_cast<int>(std::min(max_count, sizes[r] - done)), MPI_BYTE, r,
                  MPI_COMM_WORLD);
      begin += sizes[r];
    }
    return;
  }
  std::vector<int> counts, begins;
  int begin = 0;
  for (const std::size_t size : sizes) {
    counts.push_back(static_cast<int>(size));
    begins.push_back(begin);
    begin += counts.back();
  }
  MPI_Allgatherv(in_place ? MPI_IN_PLACE : own, counts[own_rank], MPI_BYTE, all, counts.data(), begins.data(), MPI_BYTE,
                 MPI_COMM_WORLD);
}

}  // namespace

RankScope::RankScope() {
  int running = 0;
  MPI_Initialized(&running);
  if (!running) throw std::logic_error("ranks: MPI does not run");
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  MPI_Comm_rank(MPI_COMM_WORLD, &own_rank);
  if (ranks > 1) MPI_Comm_dup(MPI_COMM_WORLD, &failures);
}

RankScope::~RankScope() {
  if (failures != MPI_COMM_NULL) MPI_Comm_free(&failures);
  ranks = 1;
  own_rank = 0;
}

void sum_over_ranks(double* values, std::size_t count) { reduce(values, count, MPI_SUM); }

double largest_over_ranks(double value) {
  reduce(&value, 1, MPI_MAX);
  return value;
}

double of_first_rank(double value) {
  if (ranks > 1) MPI_Bcast(&value, 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  return value;
}

int ranks_on_this_machine() {
  MPI_Comm machine;
  int here = 1;
  if (ranks == 1) return 1;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &here);
  MPI_Comm_free(&machine);
  return here;
}

std::vector<char> gather_bytes(const void* own, std::size_t size) {
  const char* bytes = static_cast<const char*>(own);
  if (ranks == 1) return {bytes, bytes + size};
  std::vector<unsigned long long> sizes(ranks);
  const unsigned long long own_size = size;
  MPI_Allgather(&own_size, 1, MPI_UNSIGNED_LONG_LONG, sizes.data(), 1, MPI_UNSIGNED_LONG_LONG, MPI_COMM_WORLD);
  std::size_t total = 0;
  for (const unsigned long long s : sizes) total += s;
  std::vector<char> all(total);
  gather_shares(bytes, {sizes.begin(), sizes.end()}, all.data(), false);
  return all;
}

void put_together(void* all, std::size_t n, std::size_t size) {
  if (ranks == 1) return;
  std::vector<std::size_t> sizes(ranks);
  for (int r = 0; r < ranks; ++r)
    sizes[r] = (n * (static_cast<std::size_t>(r) + 1) / ranks - n * static_cast<std::size_t>(r) / ranks) * size;
  gather_shares(nullptr, sizes, static_cast<char*>(all), true);
}

bool failed_on_all_ranks() {
  if (ranks == 1) return true;
  MPI_Request request;
  MPI_Ibarrier(failures, &request);
  const auto start = std::chrono::steady_clock::now();
  for (int all = 0;;) {
    MPI_Test(&request, &all, MPI_STATUS_IGNORE);
    if (all) return true;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > patience) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void abort_all_ranks(int exit_code) {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

#endif

}  // namespace cgcontact

#include "core/base/process/resources.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>
#include <vector>

#include "core/base/process/control_groups.hpp"

namespace cgcontact {
namespace {

using CpuSet = std::vector<cpu_set_t>;
std::size_t bytes(const CpuSet& set) { return set.size() * sizeof(cpu_set_t); }

/// Returns the CPUs that the calling thread may run on; empty if the system does not say.
CpuSet cpus_of_thread() {
  // The kernel refuses sets that are smaller than its own.
  for (std::size_t size = 1; size <= 64; size *= 2) {
    CpuSet set(size);
    if (sched_getaffinity(0, bytes(set), set.data()) == 0) return set;
  }
  return {};
}

/// Returns the CPUs of this process; empty if the system does not say. OpenMP may have bound the first thread to a CPU
/// of its own before main: the process may use those of all threads.
CpuSet usable_cpus() {
#ifdef _OPENMP
  if (const int places = omp_get_num_places(); places > 0) {
    std::vector<int> cpus;
    for (int p = 0; p < places; ++p) {
      std::vector<int> of_place(omp_get_place_num_procs(p));
      omp_get_place_proc_ids(p, of_place.data());
      cpus.insert(cpus.end(), of_place.begin(), of_place.end());
    }
    if (!cpus.empty()) {
      CpuSet set(*std::max_element(cpus.begin(), cpus.end()) / CPU_SETSIZE + 1);
      CPU_ZERO_S(bytes(set), set.data());
      for (const int cpu : cpus) CPU_SET_S(cpu, bytes(set), set.data());
      return set;
    }
  }
#endif
  return cpus_of_thread();
}

int threads_by_affinity() {
  const CpuSet set = usable_cpus();
  const int count = set.empty() ? std::thread::hardware_concurrency() : CPU_COUNT_S(bytes(set), set.data());
  return std::max(1, count);
}

/// CPUs that one group allows, 0: no limit or no such group.
double quota_of_group(const std::string& directory, bool version_2) {
  double quota = 0, period = 0;
  if (version_2) {
    std::ifstream(directory + "/cpu.max") >> quota >> period;  // "max 100000": no number, no limit
  } else {
    std::ifstream(directory + "/cpu.cfs_quota_us") >> quota;  // -1: no limit
    std::ifstream(directory + "/cpu.cfs_period_us") >> period;
  }
  return quota > 0 && period > 0 ? quota / period : 0;
}

/// Sets a variable; true if that changes the environment.
bool set_environment(const char* name, const std::string& value) {
  const char* old = std::getenv(name);
  if (old && value == old) return false;
  setenv(name, value.c_str(), 1);
  return true;
}

bool set_if_absent(const char* name, const std::string& value) {
  return !std::getenv(name) && set_environment(name, value);
}

}  // namespace

long long peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024LL * usage.ru_maxrss;
}

double cpu_quota(const std::string& groups, const std::string& root) {
  double smallest = 0;
  each_control_group(groups, root, "cpu", [&](const std::string& directory, bool version_2) {
    const double quota = quota_of_group(directory, version_2);
    if (quota > 0 && (smallest == 0 || quota < smallest)) smallest = quota;
  });
  return smallest;
}

int available_threads() {
  const int threads = threads_by_affinity();
  const double quota = cpu_quota(own_control_groups(), "/sys/fs/cgroup");
  // Rounded down: threads wait for each other, and one that has used up its time holds up all.
  return quota > 0 ? std::min(threads, std::max(1, static_cast<int>(quota))) : threads;
}

void restart_with_openmp_settings(int threads, char** argv) {
  const int available = threads_by_affinity();
  if (threads <= 0 && std::getenv("OMP_NUM_THREADS")) {
    threads = std::atoi(std::getenv("OMP_NUM_THREADS"));
  } else if (threads <= 0) {
    threads = available_threads();
  }
  bool changed = threads > 0 && set_environment("OMP_NUM_THREADS", std::to_string(threads));
  // Threads on a share of the machine stay unbound: two such programs would be bound to the same CPUs.
  if (!std::getenv("GOMP_CPU_AFFINITY")) {
    changed |= set_if_absent("OMP_PROC_BIND", threads == available ? "spread" : "false");
    changed |= set_if_absent("OMP_PLACES", "threads");
  }
  changed |= set_if_absent("OPENBLAS_NUM_THREADS", "1");  // two runtimes whose threads wait busily share no CPUs
  // A heap for each thread: those that share one wait for each other (docs/setup.md).
  changed |= set_if_absent("MALLOC_ARENA_MAX", std::to_string(std::max(threads, 1)));
  changed |= set_if_absent("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1");  // fewer faults of new pages (docs/setup.md)
  if (!changed) return;
  undo_openmp_binding();
  execv("/proc/self/exe", argv);  // on failure: only the settings are missing
}

void undo_openmp_binding() {
  const CpuSet set = usable_cpus();
  if (!set.empty()) sched_setaffinity(0, bytes(set), set.data());
}

UnboundThread::UnboundThread() : before_(cpus_of_thread()) { undo_openmp_binding(); }

UnboundThread::~UnboundThread() {
  if (!before_.empty()) sched_setaffinity(0, bytes(before_), before_.data());
}

}  // namespace cgcontact

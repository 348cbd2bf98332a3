/// Resources that this process has used so far, and may use.
#pragma once

#include <sched.h>

#include <string>
#include <vector>

namespace cgcontact {

/// Returns the largest resident set, bytes.
long long peak_memory_bytes();

/// Returns the hardware threads that this process may run on: its CPU affinity, at most its control group's quota.
int available_threads();

/// Returns the CPUs that a control group and those above it allow (quota / period); 0: no limit. `groups` is the text
/// of /proc/self/cgroup, `root` the mount point of the hierarchies (/sys/fs/cgroup); versions 1 and 2.
double cpu_quota(const std::string& groups, const std::string& root);

/// Sets up the OpenMP runtime, which reads its settings before main: starts the program again, in the same process,
/// with OMP_NUM_THREADS as given and, unless set, OMP_PROC_BIND, OMP_PLACES, OPENBLAS_NUM_THREADS, MALLOC_ARENA_MAX and
/// GLIBC_TUNABLES. Returns if the environment is right already (so the second time), or if the system does not allow
/// it. threads = 0: OMP_NUM_THREADS if set, else available_threads().
void restart_with_openmp_settings(int threads, char** argv);

/// Gives this thread back all CPUs of the process: an OpenMP runtime that binds its threads has bound the calling one
/// before main, and programs started from here would inherit its single CPU.
void undo_openmp_binding();

/// Gives this thread all CPUs of the process as long as it lives: for programs that are started and go on beside the
/// threads, which OpenMP has bound to their CPUs.
class UnboundThread {
 public:
  UnboundThread();
  ~UnboundThread();
  UnboundThread(const UnboundThread&) = delete;
  UnboundThread& operator=(const UnboundThread&) = delete;

 private:
  std::vector<cpu_set_t> before_;  ///< empty if the system does not say
};

}  // namespace cgcontact

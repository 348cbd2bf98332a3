#include "core/base/process/child_work.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "core/base/errors/errors.hpp"
#include "core/base/process/memory.hpp"

namespace cgcontact {

namespace {

using Clock = std::chrono::steady_clock;

/// End of the work, the first byte that the child writes.
enum class Ended : char { well, refused, out_of_memory, threw };

/// Header before the bytes: distinguishes a child that ends early from one that has written all.
struct Header {
  Ended ended = Ended::threw;
  std::uint64_t size = 0;
};

constexpr int pipe_of_child = 3;

bool write_all(const void* from, std::size_t size) {
  const char* next = static_cast<const char*>(from);
  while (size > 0) {
    const ssize_t written = write(pipe_of_child, next, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    next += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

[[noreturn]] void tell(Ended ended, const char* bytes, std::size_t size) {
  const Header header{ended, size};
  _exit(write_all(&header, sizeof header) && write_all(bytes, size) ? 0 : 1);
}

void lower(int resource, double most) {
  rlimit limit{};
  getrlimit(resource, &limit);
  limit.rlim_cur = static_cast<rlim_t>(std::min(static_cast<double>(limit.rlim_cur), most));
  setrlimit(resource, &limit);
}

/// Nothing of the child reaches the user but what it packs: no core file, no words of a C library on its way down, no
/// handler of MPI or a sanitizer.
void become_child(pid_t parent, int pipe, const ChildLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  for (const int signal :
       {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGPROF, SIGPIPE, SIGXCPU})
    std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (pipe != pipe_of_child && dup2(pipe, pipe_of_child) < 0) _exit(1);
  close_range(pipe_of_child + 1, ~0U, 0);
  const int nowhere = open("/dev/null", O_RDWR);
  for (int descriptor = 0; descriptor < pipe_of_child; ++descriptor) dup2(nowhere, descriptor);
  lower(RLIMIT_CORE, 0);
  lower(RLIMIT_CPU, std::ceil(limits.cpu_seconds));
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  lower(RLIMIT_AS, pages * static_cast<double>(sysconf(_SC_PAGESIZE)) + limits.bytes);
}

[[noreturn]] void run_child(const std::function<void(Packing&)>& work) {
  std::string told;
  Ended ended = Ended::threw;
  try {
    Packing packing;
    work(packing);
    tell(Ended::well, packing.bytes().data(), packing.bytes().size());
  } catch (const InputError& error) {
    ended = Ended::refused;
    told = error.what();
  } catch (const std::bad_alloc&) {
    ended = Ended::out_of_memory;
  } catch (const std::exception& error) {
    told = error.what();
  } catch (...) {
    told = "an unknown exception";
  }
  tell(ended, told.data(), told.size());
}

/// Reads to the end of the pipe; false: the time is up.
bool read_until(Clock::time_point end, int pipe, std::vector<char>& bytes) {
  for (std::vector<char> chunk(1 << 16);;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd wait{pipe, POLLIN, 0};
    const int ready = left > 0 ? poll(&wait, 1, static_cast<int>(std::min<long long>(left, 1 << 30))) : 0;
    if (ready == 0) return false;
    if (ready < 0) {
      if (errno == EINTR) continue;
      return true;
    }
    const ssize_t count = read(pipe, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    bytes.insert(bytes.end(), chunk.data(), chunk.data() + count);
  }
}

}  // namespace

std::vector<char> in_child(const std::string& failure, const ChildLimits& limits,
                           const std::function<void(Packing&)>& work) {
  const auto fail = [&](const std::string& why) { throw InputError(failure + ": " + why); };
  int pipe[2];
  if (pipe2(pipe, O_CLOEXEC) != 0) fail(fmt::format("no pipe: {}", std::strerror(errno)));
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(std::min(limits.seconds, 1e8)));
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    become_child(parent, pipe[1], limits);
    run_child(work);
  }
  const int error = errno;
  close(pipe[1]);
  if (child < 0) {
    close(pipe[0]);
    fail(fmt::format("no process can be started: {}", std::strerror(error)));
  }
  std::vector<char> bytes;
  const bool in_time = read_until(end, pipe[0], bytes);
  close(pipe[0]);
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  pid_t ended = 0;
  while ((ended = waitpid(child, &status, 0)) < 0 && errno == EINTR) {
  }
  if (!in_time)
    fail(fmt::format("it has not come to an end within {:.0f} s (the file may be damaged)", limits.seconds));
  Header header;
  if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  if (bytes.size() < sizeof header || header.size != bytes.size() - sizeof header) {
    if (ended == child && WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
      fail(fmt::format("it has not come to an end within {:.0f} s of computing (the file may be damaged)",
                       std::ceil(limits.cpu_seconds)));
    if (ended == child && WIFSIGNALED(status))
      fail(fmt::format("it ends in SIG{} (the file may be damaged)", sigabbrev_np(WTERMSIG(status))));
    fail("it ends without a result (the file may be damaged)");
  }
  bytes.erase(bytes.begin(), bytes.begin() + sizeof header);
  if (header.ended == Ended::well) return bytes;
  const std::string told(bytes.begin(), bytes.end());
  if (header.ended == Ended::refused) throw InputError(told);
  fail(header.ended == Ended::out_of_memory
           ? fmt::format("it needs more than {} of memory (the file may be damaged)", memory_text(limits.bytes))
           : told);
  return {};
}

}  // namespace cgcontact

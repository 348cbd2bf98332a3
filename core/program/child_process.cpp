#include "core/program/child_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

namespace cgcontact {

namespace {

constexpr timespec time_to_end{5, 0};  ///< between asking the child to end and ending it

/// The rest of a forked child: becomes the program, or writes the error number to the pipe. Async-signal-safe calls
/// only.
[[noreturn]] void become(const char* program, char* const* arguments, const char* log, const sigset_t& signals,
                         pid_t parent, int pipe) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);
  const int input = open("/dev/null", O_RDONLY | O_CLOEXEC);
  const int output = open(log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (input >= 0 && output >= 0 && dup2(input, 0) >= 0 && dup2(output, 1) >= 0 && dup2(output, 2) >= 0) {
    sigprocmask(SIG_SETMASK, &signals, nullptr);
    execv(program, arguments);
  }
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(pipe, &error, sizeof error);
  _exit(127);
}

}  // namespace

ChildRunner::ChildRunner() {
  sigemptyset(&waited_for_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler != SIG_IGN) sigaddset(&waited_for_, signal);
  }
  std::signal(SIGCHLD, SIG_DFL);
  sigaddset(&waited_for_, SIGCHLD);
  pthread_sigmask(SIG_BLOCK, &waited_for_, &original_);
}

ChildRunner::~ChildRunner() {
  stop_signal();  // what has been waiting was meant for the child
  pthread_sigmask(SIG_SETMASK, &original_, nullptr);
}

int ChildRunner::stop_signal() {
  const timespec at_once{0, 0};
  for (int signal; (signal = sigtimedwait(&waited_for_, nullptr, &at_once)) > 0;)
    if (signal != SIGCHLD) stop_signal_ = signal;
  return stop_signal_;
}

/// Status of the child that has ended; passes on the user's wish to stop.
int ChildRunner::wait(pid_t child) {
  bool asked = false;
  for (int status = 0;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) return 0x7f00;  // cannot happen: exit code 127
    const int signal = asked ? sigtimedwait(&waited_for_, nullptr, &time_to_end) : sigwaitinfo(&waited_for_, nullptr);
    if (signal == SIGCHLD || (signal < 0 && errno == EINTR)) continue;
    if (signal > 0) stop_signal_ = signal;
    kill(child, asked ? SIGKILL : SIGTERM);
    asked = true;
  }
}

ChildOutcome ChildRunner::run(const std::string& program, const std::vector<std::string>& arguments,
                              const std::string& log) {
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ChildOutcome outcome;
  int pipe[2];
  if (pipe2(pipe, O_CLOEXEC) != 0) {
    outcome.error = errno;
    return outcome;
  }
  const auto start = std::chrono::steady_clock::now();
  const pid_t parent = getpid(), child = fork();
  if (child == 0) become(program.c_str(), words.data(), log.c_str(), original_, parent, pipe[1]);
  if (child < 0) outcome.error = errno;
  close(pipe[1]);
  if (child > 0) {
    int error = 0;
    if (read(pipe[0], &error, sizeof error) == sizeof error) outcome.error = error;
    const int status = wait(child);
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
    if (outcome.signal == SIGINT && stop_signal_ == 0) stop_signal_ = SIGINT;  // a terminal signals all of us
  }
  close(pipe[0]);
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

}  // namespace cgcontact

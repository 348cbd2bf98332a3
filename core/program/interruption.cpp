#include "core/program/interruption.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <stdexcept>

#include "core/base/process/ranks.hpp"

namespace cgcontact {

namespace {

constexpr int signals[] = {SIGINT, SIGTERM, SIGHUP};

/// Recursive: a clean-up may be made within an uninterrupted step.
std::recursive_mutex mutex;
std::list<std::function<void()>> actions;
std::string interruption_note;
int pipe_ends[2] = {-1, -1};
volatile std::sig_atomic_t asked = 0;

/// Async-signal-safe: the thread at the other end of the pipe does the work.
void on_signal(int signal) {
  if (asked) _exit(128 + signal);
  asked = 1;
  const int saved = errno;
  const auto number = static_cast<unsigned char>(signal);
  [[maybe_unused]] const ssize_t written = write(pipe_ends[1], &number, 1);
  errno = saved;
}

/// Waits for a signal or for the end of the pipe.
void watch() {
  unsigned char signal = 0;
  ssize_t count = 0;
  while ((count = read(pipe_ends[0], &signal, 1)) < 0 && errno == EINTR) {
  }
  if (count != 1) return;
  mutex.lock();  // for good: nobody else begins anything now
  for (auto action = actions.rbegin(); action != actions.rend(); ++action) (*action)();
  if (is_first_rank())
    std::fprintf(stderr, "cgcontact: stopped by SIG%s%s\n", sigabbrev_np(signal),
                 interruption_note.empty() ? "" : (": " + interruption_note).c_str());
  _exit(128 + signal);
}

}  // namespace

InterruptionWatch::InterruptionWatch() {
  if (pipe2(pipe_ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  thread_ = std::thread(watch);
  for (const int signal : signals) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigfillset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
  }
}

InterruptionWatch::~InterruptionWatch() {
  for (const int signal : signals) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == on_signal) std::signal(signal, SIG_DFL);
  }
  close(pipe_ends[1]);
  thread_.join();  // if it is at work, that is the end
  close(pipe_ends[0]);
}

CleanUp::CleanUp(std::function<void()> action) {
  const std::lock_guard lock(mutex);
  registered_ = actions.insert(actions.end(), std::move(action));
}

CleanUp::~CleanUp() {
  const std::lock_guard lock(mutex);
  actions.erase(registered_);
}

void uninterrupted(const std::function<void()>& step) {
  const std::lock_guard lock(mutex);
  step();
}

void set_interruption_note(const std::string& text) {
  const std::lock_guard lock(mutex);
  interruption_note = text;
}

}  // namespace cgcontact

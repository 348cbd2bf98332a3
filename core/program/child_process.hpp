/// Runs other programs one at a time; the user may stop them.
#pragma once

#include <csignal>
#include <string>
#include <vector>

namespace cgcontact {

struct ChildOutcome {
  int exit_code = -1;  ///< if it ended by itself
  int signal = 0;      ///< that ended it, or 0
  int error = 0;       ///< error number if it could not be started, or 0
  double wall_s = 0;
};

/// While it lives, SIGINT, SIGTERM and SIGHUP (unless ignored) end the running child instead of this program and are
/// remembered. Make it before any thread.
class ChildRunner {
 public:
  ChildRunner();
  ~ChildRunner();
  ChildRunner(const ChildRunner&) = delete;
  ChildRunner& operator=(const ChildRunner&) = delete;

  /// Waits for the end of the program. Its output and error go to the file `log`, its input is empty; it ends with this
  /// program.
  ChildOutcome run(const std::string& program, const std::vector<std::string>& arguments, const std::string& log);

  /// Returns the signal by which the user asked to stop, or 0.
  int stop_signal();

 private:
  int wait(pid_t child);

  sigset_t waited_for_, original_;
  int stop_signal_ = 0;
};

}  // namespace cgcontact

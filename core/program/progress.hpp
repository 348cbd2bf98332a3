/// Progress of a running program: one updating line on a terminal, plain log lines elsewhere.
#pragma once

#include <chrono>
#include <condition_variable>
#include <iosfwd>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace cgcontact {

/// Phases are timed in any mode. On a terminal nothing appears in the first second; then a thread rewrites the line
/// several times a second, so that its clock runs.
class Progress {
 public:
  enum class Mode { automatic, terminal_only, terminal, log, warnings, silent };

  /// Writes to standard error; automatic: terminal if standard error is one, else log (terminal_only: else silent).
  explicit Progress(Mode mode = Mode::automatic);
  Progress(Mode mode, std::ostream& stream);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Ends the phase that was running and begins the next one.
  void begin_phase(const std::string& name);
  /// Shows the state of the outer (contact) iteration.
  void outer_iteration(int iteration, long long active_points, double residual);
  /// Prints a line that stays.
  void message(const std::string& text);
  /// Prints the same, marked as a warning; also where only warnings are shown.
  void warning(const std::string& text);
  /// Ends the last phase and clears the updating line.
  void finish();
  /// Clears the updating line and says nothing from now on; for another thread that ends the program.
  void abandon();

  /// Seconds of each phase, in order of first appearance; a phase that ran several times is summed.
  const std::vector<std::pair<std::string, double>>& times_s() const { return times_s_; }

 private:
  using Clock = std::chrono::steady_clock;

  // With the lock held.
  void end_phase();
  void show(const std::string& text);
  void update_line();
  void clear_line();
  void keep_updating();
  void stop_updating();

  Mode mode_;
  std::ostream& stream_;
  Clock::time_point start_, phase_start_;
  std::string phase_, outer_;
  std::string line_;  ///< the updating line as it stands
  std::vector<std::pair<std::string, double>> times_s_;
  std::mutex mutex_;
  std::condition_variable stop_;
  bool stopped_ = false;
  std::thread updates_;  ///< on a terminal only
};

}  // namespace cgcontact

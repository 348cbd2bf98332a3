/// The user stops the program (SIGINT, SIGTERM, SIGHUP): it cleans up and ends with one message and exit code 128 +
/// number of the signal.
#pragma once

#include <functional>
#include <list>
#include <string>
#include <thread>

namespace cgcontact {

/// While it lives, signals that are not ignored run all clean-ups (the latest first) on its own thread, while the
/// others go on, and end the program. A second signal ends it at once. There can be one.
class InterruptionWatch {
 public:
  InterruptionWatch();
  ~InterruptionWatch();
  InterruptionWatch(const InterruptionWatch&) = delete;
  InterruptionWatch& operator=(const InterruptionWatch&) = delete;

 private:
  std::thread thread_;
};

/// Clean-up at an interruption, which must not throw, while this object lives. Once clean-ups have begun, a thread that
/// makes or destroys one waits for the end of the program.
class CleanUp {
 public:
  explicit CleanUp(std::function<void()> action);
  ~CleanUp();
  CleanUp(const CleanUp&) = delete;
  CleanUp& operator=(const CleanUp&) = delete;

 private:
  std::list<std::function<void()>>::iterator registered_;
};

/// Runs a step that is done wholly or not at all: an interruption waits for its end, or comes before it.
void uninterrupted(const std::function<void()>& step);

/// Sets what the message of an interruption says after "stopped by SIGINT"; for use within uninterrupted().
void set_interruption_note(const std::string& note);

}  // namespace cgcontact

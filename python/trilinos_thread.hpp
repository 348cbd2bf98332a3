/// Thread of Trilinos. OpenMP's threads belong to the thread that called them, and Kokkos 3 refuses all others; so all
/// requests of Python threads run here in turn.
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace cgcontact {

/// Starts Trilinos (0 threads: the backend's default) and stops it at the end of its life. None of its functions may be
/// called with Python's lock held.
class TrilinosThread {
 public:
  explicit TrilinosThread(int threads);
  ~TrilinosThread();  ///< where it lives only: elsewhere nobody would end its waiting
  TrilinosThread(const TrilinosThread&) = delete;
  TrilinosThread& operator=(const TrilinosThread&) = delete;

  /// False in a process that was forked off after the start: the thread did not come along.
  bool lives_here() const;

  /// Runs the task on the thread of Trilinos, and waits. Throws what the task throws, and what kept Trilinos from
  /// starting. Where it does not live the task runs on the calling thread, or std::runtime_error is thrown if Trilinos
  /// has threads.
  void run(const std::function<void()>& task);

  /// Runs the question on the thread that waits for the task at work, and waits; called by that task. Meanwhile the
  /// question's own tasks may run. Throws what the question throws.
  void ask(const std::function<void()>& question);

 private:
  using Lock = std::unique_lock<std::mutex>;

  /// Task, and what it asks. Changed under the lock.
  struct Call {
    const std::function<void()>* task;
    const std::function<void()>* question = nullptr;
    std::exception_ptr error = nullptr;  ///< of the task or the question, whichever ended last
    bool done = false;
  };

  void live(int threads);
  /// Runs tasks as they come, until ended() holds.
  void serve(Lock& lock, const std::function<bool()>& ended);

  const pid_t process_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Call*> waiting_;
  Call* at_work_ = nullptr;  ///< seen by the thread itself only
  bool ending_ = false;
  std::exception_ptr not_started_ = nullptr;
  std::thread thread_;  ///< last, as it reads the others
};

}  // namespace cgcontact

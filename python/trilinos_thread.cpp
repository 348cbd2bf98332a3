#include "python/trilinos_thread.hpp"

#include <unistd.h>

#include <optional>
#include <stdexcept>
#include <utility>

#include "kernels/solver/linear_solver.hpp"

namespace cgcontact {
namespace {

/// Calls it without the lock.
std::exception_ptr error_of(const std::function<void()>& function, std::unique_lock<std::mutex>& lock) {
  lock.unlock();
  std::exception_ptr error;
  try {
    function();
  } catch (...) {
    error = std::current_exception();
  }
  lock.lock();
  return error;
}

}  // namespace

TrilinosThread::TrilinosThread(int threads) : process_(getpid()), thread_([this, threads] { live(threads); }) {}

TrilinosThread::~TrilinosThread() {
  {
    const Lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool TrilinosThread::lives_here() const { return getpid() == process_; }

void TrilinosThread::live(int threads) {
  std::optional<TrilinosScope> trilinos;
  Lock lock(mutex_);
  not_started_ = error_of([&] { trilinos.emplace(threads); }, lock);
  serve(lock, [&] { return ending_; });
}

void TrilinosThread::serve(Lock& lock, const std::function<bool()>& ended) {
  while (true) {
    changed_.wait(lock, [&] { return ended() || !waiting_.empty(); });
    if (ended()) return;
    Call* const call = waiting_.front();
    waiting_.pop_front();
    Call* const before = std::exchange(at_work_, call);
    call->error = not_started_ ? not_started_ : error_of(*call->task, lock);
    call->done = true;
    at_work_ = before;
    changed_.notify_all();
  }
}

void TrilinosThread::run(const std::function<void()>& task) {
  if (!lives_here()) {
    if (TrilinosScope::has_openmp())
      throw std::runtime_error(
          "cgcontact had started when this process was forked off; its threads stayed behind (start processes with "
          "multiprocessing's method \"spawn\", or before the first scene)");
    return task();
  }
  Call call{&task};
  Lock lock(mutex_);
  waiting_.push_back(&call);
  changed_.notify_all();
  while (true) {
    changed_.wait(lock, [&] { return call.done || call.question; });
    if (call.done) break;
    call.error = error_of(*call.question, lock);
    call.question = nullptr;
    changed_.notify_all();
  }
  if (call.error) std::rethrow_exception(call.error);
}

void TrilinosThread::ask(const std::function<void()>& question) {
  if (!lives_here()) return question();
  Call& call = *at_work_;
  Lock lock(mutex_);
  call.question = &question;
  changed_.notify_all();
  serve(lock, [&] { return !call.question; });
  if (call.error) std::rethrow_exception(std::exchange(call.error, nullptr));
}

}  // namespace cgcontact

// Work in a child process: what it packs comes back, and however it ends it is an InputError here, with a message, in
// time.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "core/base/errors/errors.hpp"
#include "core/base/process/child_work.hpp"
#include "tests/support/input_errors.hpp"

namespace cgcontact::test_child_work {
namespace {

constexpr ChildLimits ample{300, 300, 4e9};
/// Not known to the optimizer, which may do with undefined behaviour what it likes.
volatile int zero = 0;

std::string failure_of(const ChildLimits& limits, const std::function<void(Packing&)>& work) {
  return message_of([&] { in_child("it fails", limits, work); });
}

// Proves that values arrive to the last bit, also more of them than a pipe holds, and that nothing else of the child
// does: what it changes is its own.
TEST(ChildWork, values_come_back) {
  int changed = 0;
  const std::vector<char> bytes = in_child("it fails", ample, [&](Packing& packing) {
    changed = 1;
    packing.put(0.1);
    packing.put(std::vector<int>(1000000, 7));
  });
  Unpacking unpacking(bytes);
  double value = 0;
  std::vector<int> values;
  unpacking.take(value);
  unpacking.take(values);
  EXPECT_EQ(value, 0.1);
  EXPECT_EQ(values, std::vector<int>(1000000, 7));
  EXPECT_EQ(changed, 0);
  EXPECT_TRUE(in_child("it fails", ample, [](Packing&) {}).empty());
}

// Proves that errors of the work are told as they are, and crashes, early ends and a lack of memory by what happened.
TEST(ChildWork, failures_are_input_errors) {
  EXPECT_EQ(failure_of(ample, [](Packing&) { throw InputError(std::string("part.step: bad")); }), "part.step: bad");
  EXPECT_EQ(failure_of(ample, [](Packing&) { throw std::runtime_error("why"); }), "it fails: why");
  EXPECT_EQ(failure_of(ample, [](Packing&) { throw 1; }), "it fails: an unknown exception");
  EXPECT_EQ(failure_of(ample, [](Packing&) { std::abort(); }),
            "it fails: it ends in SIGABRT (the file may be damaged)");
  EXPECT_EQ(failure_of(ample, [](Packing&) { std::raise(SIGSEGV); }),
            "it fails: it ends in SIGSEGV (the file may be damaged)");
  EXPECT_EQ(failure_of(ample, [](Packing&) { _exit(0); }),
            "it fails: it ends without a result (the file may be damaged)");
  if (std::getenv("ASAN_OPTIONS")) return;  // there a lack of memory is the end of the child
  const std::string message = failure_of({300, 300, 5e8}, [](Packing&) {
    std::vector<char> much(static_cast<std::size_t>(2000000000 + zero), 1);
    zero = much[static_cast<std::size_t>(zero)];
  });
  EXPECT_EQ(message, "it fails: it needs more than 500 MB of memory (the file may be damaged)");
}

// Proves that work without an end is ended, whether it computes or waits, here after a second (a minute is what a busy
// machine may need to notice).
TEST(ChildWork, time_is_limited) {
  const auto start = std::chrono::steady_clock::now();
  const auto compute = [](Packing&) {
    while (zero == 0) {
    }
  };
  EXPECT_EQ(failure_of({1, 300, 4e9}, compute),
            "it fails: it has not come to an end within 1 s (the file may be damaged)");
  EXPECT_EQ(failure_of({300, 1, 4e9}, compute),
            "it fails: it has not come to an end within 1 s of computing (the file may be damaged)");
  EXPECT_EQ(failure_of({1, 1, 4e9}, [](Packing&) { std::this_thread::sleep_for(std::chrono::minutes(10)); }),
            "it fails: it has not come to an end within 1 s (the file may be damaged)");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::minutes(2));
}

// Proves that no child stays behind, that ignored ends of children are no hindrance, and that threads may have children
// at the same time without waiting for those of others.
TEST(ChildWork, children_are_waited_for) {
  std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(in_child("it fails", ample, [](Packing& packing) { packing.put('a'); }), std::vector<char>{'a'});
  EXPECT_FALSE(failure_of(ample, [](Packing&) { std::abort(); }).empty());
  std::signal(SIGCHLD, SIG_DFL);
  std::vector<std::thread> threads;
  std::vector<std::string> found(4);
  for (int k = 0; k < 4; ++k)
    threads.emplace_back([&found, k] {
      const std::vector<char> bytes = in_child("it fails", ample, [k](Packing& packing) {
        packing.put(std::vector<char>(300000, static_cast<char>('a' + k)));
      });
      std::vector<char> text;
      Unpacking(bytes).take(text);
      found[k].assign(text.begin(), text.end());
    });
  for (std::thread& thread : threads) thread.join();
  for (int k = 0; k < 4; ++k) EXPECT_EQ(found[k], std::string(300000, static_cast<char>('a' + k)));
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
}

}  // namespace
}  // namespace cgcontact::test_child_work

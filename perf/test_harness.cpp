/// The frame of the benchmarks does its duty: right results pass, wrong ones and figures that are not finite make the
/// program fail. Argument: the case (right, wrong, undefined, infinite); exits with 0 if the frame did what it should.
#include <cstdio>
#include <limits>
#include <string>

#include "perf/harness.hpp"

namespace {

using namespace cgcontact::perf;

Kernel make(const std::string& name) {
  Kernel k;
  k.items = name == "infinite" ? std::numeric_limits<double>::infinity() : 1;
  k.cost = {1, 1};
  k.error = name == "wrong" ? 1e-3 : name == "undefined" ? std::numeric_limits<double>::quiet_NaN() : 1e-15;
  k.tolerance = 1e-12;
  k.against = "the truth";
  k.run = [] { benchmark::ClobberMemory(); };
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string name = argc > 1 ? argv[1] : "";
  std::string program = "test_harness", toy = "--toy";
  char* arguments[] = {program.data(), toy.data(), nullptr};
  const int code = run_benchmarks(2, arguments, [&] { add(name, [&](int) { return make(name); }, {{1}, {1}}); });
  std::printf("%s: exit code %d\n", name.c_str(), code);
  return code == (name == "right" ? 0 : 1) ? 0 : 1;
}

/// The machine itself: the two ceilings of the roofline as benchmarks of their own.
#include <memory>

#include "perf/harness.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

/// `size`: MB per vector. Cost: one multiply-add per entry; 32 bytes with write-allocate, 24 with streaming stores.
Kernel triad(int size, bool streaming) {
  auto vectors = std::make_shared<Triad>(static_cast<std::size_t>(size) * 1000000 / sizeof(double));
  vectors->run(streaming);
  Kernel k;
  k.unit = "B";
  k.items = vectors->bytes(streaming);
  k.cost = {vectors->flop(), vectors->bytes(streaming)};
  k.error = vectors->error(), k.tolerance = 0, k.against = "exact integers";
  k.run = [vectors, streaming] { vectors->run(streaming); };
  return k;
}

Kernel make_fma(int) {
  auto chains = std::make_shared<FmaChains>();
  chains->run();
  Kernel k;
  k.unit = "flop";
  k.items = chains->flop();
  k.cost = {chains->flop(), 0};
  k.error = chains->error(), k.tolerance = 0, k.against = "exact sums";
  k.run = [chains] { chains->run(); };
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("machine/triad", [](int size) { return triad(size, false); }, {{1}, {64}});
    if (Triad::has_streaming_stores())
      add("machine/triad_streaming", [](int size) { return triad(size, true); }, {{1}, {64}});
    add("machine/fma", make_fma, {{1}, {1}});
  });
}

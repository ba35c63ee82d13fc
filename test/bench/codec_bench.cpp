// What a window of ten keyframes with eighty observations each costs: payload, encoding, decoding.
#include <benchmark/benchmark.h>

#include "shared/wire/submap_codec.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

void encode_submap(benchmark::State& state) {
  const Submap submap = some_submap(10, 80);
  std::size_t bytes = 0;
  while (state.KeepRunning()) {
    const Bytes encoded = encode(submap);
    bytes = encoded.size();
    benchmark::DoNotOptimize(encoded.data());
  }
  state.counters["payload_bytes"] = static_cast<double>(bytes);
}
BENCHMARK(encode_submap)->Unit(benchmark::kMicrosecond);

void decode(benchmark::State& state) {
  const Bytes bytes = encode(some_submap(10, 80));
  while (state.KeepRunning()) benchmark::DoNotOptimize(decode_submap(bytes));
}
BENCHMARK(decode)->Name("decode_submap")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fleetloc

BENCHMARK_MAIN();

// What a sample costs: payload, encoding, decoding. The full encoding: a window of ten keyframes
// with eighty observations each; the compact one: so many keyframes with about as many; an answer
// with its corrections.
#include <benchmark/benchmark.h>

#include "shared/compact/answer_sample.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/unit/compact/moving_robot.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

template <typename Encode>
void run_encoding(benchmark::State& state, Encode encode_one) {
  std::size_t bytes = 0;
  while (state.KeepRunning()) {
    const Bytes encoded = encode_one();
    bytes = encoded.size();
    benchmark::DoNotOptimize(encoded.data());
  }
  state.counters["payload_bytes"] = static_cast<double>(bytes);
}

Submap compact_submap(const benchmark::State& state) {
  Submap submap = moving_robot(100, static_cast<int>(state.range(0)));
  for (SubmapKeyframe& keyframe : submap.keyframes) {
    if (keyframe.observations.size() > 80) keyframe.observations.resize(80);
  }
  return submap;
}

void encode_full(benchmark::State& state) {
  const Submap submap = some_submap(10, 80);
  run_encoding(state, [&] { return encode(submap); });
}
BENCHMARK(encode_full)->Unit(benchmark::kMicrosecond);

void decode_full(benchmark::State& state) {
  const Bytes bytes = encode(some_submap(10, 80));
  while (state.KeepRunning()) benchmark::DoNotOptimize(decode_submap(bytes));
}
BENCHMARK(decode_full)->Unit(benchmark::kMicrosecond);

void encode_compact(benchmark::State& state) {
  const Submap submap = compact_submap(state);
  run_encoding(state, [&] { return encode_compact(submap, {}, {}, some_stereo()); });
}
BENCHMARK(encode_compact)->Arg(3)->Arg(10)->Unit(benchmark::kMicrosecond);

void decode_compact(benchmark::State& state) {
  const Bytes bytes = encode_compact(compact_submap(state), {}, {}, some_stereo());
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(decode_submap(decode_submap_sample(bytes).value(), some_stereo()));
  }
}
BENCHMARK(decode_compact)->Arg(3)->Arg(10)->Unit(benchmark::kMicrosecond);

void encode_answer(benchmark::State& state) {
  const Answer answer{some_answer(), some_correction()};
  run_encoding(state, [&] { return encode(answer, 1200); });
}
BENCHMARK(encode_answer)->Unit(benchmark::kMicrosecond);

void decode_answer(benchmark::State& state) {
  const Bytes bytes = encode(Answer{some_answer(), some_correction()}, 1200);
  while (state.KeepRunning()) benchmark::DoNotOptimize(fleetloc::decode_answer(bytes));
}
BENCHMARK(decode_answer)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fleetloc

BENCHMARK_MAIN();

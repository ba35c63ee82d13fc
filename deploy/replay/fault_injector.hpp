#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "robot/dataset/dataset_reader.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

enum class FaultKind {
  kBlackImages,
  kSaturatedImages,
  kFrozenImages,  ///< the last pair before, repeated with new stamps
  kMissingLeft,
  kMissingRight,
  kDroppedFrames,
  kDoubledFrames,
  kDisorderedFrames,  ///< a frame arrives after its successor
  kImuGap,
  kDoubledImu,
  kDisorderedImu,  ///< a sample arrives after its successor
  kNonFiniteImu,
};

/// Its name in files, e.g. "black_images".
std::string_view name(FaultKind kind);

/// A fault from `start_s` on, in seconds since the first image of the recording.
struct Fault {
  FaultKind kind{};
  double start_s = 0.0;
  double duration_s = 0.0;
  double share = 1.0;  ///< of the measurements, drawn at random
};

struct FaultPlan {
  std::uint64_t seed = 1;
  std::vector<Fault> faults;
};

/// `seed`, and a list `faults` of {kind, start_s, duration_s}, to which dropped, doubled,
/// disordered and non-finite measurements add `share`.
FaultPlan read_fault_plan(ConfigReader config);

/// Plays a recording with the faults of a plan. Causal, and the same for one seed.
class FaultInjector {
 public:
  FaultInjector(DatasetReader reader, FaultPlan plan);

  /// As DatasetReader::next, but stamps may repeat and go back.
  std::optional<DatasetReader::Item> next();

  [[nodiscard]] const DatasetReader& reader() const { return reader_; }

  /// The reader's own, and by "injected_" and the name of the kind how many measurements were
  /// touched so far.
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const;

 private:
  bool occurs(std::size_t fault, Timestamp stamp);
  void take(CameraFrame frame);
  void take(const ImuSample& sample);
  void deliver(DatasetReader::Item item,
               std::optional<DatasetReader::Item>& held_back,
               bool twice,
               bool late);

  DatasetReader reader_;
  FaultPlan plan_;
  std::vector<std::mt19937_64> random_;    // of each fault, so that none disturbs another
  std::vector<std::uint64_t> injected_;    // by each fault
  std::optional<CameraFrame> last_frame_;  // before its successor came, as it was given out
  std::optional<DatasetReader::Item> late_frame_;
  std::optional<DatasetReader::Item> late_sample_;
  std::deque<DatasetReader::Item> ready_;
};

}  // namespace fleetloc

#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "robot/uplink/keyframe_history.hpp"
#include "shared/model/localization_result.hpp"

namespace fleetloc {

/// Which parts of which keyframes and edges the cloud has, as far as acknowledgements tell: for
/// each item the share that is probably missing there, in 0..1. A sample is known to be lost once a
/// later one is acknowledged and it is not; until then it arrives with the link's probability.
class DeliveryRecord {
 public:
  /// The cloud has nothing.
  void clear();

  /// @param subset  of the keyframes' observations
  void sent(SampleNumber number, const Submap& submap, ObservationSubset subset);
  void acknowledged(const Acknowledgements& acknowledgements);

  /// @param loss  of the link
  [[nodiscard]] double missing(const SubmapKeyframe& keyframe, double loss) const;
  [[nodiscard]] double missing(const VirtualEdge& edge, double loss) const;

  /// Items of earlier keyframes are of no interest any more.
  void forget_before(KeyframeId oldest);

 private:
  enum class Fate { kUnknown, kArrived, kLost };
  struct Sending {
    std::uint32_t number = 0;
    std::vector<LandmarkId> landmarks;  // observed, sorted
    ObservationSubset subset;
  };
  struct EdgeSending {
    std::uint32_t number = 0;
    bool is_final = false;
  };

  [[nodiscard]] double arrival_probability(std::uint32_t number, double loss) const;

  std::map<std::uint32_t, Fate> samples_;
  std::map<KeyframeId, std::vector<Sending>> keyframes_;
  std::map<EdgeKey, std::vector<EdgeSending>> edges_;
};

}  // namespace fleetloc

#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "shared/model/localization_result.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// What a robot's end of the protocol has sent of one stream to one localizer, as far as
/// acknowledgements that have reached it tell; kept apart from the code under test.
class StreamModel {
 public:
  void sent(const Submap& sample);
  void acknowledged(const Acknowledgements& acknowledgements);

  /// Never sent in this stream, or only in samples that are known to be lost.
  [[nodiscard]] bool is_missing(KeyframeId keyframe) const;
  /// The same, as far as the robot may think.
  [[nodiscard]] bool may_be_missing(KeyframeId keyframe) const;
  void forget_before(KeyframeId oldest);
  /// The localizer asks for the session. Whether the robot believes it is the robot's business.
  void lose_track();

 private:
  std::map<std::uint32_t, bool> lost_;  // of samples that are not known to be lost: false
  std::set<std::uint32_t> arrived_;
  std::map<KeyframeId, std::vector<std::uint32_t>> numbers_;
  std::set<KeyframeId> unsure_;
};

}  // namespace fleetloc

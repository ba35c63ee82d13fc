#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cloud/localizer/session_database.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// A session of a robot, as samples name it.
struct SessionKey {
  RobotId robot;
  SessionNumber session{};
  friend auto operator<=>(const SessionKey&, const SessionKey&) = default;
};

/// The model of what may be in a database: every sample that robots have sent, as decoded from its
/// own bytes. Answers of checks are violations as text, empty if there is none.
class SentRecord {
 public:
  /// A sample of the compact encoding; returned as decoded.
  const Submap& add(const Bytes& payload, const RectifiedStereo& stereo);

  /// Whether each keyframe, observation and edge is bit by bit what this session has sent to this
  /// incarnation of a localizer, and is there once.
  [[nodiscard]] std::string check_origin(const SessionDatabase& database,
                                         const SessionKey& session,
                                         Incarnation incarnation) const;

  /// Whether all of a sample is there that nothing newer replaces: what was acknowledged.
  [[nodiscard]] std::string check_stored(const SessionDatabase& database,
                                         const Submap& sample) const;

 private:
  /// Two localizers may get samples of one session beside each other, with the same numbers. In
  /// the model no two of them have the same incarnation.
  using StreamKey = std::pair<SessionKey, Incarnation>;
  struct Stream {
    std::map<std::uint32_t, Submap> samples;  // by number
    std::map<KeyframeId, std::vector<std::uint32_t>> numbers;
    std::uint64_t last_used = 0;
  };

  [[nodiscard]] std::string check_keyframe(const SubmapKeyframe& stored,
                                           const Stream& stream) const;
  void prune(Stream& stream);

  std::map<StreamKey, Stream> streams_;
  std::uint64_t samples_ = 0;
};

}  // namespace fleetloc

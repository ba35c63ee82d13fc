#pragma once

// Makes up for: participants of Fast DDS 2.9.1 that replace one another in a process get the GUID
// of their predecessor, and are taken for it by those who have not seen it leave.
// Delete when: nothing recreates participants any more (see participant_recreation_policy.hpp).

#include <cstdint>
#include <optional>
#include <set>

#include <fastdds/rtps/common/GuidPrefix_t.hpp>

namespace fleetloc {

/// Who a participant is to others, and which ports it takes.
struct ParticipantIdentity {
  std::int32_t id = 0;  ///< in this process; where its ports are looked for
  eprosima::fastrtps::rtps::GuidPrefix_t prefix;
};

/// For one that takes the place of a participant that is gone, and unknown to those who have
/// not noticed yet. By its GUID, and by its id as well: Fast DDS also tells others the GUID that it
/// would have given to the id, and they go on from what its last bearer had sent. The ids go round
/// in fours, since the ports of those beyond the first few are not looked for by unicast; nothing,
/// if all four are taken.
/// @param taken  by other participants of this process
std::optional<ParticipantIdentity> successor(const ParticipantIdentity& gone,
                                             const std::set<std::int32_t>& taken);

/// The id of a participant of this process, until this object is gone.
class TakenId {
 public:
  explicit TakenId(std::int32_t id);
  ~TakenId();
  TakenId(const TakenId&) = delete;
  TakenId& operator=(const TakenId&) = delete;
  [[nodiscard]] static std::set<std::int32_t> all();

 private:
  std::int32_t id_;
};

}  // namespace fleetloc

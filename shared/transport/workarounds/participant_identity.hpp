#pragma once

// Works around: participants of Fast DDS 2.9.1 that replace one another in a process get the GUID
// of their predecessor, and are taken for it by those who have not seen it leave.
// Delete when: nothing recreates participants any more (see participant_recreation_policy.hpp).

#include <cstdint>
#include <optional>
#include <set>

#include <fastdds/rtps/common/GuidPrefix_t.hpp>

namespace fleetloc {

/// Identity of a participant: its GUID prefix, and the id that determines its ports.
struct ParticipantIdentity {
  std::int32_t id = 0;  ///< in this process; determines its ports
  eprosima::fastrtps::rtps::GuidPrefix_t prefix;
};

/// For the successor of a participant, so that others do not take it for the one that is gone: a
/// new GUID, and a new id as well, because Fast DDS also announces the GUID that belongs to the id,
/// and others would continue the sequence numbers of its predecessor. Ids rotate among four, since
/// the ports of higher ones are not found by unicast; nothing if all four are taken.
/// @param taken  by other participants of this process
std::optional<ParticipantIdentity> successor(const ParticipantIdentity& gone,
                                             const std::set<std::int32_t>& taken);

/// Reserves the id of a participant of this process for its own lifetime.
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

#include "shared/transport/workarounds/participant_identity.hpp"

#include <mutex>

namespace fleetloc {
namespace {

struct TakenIds {
  std::mutex mutex;
  std::set<std::int32_t> ids;
};

TakenIds& taken_ids() {
  static TakenIds taken;
  return taken;
}

}  // namespace

std::optional<ParticipantIdentity> successor(const ParticipantIdentity& gone,
                                             const std::set<std::int32_t>& taken) {
  constexpr std::int32_t kRound = 4;
  ParticipantIdentity next = gone;
  for (std::int32_t step = 1; step < kRound; ++step) {
    next.id = gone.id / kRound * kRound + (gone.id + step) % kRound;
    if (taken.contains(next.id)) continue;
    // The last two bytes are zero in what Fast DDS makes: the upper half of the id.
    if (++next.prefix.value[10] == 0) ++next.prefix.value[11];
    return next;
  }
  return std::nullopt;
}

TakenId::TakenId(std::int32_t id) : id_(id) {
  const std::lock_guard lock(taken_ids().mutex);
  taken_ids().ids.insert(id_);
}

TakenId::~TakenId() {
  const std::lock_guard lock(taken_ids().mutex);
  taken_ids().ids.erase(id_);
}

std::set<std::int32_t> TakenId::all() {
  const std::lock_guard lock(taken_ids().mutex);
  return taken_ids().ids;
}

}  // namespace fleetloc

#include <chrono>

#include "shared/transport/wire_version.hpp"
#include "shared/transport/workarounds/announcement_repetition.hpp"
#include "shared/transport/workarounds/answered_heartbeats.hpp"
#include "shared/transport/workarounds/datagram_check.hpp"
#include "shared/transport/workarounds/gap_budget.hpp"
#include "shared/transport/workarounds/handshake_message.hpp"
#include "shared/transport/workarounds/initial_ack_pacing.hpp"
#include "shared/transport/workarounds/known_senders.hpp"
#include "shared/transport/workarounds/repeated_datagram.hpp"
#include "shared/transport/workarounds/statistics_removal.hpp"
#include "test/fuzz/target.hpp"

namespace fleetloc {
namespace {

constexpr std::uint32_t kAddress = 0x0a000001;

/// All that reads a datagram once it is known to be well-formed. Of two that are alike, the second
/// one comes from a participant that is known.
void read_well_formed(RtpsBytes datagram) {
  const KnownSenders::Time begin{};
  GapBudget gaps;
  KnownSenders senders;
  senders.watch({GuidPrefix{}});
  WireVersionWatch versions;
  AnsweredHeartbeats heartbeats;
  InitialAckPacing initial_acks;
  for (const auto time : {begin, begin + std::chrono::seconds(1)}) {
    gaps.passes(datagram, time);
    static_cast<void>(senders.check(datagram, kAddress, time));
    versions.observe(datagram);
    heartbeats.observe(datagram);
    static_cast<void>(initial_acks.passes(datagram, time));
  }
  versions.take_events();
  announces_robot(datagram);
  RepeatedDatagram::read(datagram);
  RepeatedDatagram::read_encrypted(datagram);
  static_cast<void>(is_handshake_for_another(datagram));
  require(check_rtps(without_statistics(datagram)).has_value() || !check_rtps(datagram),
          "statistics may be left out");
}

}  // namespace
}  // namespace fleetloc

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const bool is_ours = check_rtps({data, size}).has_value();
  const bool is_any = check_rtps({data, size}, {.allows_extensions = true}).has_value();
  require(is_any || !is_ours, "what is taken of ours is taken of all");
  if (is_any) read_well_formed({data, size});
  return 0;
}

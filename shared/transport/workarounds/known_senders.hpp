#pragma once

// Works around: Fast DDS 2.9.1 believes the GUID that a datagram names, wherever it comes from.
// Delete when: the library binds a participant to where it sends from.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "shared/core/expected.hpp"
#include "shared/transport/workarounds/datagram_check.hpp"
#include "shared/transport/workarounds/newcomer_budget.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"
#include "shared/transport/workarounds/sequence_bounds.hpp"
#include "shared/transport/workarounds/spoken_of.hpp"

namespace fleetloc {

/// Participants that have announced themselves, and where they send from: the address that the
/// first datagram of each came from, and those that it announces. Nobody else speaks in its name,
/// unless it is silent for long; nobody but a discovery server speaks of others; nobody numbers
/// samples as no writer can; and not too many are new.
///
/// It is no proof of identity: it does not know who shares an address, or forges one.
///
/// No clock, no I/O. Any thread may use any function.
class KnownSenders {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Those that may speak of others: the discovery servers.
  void watch(const std::set<GuidPrefix>& servers);

  /// @param datagram  well-formed, see check_rtps()
  /// @param address   that it came from, IPv4, as in locator_of()
  /// @return kForeignGuid, kTooManySenders or kFarAhead if it is to be dropped
  expected<void, RtpsDefect> check(RtpsBytes datagram, std::uint32_t address, Time now);

  /// Where a participant sends from.
  [[nodiscard]] std::optional<std::uint32_t> address_of(const GuidPrefix& participant) const;

  [[nodiscard]] std::size_t participants() const;
  static constexpr std::size_t kMaxParticipants = 8192;
  static constexpr std::chrono::seconds kSilence{35};

 private:
  struct Participant {
    std::set<std::uint32_t> announced;
    std::optional<std::uint32_t> source;  // none: a server has told of it
    Time heard{};
    SequenceBounds sequences;

    [[nodiscard]] bool may_send_from(std::uint32_t address, Time now) const;
  };

  expected<void, RtpsDefect> check_sender(const GuidPrefix& prefix,
                                          std::uint32_t address,
                                          Time now);
  expected<void, RtpsDefect> check_data(const RtpsSubmessage& data,
                                        const GuidPrefix& from,
                                        std::uint32_t address,
                                        Time now);
  bool add(const GuidPrefix& prefix, std::uint32_t address, Time now);
  [[nodiscard]] bool passes_numbers(const RtpsSubmessage& submessage,
                                    const GuidPrefix& from,
                                    Time now);

  mutable std::mutex mutex_;  // guards what follows
  std::set<GuidPrefix> servers_;
  std::map<GuidPrefix, Participant> participants_;
  NewcomerBudget newcomers_;
};

}  // namespace fleetloc

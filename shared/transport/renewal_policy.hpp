#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "shared/transport/network_addresses.hpp"

namespace fleetloc {

/// Decides when a participant has to be made anew. It does not survive that an address which it
/// was made on goes, even if the same one comes back, and does not use one that comes. Where
/// nothing arrives for longer than its lease, though something has before, it is made anew as
/// well, for what cannot be seen from here; then again after twice as long, and so on.
///
/// Without any address, nothing is due: it would be in vain. No clock, no I/O.
class RenewalPolicy {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  /// @param lease  of the participant
  explicit RenewalPolicy(Clock::duration lease) : lease_(lease) {}

  /// A participant was made.
  /// @param addresses  at that time
  void made(const InterfaceAddresses& addresses, Time now);
  /// It could not be made.
  void failed(Time now);

  /// To be called regularly, and at each change.
  /// @param heard  datagrams so far
  void observe(const InterfaceAddresses& addresses, std::uint64_t heard, Time now);
  /// These addresses went; they may be back before anyone can see that they are missing.
  void lost(const InterfaceAddresses& addresses, Time now);

  /// Why it has to be made anew now, in words for a log.
  [[nodiscard]] std::optional<std::string> due(Time now) const;

  /// No address is left of those it was made on.
  [[nodiscard]] bool is_cut_off() const { return !made_on_.empty() && addresses_.empty(); }
  /// Something is due soon: observe() should be called at short intervals.
  [[nodiscard]] bool is_unsettled() const { return changed_ && !addresses_.empty(); }

 private:
  Clock::duration lease_;
  InterfaceAddresses made_on_;
  InterfaceAddresses addresses_;  // as last seen
  bool changed_ = false;          // since it was made, be it only for a while
  Time changed_at_;
  Time tried_at_;
  int failures_ = 0;
  std::uint64_t heard_ = 0;
  std::optional<Time> heard_at_;  // if ever
  int silent_renewals_ = 0;       // since something was heard
};

}  // namespace fleetloc

#pragma once

// Works around: a participant of Fast DDS 2.9.1 does not survive the removal of an address that it
// was created on, even if it returns, and does not use a new one.
// Delete when: a participant follows the addresses of its interfaces (`update_interfaces` or the
// like) without being recreated.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "shared/transport/workarounds/network_addresses.hpp"
#include "shared/transport/workarounds/peer_lookup.hpp"

namespace fleetloc {

/// Roaming and reconnecting: decides when a participant must be recreated. That is when an address
/// that it was created on is removed, even if it returns, or a new one appears; when nothing
/// arrives for longer than its lease, though something has before (then again after twice as long,
/// and so on); and when its discovery server was restarted, see ServerRestartDetector. After a
/// recreation it is given at least the time of two announcements: others may learn of it only by
/// theirs.
///
/// The addresses of named peers are resolved from time to time; a new one makes it due, too.
///
/// Without any address nothing is due. No clock, no I/O.
class ParticipantRecreationPolicy {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  /// Of the participant, see its QoS.
  struct Timing {
    Clock::duration lease;
    Clock::duration announcements;  ///< from one to the next
  };
  explicit ParticipantRecreationPolicy(const Timing& timing)
      : timing_(timing), patience_(timing.lease) {}

  /// What a participant was created with.
  struct Basis {
    InterfaceAddresses addresses;
    ResolvedPeers peers;
  };
  void made(const Basis& basis, Time now);
  /// It could not be created.
  void failed(Time now);

  /// To be called regularly, and at each change.
  /// @param heard  messages received so far
  void observe(const InterfaceAddresses& addresses, std::uint64_t heard, Time now);
  /// These addresses were removed, perhaps for less than the interval of observe().
  void lost(const InterfaceAddresses& addresses, Time now);

  /// A discovery server was restarted: it does not know the participant.
  void server_restarted() { server_restarted_ = true; }

  /// Result of a lookup of the named peers.
  void found(const ResolvedPeers& peers, Time now);
  /// A lookup is due. It counts as begun: the next one is due later.
  [[nodiscard]] bool wants_lookup(Time now);
  /// As last found.
  [[nodiscard]] const ResolvedPeers& peers() const { return peers_; }

  /// Why it must be recreated now, as text for a log.
  [[nodiscard]] std::optional<std::string> due(Time now) const;

  /// No address is left of those that it was created on.
  [[nodiscard]] bool is_cut_off() const { return !basis_.addresses.empty() && addresses_.empty(); }
  /// Something is due soon: observe() should be called at short intervals.
  [[nodiscard]] bool is_unsettled() const {
    return (changed_ || peers_changed_) && !addresses_.empty();
  }

 private:
  Timing timing_;
  Clock::duration patience_;  // until it is recreated without messages
  Basis basis_;
  InterfaceAddresses addresses_;  // as last seen
  ResolvedPeers peers_;           // as last found
  bool changed_ = false;          // of the addresses since it was created, even if reverted
  bool peers_changed_ = false;
  bool server_restarted_ = false;
  Time changed_at_;
  Time tried_at_;
  int failed_attempts_ = 0;
  std::uint64_t heard_ = 0;
  std::optional<Time> heard_at_;  // or when the first one was created
  std::optional<Time> looked_up_at_;
};

}  // namespace fleetloc

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
/// arrives for longer than one and a half leases, though somebody should be heard (then again after
/// twice as long, and so on); and when its discovery server was restarted, see
/// ServerRestartDetector. After a recreation for a change it is given the time of two
/// announcements, since others may learn of it only by theirs, and then recreated once more.
///
/// Whoever is there is heard every ten seconds: robots and localizers tell their status.
///
/// The addresses of named peers are resolved from time to time, the more often while nobody is
/// heard; a new one makes it due, too.
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
      : timing_(timing), patience_(longest_silence()) {}

  /// What a participant was created with.
  struct Basis {
    InterfaceAddresses addresses;
    ResolvedPeers peers;
  };
  void made(const Basis& basis, Time now);
  /// It could not be created.
  void failed(Time now);

  struct Observation {
    InterfaceAddresses addresses;
    std::uint64_t heard = 0;   ///< messages received so far
    bool is_expecting = true;  ///< silence means that something is wrong: somebody should be there
  };
  /// To be called regularly, and at each change.
  void observe(const Observation& seen, Time now);
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
  // Longer than whoever crashed is still taken to be there.
  [[nodiscard]] Clock::duration longest_silence() const { return 3 * timing_.lease / 2; }

  Timing timing_;
  Clock::duration patience_;  // until it is recreated without messages
  bool is_expecting_ = true;
  bool is_after_change_ = false;  // it was recreated for one, and nobody has been heard since
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

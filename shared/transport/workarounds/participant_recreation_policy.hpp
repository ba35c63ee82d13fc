#pragma once

// Makes up for: a participant of Fast DDS 2.9.1 does not survive that an address which it was made
// on goes, even if it returns, and does not use one that comes.
// Delete when: a participant follows the addresses of its interfaces (`update_interfaces` or the
// like) without being made anew.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "shared/transport/workarounds/network_addresses.hpp"
#include "shared/transport/workarounds/peer_lookup.hpp"

namespace fleetloc {

/// Roaming and reconnecting: decides when a participant has to be made anew. It does not survive
/// that an address which it was made on goes, even if the same one comes back, and does not use one
/// that comes. Where nothing arrives for longer than its lease, though something has before, it is
/// made anew as well, for what cannot be seen from here; then again after twice as long, and so on.
/// After a change it is given the time of two announcements: the others may know of it only by
/// theirs. And it is made anew when its discovery server was started again, see
/// ServerRestartDetector.
///
/// The addresses of named peers are looked up from time to time; a new one makes it due, too.
///
/// Without any address, nothing is due: it would be in vain. No clock, no I/O.
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

  /// What a participant was made with.
  struct Basis {
    InterfaceAddresses addresses;
    FoundPeers peers;
  };
  void made(const Basis& basis, Time now);
  /// It could not be made.
  void failed(Time now);

  /// To be called regularly, and at each change.
  /// @param heard  messages so far
  void observe(const InterfaceAddresses& addresses, std::uint64_t heard, Time now);
  /// These addresses went; they may be back before anyone can see that they are missing.
  void lost(const InterfaceAddresses& addresses, Time now);

  /// A discovery server has no memory of the participant, nor understands it what that says.
  void server_restarted() { server_restarted_ = true; }

  /// What a lookup of the named peers has found.
  void found(const FoundPeers& peers, Time now);
  /// A lookup is due. It counts as begun: the next one is due later.
  [[nodiscard]] bool wants_lookup(Time now);
  /// As last found.
  [[nodiscard]] const FoundPeers& peers() const { return peers_; }

  /// Why it has to be made anew now, in words for a log.
  [[nodiscard]] std::optional<std::string> due(Time now) const;

  /// No address is left of those it was made on.
  [[nodiscard]] bool is_cut_off() const { return !basis_.addresses.empty() && addresses_.empty(); }
  /// Something is due soon: observe() should be called at short intervals.
  [[nodiscard]] bool is_unsettled() const {
    return (changed_ || peers_changed_) && !addresses_.empty();
  }

 private:
  Timing timing_;
  Clock::duration patience_;  // with silence
  Basis basis_;
  InterfaceAddresses addresses_;  // as last seen
  FoundPeers peers_;              // as last found
  bool changed_ = false;          // of the addresses since it was made, be it only for a while
  bool peers_changed_ = false;
  bool server_restarted_ = false;
  Time changed_at_;
  Time tried_at_;
  int failed_attempts_ = 0;
  std::uint64_t heard_ = 0;
  std::optional<Time> heard_at_;  // or when the first one was made
  std::optional<Time> looked_up_at_;
};

}  // namespace fleetloc

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "shared/core/time.hpp"
#include "shared/link/message_sender.hpp"

namespace fleetloc {

/// Which program speaks for an id: the one that said it first, for as long as it is heard. Another
/// one on the same computer may follow at once (a restart), one elsewhere only after silence. One
/// end of the network speaks for one id. Senders that the network does not tell apart are all
/// accepted.
///
/// Where there are no keys, who is first is believed, and who forges the datagrams of another
/// computer is not noticed here.
class SenderBinding {
 public:
  /// @param silence_s  of a program, then its id is free
  explicit SenderBinding(double silence_s) : silence_s_(silence_s) {}

  /// Whether it may speak for the id, which is bound to it from now on.
  bool accepts(const std::string& id, const MessageSender& sender, Timestamp now);

  /// The same for what is no reason to bind an id: one that nobody has is left to others.
  bool accepts_if_bound(const std::string& id, const MessageSender& sender, Timestamp now);

  [[nodiscard]] std::size_t ids() const { return bound_.size(); }
  static constexpr std::size_t kMaxIds = 10'000;

 private:
  struct Bound {
    MessageSender sender;
    Timestamp heard;
  };

  [[nodiscard]] bool is_free(const Bound& bound, const MessageSender& sender, Timestamp now) const;
  bool has_room(Timestamp now);

  double silence_s_;
  std::map<std::string, Bound> bound_;                              // by id
  std::map<std::array<std::uint8_t, 12>, std::string> spoken_for_;  // by participant
  Timestamp looked_for_room_{Timestamp::min()};
};

}  // namespace fleetloc

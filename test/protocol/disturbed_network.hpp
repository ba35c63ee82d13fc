#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "shared/link/channel.hpp"

namespace fleetloc {

/// What the network does to each message.
struct Disturbance {
  double loss = 0.0;
  double duplication = 0.0;
  double delay_s = 0.02;
  double jitter_s = 0.0;  ///< mean of an exponential extra delay: reorders
  bool drops_late =
      false;  ///< as Fast DDS does: of each sender and topic newer and newer ones only
};

/// The network between robots and localizers, in memory, with disturbances that change. A message
/// is one datagram. Receivers, reliable topics and late joiners are those of MemoryNetwork; its
/// best effort is worse, for it also delivers late and doubled messages. Time is the driver's: that
/// which the ends pass in is ignored, since robots' clocks may be wrong.
class DisturbedNetwork {
 public:
  explicit DisturbedNetwork(std::uint32_t seed) : random_(seed) {}

  std::unique_ptr<Channel> join(bool is_robot, const std::string& name);
  void disturb(const Disturbance& disturbance) { disturbance_ = disturbance; }
  void advance(Timestamp now);

  /// On its way beside the others, from nobody.
  void inject(bool to_robot, const std::string& receiver, Message message);

  [[nodiscard]] std::size_t under_way() const { return under_way_.size(); }

 private:
  class End;
  using MemberId = std::uint64_t;
  struct Delivery {
    MemberId sender, receiver;
    std::uint64_t number;
    Message message;
  };
  struct Member {
    bool is_robot = false;
    std::string name;
    std::vector<Message> inbox;
    std::map<std::pair<MemberId, Topic>, std::uint64_t> newest;
  };
  struct Last {  // sample of a reliable writer
    std::uint64_t number = 0;
    Message message;
    std::map<MemberId, Timestamp> attempts;  // the next one, of those it has not reached yet
  };
  using Writer = std::pair<MemberId, std::string>;

  void send(MemberId sender, const std::string& partition, Message message);
  void leave(MemberId id);
  [[nodiscard]] bool hears(const Member& receiver,
                           MemberId sender,
                           Topic topic,
                           const std::string& partition) const;
  void transfer(const Delivery& delivery);
  void deliver(Delivery delivery);
  double uniform() { return std::uniform_real_distribution<double>()(random_); }

  std::mt19937 random_;
  Disturbance disturbance_;
  Timestamp now_{};
  MemberId next_id_ = 1;
  std::uint64_t next_number_ = 1;
  std::map<MemberId, Member> members_;
  std::map<Writer, Last> last_;
  std::multimap<Timestamp, Delivery> under_way_;
};

}  // namespace fleetloc

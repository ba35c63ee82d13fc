#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "robot/cloud_client/cloud_client.hpp"
#include "test/hostile/small_pool.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {

/// The localizer cloud_1 over DDS, which is played by advance().
class PlayedLocalizer {
 public:
  explicit PlayedLocalizer(const DdsChannelConfig& end) : channel_(end) {}

  void advance(Timestamp now) {
    for (const Message& message : channel_.receive(now)) pool_->receive(message, now);
    pool_.run_jobs(now);
    for (const RobotId& robot : pool_->take_expected()) channel_.prepare(robot);
    for (auto& [receiver, message] : pool_->outgoing(now, 0.0)) {
      channel_.send(receiver, std::move(message), now);
    }
  }

  SmallPool& pool() { return pool_; }
  DdsChannel& channel() { return channel_; }

 private:
  DdsChannel channel_;
  SmallPool pool_;
};

/// A robot over DDS that sends 10 submaps a second.
class PlayedRobot {
 public:
  PlayedRobot(const DdsChannelConfig& end, Timestamp now) : channel_(end), robot_(end.name) {
    client_.start_session(session_for(robot_), now);
  }

  void advance(Timestamp now) {
    answers_ += client_.take_answers(now).size();
    if (sent_ != Timestamp{} && now - sent_ < std::chrono::milliseconds(100)) return;
    sent_ = now;
    client_.submit(submap_of(robot_, ++number_), now);
  }

  /// That were not there before.
  [[nodiscard]] std::uint64_t answers() const { return answers_; }
  CloudClient& client() { return client_; }
  DdsChannel& channel() { return channel_; }

 private:
  DdsChannel channel_;
  RobotId robot_;
  CloudClient client_{robot_,
                      channel_,
                      read_cloud_client_config(
                          ConfigReader::from_string(default_config("robot")).section("client"))};
  Timestamp sent_{};
  std::uint32_t number_ = 0;
  std::uint64_t answers_ = 0;
};

inline Timestamp time_of_test() {
  return Timestamp(
      std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
}

/// Plays until it is so; false if it does not become so.
inline bool plays_until(const std::function<bool()>& condition,
                        const std::function<void(Timestamp)>& advance) {
  return comes_true([&] {
    advance(time_of_test());
    return condition();
  });
}

}  // namespace fleetloc

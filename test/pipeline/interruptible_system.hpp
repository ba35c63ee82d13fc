#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/wire/status_codec.hpp"
#include "test/pipeline/simulated_system.hpp"

namespace fleetloc {

/// A channel that can be cut: then all messages are dropped.
class SeverableChannel final : public Channel {
 public:
  explicit SeverableChannel(std::unique_ptr<Channel> whole) : whole_(std::move(whole)) {}

  void send(const std::string& partition, Message message, Timestamp now) override {
    if (!is_cut) whole_->send(partition, std::move(message), now);
  }
  [[nodiscard]] std::vector<Message> receive(Timestamp now) override {
    auto messages = whole_->receive(now);
    if (is_cut) messages.clear();
    return messages;
  }
  [[nodiscard]] ChannelStatistics statistics() const override { return whole_->statistics(); }

  bool is_cut = false;

 private:
  std::unique_ptr<Channel> whole_;
};

/// A robot in simulated time, and localizers that start, stop and hang.
class InterruptibleSystem {
 public:
  InterruptibleSystem(const SimulatedRun& run,
                      const std::optional<Pose>& T_map_body_start,
                      const LinkConfig& link = perfect_link())
      : network_(link),
        robot_end_(network_.join_robot("robot")),
        robot_(run, robot_end_, T_map_body_start) {}

  /// @param config   YAML that differs from the defaults
  /// @param pyramid  of the map; null: no robot is searched for
  void start(const std::string& name,
             std::uint32_t incarnation,
             std::shared_ptr<const LaserMap> map,
             const std::string& config = "{}",
             std::shared_ptr<const MapPyramid> pyramid = nullptr) {
    ConfigReader reader = defaults();
    reader.overlay(ConfigReader::from_string(config));
    kill(name);
    Localizer& localizer = localizers_[name];
    localizer.incarnation = Incarnation{incarnation};
    localizer.map = map;
    localizer.end = network_.join_cloud(name);
    localizer.cloud =
        std::make_unique<SimulatedCloud>(LocalizerPool(name,
                                                       localizer.incarnation,
                                                       std::move(map),
                                                       read_localizer_pool_config(reader),
                                                       std::move(pyramid)),
                                         *localizer.end,
                                         std::chrono::milliseconds(50),
                                         nullptr);
  }
  /// As kill -9.
  void kill(const std::string& name) { localizers_.erase(name); }
  /// As SIGTERM: it ends once its robot has left.
  void stop(const std::string& name) { localizers_.at(name).is_told_to_stop = true; }
  [[nodiscard]] bool runs(const std::string& name) const { return localizers_.contains(name); }
  /// From now on it sends its status, but no answers.
  void hang(const std::string& name) { localizers_.at(name).hangs = true; }
  void cut(bool is_cut) { robot_end_.is_cut = is_cut; }

  /// Plays everything up to `seconds`.
  void play(double seconds) {
    robot_.play(seconds, [this](Timestamp now) {
      for (auto& [name, localizer] : localizers_) advance(name, localizer, now);
      std::erase_if(localizers_, [now](const auto& item) { return is_over(item.second, now); });
    });
  }

  [[nodiscard]] const SimulatedRobot& robot() const { return robot_; }
  [[nodiscard]] const LocalizerPool& pool(const std::string& name) const {
    return localizers_.at(name).cloud->pool();
  }

 private:
  struct Localizer {
    Incarnation incarnation{};
    std::shared_ptr<const LaserMap> map;
    std::unique_ptr<Channel> end;
    std::unique_ptr<SimulatedCloud> cloud;
    bool hangs = false;
    bool is_told_to_stop = false;
    std::optional<Timestamp> draining_since;
    Timestamp next_status;
  };

  static bool is_over(const Localizer& localizer, Timestamp now) {
    constexpr std::chrono::milliseconds kGoodbye{300};
    return localizer.draining_since && now - *localizer.draining_since > kGoodbye &&
           localizer.cloud->is_drained(now);
  }

  static void advance(const std::string& name, Localizer& localizer, Timestamp now) {
    if (localizer.is_told_to_stop && !localizer.draining_since) {
      localizer.cloud->drain(now);
      localizer.draining_since = now;
    }
    if (!localizer.hangs) return localizer.cloud->advance(now);
    static_cast<void>(localizer.end->receive(now));
    if (now < localizer.next_status) return;
    localizer.next_status = now + std::chrono::seconds(1);
    const LocalizerStatus status{.localizer = name,
                                 .incarnation = localizer.incarnation,
                                 .map_hash = localizer.map->info().hash,
                                 .accepting = true};
    localizer.end->send("", {Topic::kLocalizerStatus, encode(status)}, now);
  }

  MemoryNetwork network_;
  SeverableChannel robot_end_;
  std::map<std::string, Localizer> localizers_;
  SimulatedRobot robot_;  // last: it uses its end of the network
};

}  // namespace fleetloc

#include "shared/link/link_model.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "shared/core/uniform.hpp"

namespace fleetloc {
namespace {

constexpr double kLargestDelaySeconds = 3600.0;
constexpr double kLargestRateBytesPerSecond = 1e12;
constexpr int kMinQueueBytes = 1500;  // one datagram of Ethernet
constexpr int kLargestQueueBytes = 1 << 30;

// Reads the directions of a link, and names them in its errors.
class DirectionReader {
 public:
  DirectionReader(ConfigReader config, std::string name)
      : config_(std::move(config)), name_(std::move(name)) {}

  LinkDirection read() {
    LinkDirection direction;
    direction.loss = number("loss", 1.0);
    direction.delay_s = number("delay_s", kLargestDelaySeconds);
    direction.rate_bytes_per_s = number("rate_bytes_per_s", kLargestRateBytesPerSecond);
    const bool limited = direction.rate_bytes_per_s > 0.0;
    if (limited && direction.rate_bytes_per_s < 1.0) {
      throw ConfigError(name_ + ".rate_bytes_per_s: must be 0 (unlimited) or at least 1");
    }
    const int min_queue = limited ? kMinQueueBytes : 0;
    direction.queue_bytes =
        static_cast<std::size_t>(config_.integer("queue_bytes", min_queue, kLargestQueueBytes));
    return direction;
  }

 private:
  double number(const std::string& key, double max) {
    const auto value = config_.get<double>(key);
    const bool valid = value >= 0.0 && value <= max;  // false for NaN
    if (valid) return value;
    throw ConfigError(name_ + "." + key + ": must be in 0.." + std::to_string(max));
  }

  ConfigReader config_;
  std::string name_;
};

}  // namespace

LinkConfig read_link_config(ConfigReader config) {
  LinkConfig link;
  link.seed = config.get<std::uint64_t>("seed");
  link.uplink = DirectionReader(config.section("uplink"), "uplink").read();
  link.downlink = DirectionReader(config.section("downlink"), "downlink").read();
  config.expect_fully_read();
  return link;
}

LinkConfig perfect_link() {
  return {};
}

LinkModel::LinkModel(const LinkDirection& direction, std::uint64_t seed)
    : direction_(direction), random_(seed) {}

std::optional<Timestamp> LinkModel::arrival(Timestamp now, std::size_t wire_bytes) {
  const bool lost = uniform(random_) < direction_.loss;  // drawn for each, whatever the queue does
  Timestamp sent = now;
  if (direction_.rate_bytes_per_s > 0.0) {
    const double rate = direction_.rate_bytes_per_s;
    const auto bytes = static_cast<double>(wire_bytes);
    const Timestamp start = std::max(now, bottleneck_free_);
    const double waiting = to_seconds(start - now) * rate;
    if (waiting + bytes > static_cast<double>(direction_.queue_bytes)) return std::nullopt;
    sent = start + from_seconds(bytes / rate);
    bottleneck_free_ = sent;
  }
  if (lost) return std::nullopt;
  return sent + from_seconds(direction_.delay_s);
}

}  // namespace fleetloc

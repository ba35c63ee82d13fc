#pragma once

#include <optional>

#include "shared/core/time.hpp"

namespace fleetloc {

class ConfigReader;

/// When to repeat the latest small message until a newer one exists: the more the network loses,
/// the more often.
class RetransmissionTimer {
 public:
  struct Config {
    double max_interval_s{};  ///< without loss
    double min_interval_s{};  ///< at `full_rate_loss` and above
    double full_rate_loss{};  ///< share of lost datagrams
  };
  explicit RetransmissionTimer(const Config& config) : config_(config) {}

  /// A new message was sent; repetitions start from here.
  void sent(Timestamp now) { last_ = now; }

  /// True if it is to be sent again now. Counts it as sent.
  bool due(Timestamp now, double loss);

 private:
  Config config_;
  std::optional<Timestamp> last_;
};

RetransmissionTimer::Config read_retransmission_timer_config(ConfigReader config);

}  // namespace fleetloc

#pragma once

#include <optional>

#include "shared/core/time.hpp"

namespace fleetloc {

class ConfigReader;

/// When to repeat the latest small message until a newer one exists: the more the network loses,
/// the more often.
class Repetition {
 public:
  struct Config {
    double slowest_interval_s{};  ///< without loss
    double fastest_interval_s{};  ///< at `full_rate_loss` and above
    double full_rate_loss{};      ///< share of lost datagrams
  };
  explicit Repetition(const Config& config) : config_(config) {}

  /// A new message was sent; repetitions start from here.
  void sent(Timestamp now) { last_ = now; }

  /// True if it is to be sent again now. Counts it as sent.
  bool due(Timestamp now, double loss);

 private:
  Config config_;
  std::optional<Timestamp> last_;
};

Repetition::Config read_repetition_config(ConfigReader config);

}  // namespace fleetloc

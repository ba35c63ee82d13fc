#pragma once

#include <optional>

#include "shared/core/time.hpp"

namespace fleetloc {

class ConfigReader;

/// Whether a localizer takes robots that it does not serve yet: by the work that it is measured to
/// do, and not by their number alone. Robots that came a moment ago do not show in that measure
/// yet, so the work of a mean robot is added for each. Once closed it opens only after clearly less
/// work, so that it does not change all the time.
class Admission {
 public:
  struct Config {
    double max_load;      ///< share of the workers' time; beyond, it is closed
    double open_load;     ///< below, it opens again
    double max_wait_s;    ///< of submaps for a worker; beyond, it is closed
    double open_wait_s;   ///< below, it opens again
    double new_for_s;     ///< how long a robot takes to show in the measured load
    double session_load;  ///< of one robot, while none has been measured
  };
  struct Sessions {
    int all = 0;
    int fresh = 0;  ///< for less than `new_for_s`
  };

  explicit Admission(const Config& config) : config_(config) {}

  /// A job was started whose oldest submap has waited that long.
  void waited(Duration wait, Timestamp now);

  /// To be called regularly.
  /// @param load  measured share of the workers' time
  /// @return whether it is open
  bool update(double load, Sessions sessions, Timestamp now);

  [[nodiscard]] bool is_new(Timestamp opened, Timestamp now) const {
    return to_seconds(now - opened) < config_.new_for_s;
  }

 private:
  [[nodiscard]] double expected_load(double load, Sessions sessions) const;

  Config config_;
  bool is_open_ = true;
  double wait_s_ = 0.0;  // the longest, which fades
  std::optional<Timestamp> faded_;
};

Admission::Config read_admission_config(ConfigReader config);

}  // namespace fleetloc

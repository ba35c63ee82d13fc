#pragma once

#include <optional>

#include "cloud/localizer/map_association.hpp"
#include "cloud/localizer/rejection.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// Whether a session's place is still believed. It is not once everything that was seen over some
/// way speaks against it: the robot was carried away, or had a wrong place from the beginning.
///
/// A window of many keyframes holds the place where it was, also when nothing fits any more of what
/// the newest ones see. So what only these have seen has to fit about as well as it used to.
class PlaceDoubt {
 public:
  struct Config {
    double way_m;           ///< driven, over which no window fits the place where the session was
    double start_way_m;     ///< the same of a start pose from which nothing was localized
    double min_agreement;   ///< matched share of what the newest keyframes have seen, relative to
                            ///< what it used to be,
    double sure_agreement;  ///< and to take back that it is doubted or not believed,
    int min_landmarks;      ///< of so many with the map around them; fewer say nothing
  };

  explicit PlaceDoubt(const Config& config) : config_(config) {}

  /// Whether what only the newest keyframes have seen speaks against the place. Takes them in
  /// order.
  bool is_elsewhere(const Association& recent);

  /// Takes what became of a window, in the order of the newest keyframes.
  /// @param rejection    nothing: localized
  /// @param travelled_m  by the odometry until its newest keyframe
  void take(const std::optional<Rejection>& rejection, double travelled_m);

  [[nodiscard]] bool is_lost() const { return is_lost_; }

 private:
  Config config_;
  bool was_localized_ = false;
  bool is_lost_ = false;
  std::optional<double> since_m_;          // travelled: from there on everything speaks against it
  std::optional<double> usual_agreement_;  // of what only the newest keyframes have seen
  bool is_elsewhere_ = false;              // as far as that was last told, like
  bool is_surely_here_ = true;
};

PlaceDoubt::Config read_place_doubt_config(ConfigReader section);

}  // namespace fleetloc

#pragma once

#include <optional>

#include "cloud/localizer/rejection.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// A start pose that nobody has told: a search has found it. It is a guess until something is
/// localized from it: the search goes on meanwhile, and it is given up if the map does not bear it
/// out. All ways are by the odometry [m].
class FoundStart {
 public:
  struct Config {
    double sigma_cells;  ///< of the pose, in cells of the pyramid
    double sigma_rad;
    double max_way_m;          ///< driven without a localization, and
    double max_refused_way_m;  ///< while all windows speak against it: then it is given up
  };

  explicit FoundStart(const Config& config) : config_(config) {}

  /// @param travelled_m  until now
  /// @param searched_m   in the window of the search
  void begin(double travelled_m, double searched_m) {
    found_ = Found{.at_m = travelled_m, .refused_since_m = {}, .searched_m = searched_m};
  }
  /// Another search has found the same place.
  /// @return whether from a longer window than any before
  bool confirm(double searched_m) {
    if (!found_ || searched_m <= found_->searched_m) return false;
    found_->searched_m = searched_m;
    return true;
  }
  /// What a window says of it that is not localized there.
  void judge(PlaceEvidence evidence, double travelled_m) {
    if (!found_ || evidence == PlaceEvidence::kNone) return;
    if (evidence == PlaceEvidence::kFor) found_->refused_since_m.reset();
    if (evidence == PlaceEvidence::kAgainst && !found_->refused_since_m) {
      found_->refused_since_m = travelled_m;
    }
  }
  void give_up() { found_.reset(); }

  [[nodiscard]] bool exists() const { return found_.has_value(); }
  /// As long as nothing is localized from it. A wrong one no longer fits as the robot drives on; a
  /// right one may take its time.
  [[nodiscard]] bool is_wrong(double travelled_m) const {
    if (!found_) return false;
    const double refused_m = travelled_m - found_->refused_since_m.value_or(travelled_m);
    return travelled_m - found_->at_m > config_.max_way_m || refused_m > config_.max_refused_way_m;
  }
  /// In the longest window in which a search has found it.
  [[nodiscard]] double searched_m() const { return found_ ? found_->searched_m : 0.0; }

 private:
  struct Found {
    double at_m;                            // travelled
    std::optional<double> refused_since_m;  // travelled
    double searched_m;
  };
  Config config_;
  std::optional<Found> found_;
};

FoundStart::Config read_found_start_config(ConfigReader section);

}  // namespace fleetloc

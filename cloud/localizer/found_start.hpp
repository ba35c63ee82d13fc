#pragma once

#include <optional>

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
    int shift_steps;      ///< of the ShiftProfile of the windows that have all that was localized
    double max_way_m;     ///< driven without a localization, and
    double max_misfit_m;  ///< without a window that fits there: then it is given up
  };

  explicit FoundStart(const Config& config) : config_(config) {}

  /// @param travelled_m  until now
  /// @param searched_m   in the window of the search
  void find(double travelled_m, double searched_m) {
    found_ = Found{.at_m = travelled_m, .fitted_at_m = travelled_m, .searched_m = searched_m};
  }
  /// By another search, at the same place.
  void find_again(double searched_m) {
    if (found_) found_->searched_m = searched_m;
  }
  /// A window fits the map there, though it may not tell the place well enough.
  void fit(double travelled_m) {
    if (found_) found_->fitted_at_m = travelled_m;
  }
  void give_up() { found_.reset(); }

  [[nodiscard]] bool exists() const { return found_.has_value(); }
  /// As long as nothing is localized from it. A wrong one no longer fits as the robot drives on; a
  /// right one may take its time.
  [[nodiscard]] bool is_wrong(double travelled_m) const {
    return found_ && (travelled_m - found_->at_m > config_.max_way_m ||
                      travelled_m - found_->fitted_at_m > config_.max_misfit_m);
  }
  /// In the window of the last search that has found it.
  [[nodiscard]] double searched_m() const { return found_ ? found_->searched_m : 0.0; }

 private:
  struct Found {
    double at_m;  // travelled, as the next
    double fitted_at_m;
    double searched_m;
  };
  Config config_;
  std::optional<Found> found_;
};

FoundStart::Config read_found_start_config(ConfigReader section);

}  // namespace fleetloc

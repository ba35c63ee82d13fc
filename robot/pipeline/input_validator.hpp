#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Rejects measurements with invalid stamps or values, and counts them by reason. Accepted stamps
/// increase, for each kind of measurement.
class InputValidator {
 public:
  /// @param max_step  a stamp further ahead than this must be confirmed
  explicit InputValidator(Duration max_step) : max_step_(max_step) {}

  /// The samples accepted now, oldest first: usually this one. One whose stamp is far ahead waits
  /// for its successor to confirm it: after a wrong stamp all later samples would be rejected.
  std::vector<ImuSample> admit(const ImuSample& sample);

  /// Why a frame is rejected; empty if it is accepted.
  std::string_view check_frame(Timestamp stamp);

  /// By reason, e.g. "imu_not_newer"; reasons that never occurred included.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& refused() const { return refused_; }

 private:
  Duration max_step_;
  std::optional<Timestamp> last_imu_;
  std::optional<ImuSample> unconfirmed_;
  std::optional<Timestamp> last_frame_;
  std::map<std::string, std::uint64_t> refused_ = {{"imu_not_newer", 0},
                                                   {"imu_not_finite", 0},
                                                   {"imu_ahead", 0},
                                                   {"frame_not_newer", 0},
                                                   {"frame_ahead_of_imu", 0}};
};

}  // namespace fleetloc

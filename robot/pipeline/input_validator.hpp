#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Refuses measurements whose stamps or values cannot be, and counts them by reason. What it lets
/// through has increasing stamps, for each kind of measurement.
class InputValidator {
 public:
  /// @param max_step  a stamp further ahead than this must be confirmed
  explicit InputValidator(Duration max_step) : max_step_(max_step) {}

  /// What may be used now, oldest first: as a rule this sample. One whose stamp is far ahead waits
  /// for its successor: it comes after a gap, or its stamp is wrong and would lock all others out.
  std::vector<ImuSample> admit(const ImuSample& sample);

  /// Why a frame is refused; empty if it is not.
  std::string_view judge_frame(Timestamp stamp);

  /// By reason, e.g. "imu_not_newer"; those that never occurred as well.
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

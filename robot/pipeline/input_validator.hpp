#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/core/expected.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Why a measurement was rejected.
enum class InputRejection {
  kImuNotNewer,
  kImuImpossible,  ///< not finite, or more than any sensor measures
  kImuAhead,       ///< its stamp is far ahead, and the next sample's has to confirm it
  kFrameNotNewer,
  kFrameAheadOfImu,
};

/// Name in files, e.g. "imu_not_newer".
std::string_view name(InputRejection reason);

/// Rejects measurements with invalid stamps or values, and counts them by reason. Accepted stamps
/// increase, for each kind of measurement.
class InputValidator {
 public:
  /// @param max_step  a stamp further ahead than this must be confirmed
  explicit InputValidator(Duration max_step) : max_step_(max_step) {}

  /// The samples accepted now, oldest first: usually this one. One whose stamp is far ahead is
  /// rejected only for the time being: if its successor confirms it, both are accepted then. After
  /// a wrong stamp all later samples would be rejected otherwise.
  expected<std::vector<ImuSample>, InputRejection> check_imu(const ImuSample& sample);

  expected<void, InputRejection> check_frame(Timestamp stamp);

  /// By reason; reasons that never occurred included. Samples that were confirmed do not count.
  [[nodiscard]] std::map<std::string, std::uint64_t> rejected() const;

 private:
  unexpected<InputRejection> rejection(InputRejection reason);

  Duration max_step_;
  std::optional<Timestamp> last_imu_;
  std::optional<ImuSample> unconfirmed_;
  std::optional<Timestamp> last_frame_;
  std::map<InputRejection, std::uint64_t> counts_;
};

}  // namespace fleetloc

#include "shared/wire/served_robot_codec.hpp"

#include <idl/monitoring.h>

#include "shared/wire/cdr.hpp"
#include "shared/wire/fields.hpp"
#include "shared/wire/quality.hpp"

namespace fleetloc {
namespace {

constexpr double kMaxRate = 1e9;  // [bytes/s]
constexpr double kMaxSilence_s = 1e9;

Validity check_served_robot_sample(const wire::ServedRobot& sample) {
  if (const Validity valid = check(sample.quality()); !valid) return valid;
  if (const Validity valid = check(sample.T_map_body()); !valid) return valid;
  if (const Validity valid = check(sample.covariance()); !valid) return valid;
  for (const float rate : {sample.up_bytes_per_s(), sample.down_bytes_per_s()}) {
    if (const Validity valid = check(static_cast<double>(rate), 0.0, kMaxRate); !valid)
      return valid;
  }
  if (sample.possible_places().size() > kMaxPossiblePlaces) {
    return unexpected(Malformed::kOutOfRange);
  }
  for (const wire::Vector3& place : sample.possible_places()) {
    if (const Validity valid = check(place); !valid) return valid;
  }
  return check(static_cast<double>(sample.silent_s()), 0.0, kMaxSilence_s);
}

}  // namespace

Bytes encode(const ServedRobot& robot) {
  expect_encodable_id(robot.localizer);
  expect_encodable_id(robot.robot);
  wire::ServedRobot sample;
  sample.localizer(robot.localizer);
  sample.robot(robot.robot);
  sample.session(static_cast<std::uint32_t>(robot.session));
  sample.quality(to_wire(robot.quality));
  sample.localized(robot.T_map_body.has_value());
  sample.T_map_body(to_wire(robot.T_map_body.value_or(Pose{})));
  sample.covariance(to_wire(robot.covariance));
  sample.up_bytes_per_s(static_cast<float>(robot.up_bytes_per_s));
  sample.down_bytes_per_s(static_cast<float>(robot.down_bytes_per_s));
  sample.silent_s(static_cast<float>(to_seconds(robot.silent)));
  sample.round_trip_ns(robot.round_trip.value_or(kNotMeasured).count());
  for (const Eigen::Vector3d& p_map : robot.possible_places) {
    sample.possible_places().push_back(to_wire(p_map));
  }
  expect_encodable(check_served_robot_sample(sample), "served robot");
  return to_cdr(sample);
}

Decoded<ServedRobot> decode_served_robot(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::ServedRobot>(bytes, 2, check_served_robot_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  ServedRobot robot{.localizer = sample.localizer().to_string(),
                    .robot = sample.robot().to_string(),
                    .session = SessionNumber{sample.session()},
                    .quality = from_wire(sample.quality()),
                    .T_map_body = std::nullopt,
                    .covariance = from_wire(sample.covariance()),
                    .up_bytes_per_s = static_cast<double>(sample.up_bytes_per_s()),
                    .down_bytes_per_s = static_cast<double>(sample.down_bytes_per_s()),
                    .silent = from_seconds(static_cast<double>(sample.silent_s())),
                    .round_trip = std::nullopt,
                    .possible_places = {}};
  if (sample.localized()) robot.T_map_body = from_wire(sample.T_map_body());
  for (const wire::Vector3& p_map : sample.possible_places()) {
    robot.possible_places.push_back(from_wire(p_map));
  }
  if (sample.round_trip_ns() >= 0) robot.round_trip = Duration{sample.round_trip_ns()};
  return robot;
}

}  // namespace fleetloc

#include "shared/wire/status_codec.hpp"

#include <idl/status.h>

#include "shared/wire/cdr.hpp"
#include "shared/wire/fields.hpp"
#include "shared/wire/quality.hpp"

namespace fleetloc {
namespace {

constexpr std::uint32_t kMaxSessions = 1'000'000;

Validity check_status_sample(const wire::LocalizerStatus& sample) {
  if (sample.sessions() > kMaxSessions) return unexpected(Malformed::kOutOfRange);
  return check(static_cast<double>(sample.load()), 0.0, 1.0);
}

Validity check_status_sample(const wire::RobotStatus& sample) {
  if (const Validity valid = check(sample.quality()); !valid) return valid;
  if (const Validity valid = check_stamp(sample.start_stamp_ns()); !valid) return valid;
  return check_stamp(sample.stamp_ns());
}

}  // namespace

Bytes encode(const LocalizerStatus& status) {
  expect_encodable_id(status.localizer);
  wire::LocalizerStatus sample;
  sample.localizer(status.localizer);
  sample.incarnation(static_cast<std::uint32_t>(status.incarnation));
  sample.map_hash(status.map_hash);
  sample.sessions(static_cast<std::uint32_t>(status.sessions));  // a negative one is out of range
  sample.load(static_cast<float>(status.load));
  sample.accepting(status.accepting);
  sample.draining(status.draining);
  expect_encodable(check_status_sample(sample), "localizer status");
  return to_cdr(sample);
}

Bytes encode(const RobotStatus& status) {
  expect_encodable_id(status.robot);
  wire::RobotStatus sample;
  sample.robot(status.robot);
  sample.session(static_cast<std::uint32_t>(status.session));
  sample.start_stamp_ns(to_wire(status.start_stamp));
  sample.stamp_ns(to_wire(status.stamp));
  sample.quality(to_wire(status.quality));
  sample.submaps_sent(status.submaps_sent);
  sample.answers_applied(status.answers_applied);
  sample.round_trip_ns(status.round_trip.value_or(kNotMeasured).count());
  expect_encodable(check_status_sample(sample), "robot status");
  return to_cdr(sample);
}

Decoded<LocalizerStatus> decode_localizer_status(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::LocalizerStatus>(bytes, 1, check_status_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  return LocalizerStatus{.localizer = sample.localizer().to_string(),
                         .incarnation = Incarnation{sample.incarnation()},
                         .map_hash = sample.map_hash(),
                         .sessions = static_cast<int>(sample.sessions()),
                         .load = static_cast<double>(sample.load()),
                         .accepting = sample.accepting(),
                         .draining = sample.draining()};
}

Decoded<RobotStatus> decode_robot_status(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::RobotStatus>(bytes, 1, check_status_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  RobotStatus status{.robot = sample.robot().to_string(),
                     .session = SessionNumber{sample.session()},
                     .start_stamp = stamp_from_wire(sample.start_stamp_ns()),
                     .stamp = stamp_from_wire(sample.stamp_ns()),
                     .quality = from_wire(sample.quality()),
                     .submaps_sent = sample.submaps_sent(),
                     .answers_applied = sample.answers_applied(),
                     .round_trip = std::nullopt};
  if (sample.round_trip_ns() >= 0) status.round_trip = Duration{sample.round_trip_ns()};
  return status;
}

}  // namespace fleetloc

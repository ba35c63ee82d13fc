#include "shared/wire/session_codec.hpp"

#include <idl/session.h>

#include "shared/wire/cdr.hpp"
#include "shared/wire/fields.hpp"

namespace fleetloc {
namespace {

// Predictions of the compact encoding start from this pose: both ends need the same bits, so it is
// not normalized anew.
Pose same_bits(const wire::Pose& T) {
  const wire::Quaternion& q = T.rotation();
  return {Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()), from_wire(T.translation())};
}

constexpr double kMinFocal_px = 1.0;
constexpr double kMaxFocal_px = 1e5;
constexpr double kMaxBaseline_m = 100.0;

Validity check_stereo(const wire::RobotSession& sample) {
  if (const Validity valid = check(sample.focal_px(), kMinFocal_px, kMaxFocal_px); !valid)
    return valid;
  for (const double center : sample.center_px()) {
    if (const Validity valid = check(center, 0.0, kRectifiedSize); !valid) return valid;
  }
  // Zero: one camera.
  if (const Validity valid = check(sample.baseline_m(), 0.0, kMaxBaseline_m); !valid) return valid;
  return check(sample.T_body_cam0());
}

Validity check_region(const wire::RobotSession& sample) {
  const std::string name = sample.region().to_string();
  if (!name.empty() && !is_valid_id(name)) return unexpected(Malformed::kInvalidId);
  const auto& [x, y, radius] = sample.region_circle();
  for (const double value : {x, y}) {
    if (const Validity valid = check(value, -kMaxCoordinate, kMaxCoordinate); !valid) return valid;
  }
  return check(radius, 0.0, kMaxCoordinate);
}

std::optional<StartRegion> region_of(const wire::RobotSession& sample) {
  const auto& [x, y, radius] = sample.region_circle();
  if (sample.region().size() == 0 && radius == 0.0) return std::nullopt;
  return StartRegion{.name = sample.region().to_string(),
                     .center_map = {x, y},
                     .radius_m = radius,
                     .p_odom = from_wire(sample.p_odom())};
}

Validity check_session_sample(const wire::RobotSession& sample) {
  if (sample.encoding() > wire::COMPACT) return unexpected(Malformed::kUnknownValue);
  if (const Validity valid = check_stamp(sample.start_stamp_ns()); !valid) return valid;
  if (const Validity valid = check_stereo(sample); !valid) return valid;
  if (const Validity valid = check_region(sample); !valid) return valid;
  if (const Validity valid = check(sample.p_odom()); !valid) return valid;
  if (const Validity valid = check(sample.T_map_odom()); !valid) return valid;
  return check(sample.covariance());
}

}  // namespace

Bytes encode(const RobotSession& session) {
  expect_encodable_id(session.robot);
  expect_encodable_id(session.localizer);
  wire::RobotSession sample;
  sample.robot(session.robot);
  sample.localizer(session.localizer);
  sample.incarnation(static_cast<std::uint32_t>(session.incarnation));
  sample.session(static_cast<std::uint32_t>(session.session));
  sample.start_stamp_ns(to_wire(session.start_stamp));
  sample.encoding(session.encoding == SubmapEncoding::kFull ? wire::FULL : wire::COMPACT);
  sample.focal_px(session.stereo.focal_px);
  sample.center_px({session.stereo.center_px.x(), session.stereo.center_px.y()});
  sample.baseline_m(session.stereo.baseline_m);
  sample.T_body_cam0(to_wire(session.stereo.T_body_cam0));
  sample.has_start(session.start.has_value());
  const MapOdomEstimate start = session.start.value_or(MapOdomEstimate{});
  const StartRegion region = session.region.value_or(StartRegion{});
  sample.p_odom(to_wire(session.start ? start.p_odom : region.p_odom));
  sample.T_map_odom(to_wire(start.T_map_odom));
  sample.covariance(to_wire(start.covariance));
  sample.region(region.name);
  sample.region_circle({region.center_map.x(), region.center_map.y(), region.radius_m});
  expect_encodable(check_session_sample(sample), "robot session");
  return to_cdr(sample);
}

Decoded<RobotSession> decode_robot_session(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::RobotSession>(bytes, 2, check_session_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  RobotSession session{.robot = sample.robot().to_string(),
                       .session = SessionNumber{sample.session()},
                       .start_stamp = stamp_from_wire(sample.start_stamp_ns()),
                       .localizer = sample.localizer().to_string(),
                       .incarnation = Incarnation{sample.incarnation()},
                       .encoding = sample.encoding() == wire::FULL ? SubmapEncoding::kFull
                                                                   : SubmapEncoding::kCompact,
                       .stereo = {.focal_px = sample.focal_px(),
                                  .center_px = {sample.center_px()[0], sample.center_px()[1]},
                                  .baseline_m = sample.baseline_m(),
                                  .T_body_cam0 = same_bits(sample.T_body_cam0())},
                       .start = std::nullopt,
                       .region = std::nullopt};
  if (sample.has_start()) {
    session.start = MapOdomEstimate{.T_map_odom = from_wire(sample.T_map_odom()),
                                    .covariance = from_wire(sample.covariance()),
                                    .p_odom = from_wire(sample.p_odom())};
  } else {
    session.region = region_of(sample);
  }
  return session;
}

}  // namespace fleetloc

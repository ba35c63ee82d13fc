#include "deploy/topic/sample_decoder.hpp"

#include <set>

#include "shared/compact/answer_sample.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/transport/topics.hpp"
#include "shared/wire/pose_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"

namespace fleetloc {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxSessions = 1000;

template <typename Id>
std::uint32_t number(Id id) {
  return static_cast<std::uint32_t>(id);
}

Json seconds(Timestamp stamp) {
  return to_seconds(stamp.time_since_epoch());
}

template <typename Vector>
Json vector(const Vector& v) {
  Json out = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) out.push_back(v[i]);
  return out;
}

Json pose(const Pose& T) {
  return {{"translation", vector(T.p)}, {"rotation", {T.R.w(), T.R.x(), T.R.y(), T.R.z()}}};
}

// Standard deviations: rotation [rad], translation [m].
Json sigmas(const Matrix6d& covariance) {
  return vector(Vector6d(covariance.diagonal().cwiseMax(0.0).cwiseSqrt()));
}

std::string hexadecimal(const MapHash& hash) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (const std::uint8_t byte : hash) {
    out += kDigits[byte >> 4U];
    out += kDigits[byte & 15U];
  }
  return out;
}

Json keyframe_json(const SubmapKeyframe& keyframe) {
  Json observations = Json::array();
  for (const StereoObservation& one : keyframe.observations) {
    observations.push_back({number(one.landmark), one.left.x(), one.left.y(), one.disparity});
  }
  Json out{{"id", number(keyframe.id)},
           {"stamp_s", seconds(keyframe.stamp)},
           {"T_odom_body", pose(keyframe.T_odom_body)},
           {"tilt_sigma", keyframe.tilt_sigma},
           {"pixel_step_px", keyframe.pixel_step_px}};
  if (keyframe.subset.stride > 1) out["every_second_landmark_from"] = keyframe.subset.offset;
  out["observations"] = std::move(observations);
  return out;
}

// Only compact submaps have none: their landmarks are told by observations alone.
Json landmarks_json(const Submap& submap) {
  Json out = Json::array();
  for (const SubmapLandmark& landmark : submap.landmarks) {
    out.push_back({{"id", number(landmark.id)}, {"p_odom", vector(landmark.p_odom)}});
  }
  if (!out.empty()) return out;
  std::set<std::uint32_t> ids;
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    for (const auto& one : keyframe.observations) ids.insert(number(one.landmark));
  }
  for (const std::uint32_t id : ids) out.push_back(id);
  return out;
}

void add_contents(const Submap& submap, Json& out) {
  Json& keyframes = out["keyframes"] = Json::array();
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    keyframes.push_back(keyframe_json(keyframe));
  }
  out["landmarks"] = landmarks_json(submap);
  Json& edges = out["edges"] = Json::array();
  for (const VirtualEdge& edge : submap.edges) {
    edges.push_back({{"from", number(edge.from)},
                     {"to", number(edge.to)},
                     {"T_from_to", pose(edge.T_from_to)},
                     {"sigma", sigmas(edge.information.inverse())}});
  }
}

Json json_of(const Submap& submap) {
  Json out{{"robot", submap.robot},
           {"session", number(submap.session)},
           {"incarnation", number(submap.incarnation)},
           {"number", number(submap.number)}};
  add_contents(submap, out);
  return out;
}

Json correction_json(const Correction& correction) {
  Json relative_poses = Json::array();
  for (const auto& one : correction.relative_poses) {
    relative_poses.push_back({{"from", number(one.from)},
                              {"to", number(one.to)},
                              {"T_from_to", pose(one.T_from_to)},
                              {"information", vector(Vector6d(one.information.diagonal()))}});
  }
  Json landmarks = Json::array();
  for (const auto& one : correction.landmarks) {
    landmarks.push_back({{"id", number(one.id)},
                         {"p_anchor", vector(one.p_anchor)},
                         {"information", vector(Eigen::Vector3d(one.information.diagonal()))}});
  }
  return {{"anchor", number(correction.anchor)},
          {"relative_poses", relative_poses},
          {"landmarks", landmarks}};
}

Json json_of(const Answer& answer) {
  const LocalizationResult& result = answer.result;
  Json acknowledged = Json::array();
  for (std::uint32_t bit = 0; bit < 64; ++bit) {
    if (((result.acknowledgements.bitmap >> bit) & 1U) == 0) continue;
    acknowledged.push_back(number(result.acknowledgements.base) + bit);
  }
  Json out{{"robot", result.robot},
           {"session", number(result.session)},
           {"localizer", result.localizer},
           {"incarnation", number(result.incarnation)},
           {"number", result.number},
           {"status", name(result.status)},
           {"keyframe", number(result.keyframe)},
           {"stamp_s", seconds(result.stamp)},
           {"holding_time_s", to_seconds(result.holding_time)},
           {"map_hash", hexadecimal(result.map_hash)},
           {"acknowledged", acknowledged}};
  if (result.status == LocalizationStatus::kLocalized) {
    out["window_s"] = to_seconds(result.stamp - result.oldest_stamp);
    out["T_map_body"] = pose(result.T_map_body);
    out["sigma"] = sigmas(result.covariance);
  } else {
    out["places"] = result.places;
  }
  if (answer.correction) out["correction"] = correction_json(*answer.correction);
  return out;
}

Json json_of(const RobotSession& session) {
  Json out{{"robot", session.robot},
           {"session", number(session.session)},
           {"start_stamp_s", seconds(session.start_stamp)},
           {"localizer", session.localizer},
           {"incarnation", number(session.incarnation)},
           {"encoding", session.encoding == SubmapEncoding::kCompact ? "compact" : "full"},
           {"stereo",
            {{"focal_px", session.stereo.focal_px},
             {"center_px", vector(session.stereo.center_px)},
             {"baseline_m", session.stereo.baseline_m},
             {"T_body_cam0", pose(session.stereo.T_body_cam0)}}}};
  if (session.start) {
    out["start"] = {{"T_map_odom", pose(session.start->T_map_odom)},
                    {"sigma", sigmas(session.start->covariance)},
                    {"p_odom", vector(session.start->p_odom)}};
  }
  if (const auto& region = session.region) {
    out["region"] = {{"p_odom", vector(region->p_odom)}};
    if (region->name.empty()) {
      out["region"]["center"] = vector(region->center_map);
      out["region"]["radius_m"] = region->radius_m;
    } else {
      out["region"]["name"] = region->name;
    }
  }
  return out;
}

Json json_of(const LocalizerStatus& status) {
  return {{"localizer", status.localizer},
          {"incarnation", number(status.incarnation)},
          {"map_hash", hexadecimal(status.map_hash)},
          {"sessions", status.sessions},
          {"load", status.load},
          {"accepting", status.accepting},
          {"draining", status.draining}};
}

Json json_of(const RobotStatus& status) {
  Json out{{"robot", status.robot},
           {"session", number(status.session)},
           {"start_stamp_s", seconds(status.start_stamp)},
           {"stamp_s", seconds(status.stamp)},
           {"quality", name(status.quality)},
           {"submaps_sent", status.submaps_sent},
           {"answers_applied", status.answers_applied}};
  if (status.round_trip) out["round_trip_s"] = to_seconds(*status.round_trip);
  return out;
}

Json json_of(const RobotPoseEstimate& sample) {
  const PoseEstimate& estimate = sample.estimate;
  Json out{{"robot", sample.robot},
           {"stamp_s", seconds(estimate.stamp)},
           {"quality", name(estimate.quality)},
           {"since_last_answer_s", to_seconds(estimate.since_last_answer)},
           {"T_odom_body", pose(estimate.T_odom_body)},
           {"sigma_odom", sigmas(estimate.covariance_odom)},
           {"v_odom", vector(estimate.v_odom)},
           {"angular_velocity", vector(estimate.angular_velocity)}};
  if (estimate.T_map_body) {
    out["T_map_body"] = pose(*estimate.T_map_body);
    out["sigma_map"] = sigmas(estimate.covariance_map);
  }
  return out;
}

template <typename T>
Json json_or_error(const Decoded<T>& decoded) {
  return decoded ? json_of(*decoded) : Json{{"error", name(decoded.error())}};
}

}  // namespace

Json SampleDecoder::decode(std::string_view topic, const Bytes& payload) {
  const auto known = topic_of(topic);
  if (!known) return json_or_error(decode_pose_estimate(payload));
  switch (known->first) {
    case Topic::kSession:
      return decode_session(payload);
    case Topic::kSubmap:
      return json_or_error(decode_submap(payload));
    case Topic::kCompactSubmap:
      return decode_compact(payload);
    case Topic::kLocalization:
      return json_or_error(decode_answer(payload));
    case Topic::kRobotStatus:
      return json_or_error(decode_robot_status(payload));
    case Topic::kLocalizerStatus:
      return json_or_error(decode_localizer_status(payload));
  }
  return {};
}

Json SampleDecoder::decode_session(const Bytes& payload) {
  const auto session = decode_robot_session(payload);
  if (session && (sessions_.size() < kMaxSessions || sessions_.contains(session->robot))) {
    sessions_[session->robot] = *session;
  }
  return json_or_error(session);
}

Json SampleDecoder::decode_compact(const Bytes& payload) const {
  const auto sample = decode_submap_sample(payload);
  if (!sample) return {{"error", name(sample.error())}};
  Json out{{"robot", sample->robot},
           {"session", number(sample->session)},
           {"incarnation", number(sample->incarnation)},
           {"number", number(sample->number)},
           {"answer", sample->receipt.newest},
           {"answer_loss", sample->receipt.loss},
           {"keyframe", number(sample->keyframe)},
           {"stamp_s", seconds(sample->stamp)},
           {"block", sample->block.size()}};
  const auto session = sessions_.find(sample->robot);
  if (session == sessions_.end() || session->second.session != sample->session) {
    out["error"] = "the session is not known yet, so the block cannot be decoded";
    return out;
  }
  const auto submap = decode_submap(*sample, session->second.stereo);
  if (submap) {
    add_contents(*submap, out);
  } else {
    out["error"] = name(submap.error());
  }
  return out;
}

}  // namespace fleetloc

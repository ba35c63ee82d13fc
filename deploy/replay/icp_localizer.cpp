#include "deploy/replay/icp_localizer.hpp"

#include <utility>

#include "shared/geometry/covariance.hpp"

namespace fleetloc {
namespace {

std::vector<Eigen::Vector3f> positions_of(const LaserMap& map) {
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(map.size());
  for (const MapPoint& point : map.points()) positions.push_back(point.p_map);
  return positions;
}

}  // namespace

IcpLocalizer::IcpLocalizer(std::shared_ptr<const LaserMap> map,
                           const Config& config,
                           Duration localization_time)
    : map_(std::move(map)),
      target_(positions_of(*map_)),
      config_(config),
      localization_time_(localization_time) {}

void IcpLocalizer::start_session(const RobotSession& session, Timestamp now) {
  advance(now);
  session_ = session;
  T_map_odom_.reset();
  if (session.start) T_map_odom_ = session.start->T_map_odom;
  waiting_.reset();
  running_.reset();
}

void IcpLocalizer::submit(Submap submap, Timestamp now) {
  advance(now);
  if (!session_) return;
  waiting_ = std::move(submap);
  advance(now);
}

std::vector<LocalizationResult> IcpLocalizer::take_answers(Timestamp now) {
  advance(now);
  return std::exchange(answers_, {});
}

void IcpLocalizer::advance(Timestamp now) {
  if (running_ && running_->ready <= now) {
    answers_.push_back(std::move(running_->answer));
    running_.reset();
  }
  if (running_ || !waiting_) return;
  running_ = Running{.answer = answer_to(*waiting_), .ready = now + localization_time_};
  running_->answer.holding_time = localization_time_;
  waiting_.reset();
}

LocalizationResult IcpLocalizer::answer_to(const Submap& submap) {
  const SubmapKeyframe& newest = submap.keyframes.back();
  LocalizationResult answer;
  answer.robot = session_->robot;
  answer.session = session_->session;
  answer.localizer = "icp";
  answer.incarnation = Incarnation{1};
  answer.keyframe = newest.id;
  answer.revision = newest.revision;
  answer.stamp = newest.stamp;
  answer.map_hash = map_->info().hash;
  answer.status = LocalizationStatus::kSearching;
  if (!T_map_odom_) return answer;

  std::vector<Eigen::Vector3d> landmarks;
  for (const SubmapLandmark& landmark : submap.landmarks) landmarks.push_back(landmark.p_odom);
  const IcpResult result = target_.align(landmarks, *T_map_odom_, config_.icp);
  answer.status = judge(result);
  if (answer.status != LocalizationStatus::kLocalized) return answer;
  answer.oldest_stamp = submap.keyframes.front().stamp;
  T_map_odom_ = result.T_target_source;
  answer.T_map_body = *T_map_odom_ * newest.T_odom_body;
  answer.covariance = diagonal_covariance(config_.sigma_rad, config_.sigma_m);
  return answer;
}

LocalizationStatus IcpLocalizer::judge(const IcpResult& result) const {
  if (!result.converged) return LocalizationStatus::kNotConverged;
  if (result.matched_share < config_.min_matched_share) return LocalizationStatus::kTooFewMatches;
  return result.rms_m <= config_.max_rms_m ? LocalizationStatus::kLocalized
                                           : LocalizationStatus::kPoorFit;
}

IcpLocalizer::Config read_icp_localizer_config(ConfigReader section) {
  return {.icp = {.max_distance_m = section.positive("max_distance_m"),
                  .iterations = section.integer("iterations", 1, 1000),
                  .settled_m = section.positive("settled_m")},
          .min_matched_share = section.number("min_matched_share", 0.0, 1.0),
          .max_rms_m = section.positive("max_rms_m"),
          .sigma_m = section.positive("sigma_m"),
          .sigma_rad = section.positive("sigma_rad")};
}

}  // namespace fleetloc

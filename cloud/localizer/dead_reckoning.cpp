#include "cloud/localizer/dead_reckoning.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fleetloc {
namespace {

Pose where_known(const MapOdomEstimate& start) {
  return {Eigen::Quaterniond::Identity(), start.p_odom};
}

std::vector<PoseAnchor> anchors_at(const std::optional<MapOdomEstimate>& start) {
  if (!start) return {};
  return {PoseAnchor{.keyframe = std::nullopt,
                     .T_odom_body = where_known(*start),
                     .travelled_m = 0.0,
                     .estimate = pose_where_known(*start)}};
}

}  // namespace

PoseWithCovariance pose_where_known(const MapOdomEstimate& start) {
  const Pose T_odom_known = where_known(start);
  const Matrix6d A = adjoint(inverse(T_odom_known));
  return {start.T_map_odom * T_odom_known, A * start.covariance * A.transpose()};
}

// The covariance is carried along the step, T_map_later = T_map_anchor * step, and the drift added.
PoseWithCovariance PoseAnchor::at(const Pose& T_odom_later,
                                  double travelled_m_later,
                                  const DriftConfig& drift) const {
  const Pose step = inverse(T_odom_body) * T_odom_later;
  const Matrix6d A = adjoint(inverse(step));
  const double distance = std::max(step.p.norm(), std::abs(travelled_m_later - travelled_m));
  const double rotation = drift.rotation_rad_per_m * distance;
  const double translation = drift.translation_m_per_m * distance;
  PoseWithCovariance result{estimate.T_map_body * step, A * estimate.covariance * A.transpose()};
  result.covariance.diagonal().head<3>().array() += rotation * rotation;
  result.covariance.diagonal().tail<3>().array() += translation * translation;
  return result;
}

DeadReckoning::DeadReckoning(const std::optional<MapOdomEstimate>& start, const DriftConfig& drift)
    : drift_(drift),
      anchors_(anchors_at(start)),
      begin_odom_(has_anchor() ? anchors_.back().T_odom_body.p : Eigen::Vector3d::Zero()) {}

// The keyframe that is nearest to where the start pose was known is as far from there as it looks;
// from it the path goes on to both sides.
void DeadReckoning::begin_path(const std::map<KeyframeId, SessionDatabase::Keyframe>& keyframes) {
  const auto distance = [&](const auto& item) {
    return (item.second.item.T_odom_body.p - begin_odom_).norm();
  };
  const auto nearest = std::ranges::min_element(keyframes, {}, distance);
  path_[nearest->first] = {nearest->second.item.T_odom_body.p, distance(*nearest)};
}

void DeadReckoning::follow(const std::map<KeyframeId, SessionDatabase::Keyframe>& keyframes) {
  if (keyframes.empty()) return;
  if (path_.empty()) begin_path(keyframes);
  // Those before the first one that is known, from it backwards.
  for (auto it = std::make_reverse_iterator(keyframes.lower_bound(path_.begin()->first));
       it != keyframes.rend();
       ++it) {
    const PathPoint& next = path_.begin()->second;
    const Eigen::Vector3d& p_odom = it->second.item.T_odom_body.p;
    path_[it->first] = {p_odom, next.travelled_m - (next.p_odom - p_odom).norm()};
  }
  for (const auto& [id, keyframe] : keyframes) {
    // A keyframe may arrive late, between two that are known: those keep what was measured.
    const auto next = path_.lower_bound(id);
    if (next != path_.end() && next->first == id) continue;
    const PathPoint& before = std::prev(next)->second;
    const Eigen::Vector3d& p_odom = keyframe.item.T_odom_body.p;
    path_.emplace_hint(
        next, id, PathPoint{p_odom, before.travelled_m + (p_odom - before.p_odom).norm()});
  }
  path_.erase(path_.begin(), path_.lower_bound(keyframes.begin()->first));
  // Of the anchors before the oldest keyframe the last one is enough.
  const auto is_later = [&](const PoseAnchor& anchor) {
    return anchor.keyframe && *anchor.keyframe > keyframes.begin()->first;
  };
  const auto later = std::ranges::find_if(anchors_, is_later);
  if (later - anchors_.begin() > 1) anchors_.erase(anchors_.begin(), std::prev(later));
}

void DeadReckoning::restart(const SubmapKeyframe& localized, const PoseWithCovariance& estimate) {
  if (is_localized() && anchors_.back().keyframe == localized.id) anchors_.pop_back();
  anchors_.push_back({.keyframe = localized.id,
                      .T_odom_body = localized.T_odom_body,
                      .travelled_m = travelled_m(localized.id),
                      .estimate = estimate});
}

Pose DeadReckoning::T_map_odom() const {
  return anchors_.back().estimate.T_map_body * inverse(anchors_.back().T_odom_body);
}

PoseWithCovariance DeadReckoning::at(const SubmapKeyframe& keyframe) const {
  return anchors_.back().at(keyframe.T_odom_body, travelled_m(keyframe.id), drift_);
}

PosePrior DeadReckoning::prior(const std::vector<KeyframeId>& window,
                               const SessionDatabase& database) const {
  const PoseAnchor& newest = anchors_.back();
  if (newest.keyframe && std::ranges::binary_search(window, *newest.keyframe)) {
    return {*newest.keyframe, newest.estimate};
  }
  return carried(newest, window, database);
}

const PoseAnchor& DeadReckoning::anchor_before(const std::vector<KeyframeId>& window) const {
  const auto is_before = [&](const PoseAnchor& anchor) {
    return !anchor.keyframe || *anchor.keyframe <= window.front();
  };
  const auto last = std::find_if(anchors_.rbegin(), anchors_.rend(), is_before);
  return last == anchors_.rend() ? anchors_.front() : *last;
}

PosePrior DeadReckoning::before(const std::vector<KeyframeId>& window,
                                const SessionDatabase& database) const {
  return carried(anchor_before(window), window, database);
}

PosePrior DeadReckoning::carried(const PoseAnchor& anchor,
                                 const std::vector<KeyframeId>& window,
                                 const SessionDatabase& database) const {
  KeyframeId keyframe = window.front();
  if (!anchor.keyframe) {
    keyframe = *std::ranges::min_element(
        window, {}, [this](KeyframeId id) { return std::abs(travelled_m(id)); });
  }
  const SubmapKeyframe& item = database.keyframe(keyframe).item;
  return {keyframe, anchor.at(item.T_odom_body, travelled_m(keyframe), drift_)};
}

DriftConfig read_drift_config(ConfigReader section) {
  return {.translation_m_per_m = section.positive("translation_m_per_m"),
          .rotation_rad_per_m = section.positive("rotation_rad_per_m")};
}

}  // namespace fleetloc

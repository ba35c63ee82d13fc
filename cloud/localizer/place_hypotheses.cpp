#include "cloud/localizer/place_hypotheses.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "cloud/localizer/evenly.hpp"
#include "shared/geometry/covariance.hpp"

namespace fleetloc {

void PlaceHypotheses::see(View view) {
  running_.reset();
  view_ = std::move(view);
  for (const Place& place : places_) waiting_.push_back(place.T_map_odom);
  places_.clear();
}

void PlaceHypotheses::add(const Pose& T_map_odom) {
  assert(!running_);
  waiting_.push_back(T_map_odom);
}

void PlaceHypotheses::clear() {
  waiting_.clear();
  running_.reset();
  places_.clear();
}

bool PlaceHypotheses::align_next() {
  if (waiting_.empty()) return false;
  if (!running_) begin_alignment();
  for (int i = 0; i < config_.turn_starts; ++i) {
    if (running_->advance()) continue;
    end_alignment();
    break;
  }
  return true;
}

void PlaceHypotheses::begin_alignment() {
  const Pose& T_map_odom = waiting_.back();
  const Pose T_map_body = T_map_odom * view_.T_odom_body;
  const PoseWithCovariance prior{T_map_body, prior_covariance(T_map_body)};
  running_.emplace(alignment_, moved(view_.landmarks, T_map_odom), prior, gates_);
}

void PlaceHypotheses::end_alignment() {
  const Pose& T_map_odom = waiting_.back();
  const RigidAlignment::Result aligned = running_->result();
  Place place{.T_map_odom = aligned.T_new_old * T_map_odom,
              .T_map_body = aligned.T_new_old * (T_map_odom * view_.T_odom_body),
              .score = aligned.score};
  place.score += config_.blocked_score * blocked_rays(place.T_map_odom);
  places_.push_back(place);
  waiting_.pop_back();
  running_.reset();
}

void PlaceHypotheses::drop_if(const std::function<bool(const Pose&)>& is_impossible) {
  std::erase_if(places_, [&](const Place& place) { return is_impossible(place.T_map_odom); });
}

void PlaceHypotheses::keep_likely(std::size_t max_places) {
  std::ranges::sort(places_, {}, &Place::score);
  std::vector<Place> kept;
  for (Place& place : places_) {
    place.log_odds = (place.score - places_.front().score) / alignment_.rival_score();
    const auto is_here = [&](const Place& other) {
      return is_same_place(place.T_map_body, other.T_map_body, config_);
    };
    const bool is_likely = place.log_odds < config_.min_log_odds;
    if (kept.size() == max_places) break;
    if (is_likely && std::ranges::none_of(kept, is_here)) kept.push_back(place);
  }
  places_ = std::move(kept);
}

bool is_same_place(const Pose& T_map_one,
                   const Pose& T_map_other,
                   const PlaceHypotheses::Config& config) {
  const Vector6d beside = local_coordinates(T_map_one, T_map_other);
  return beside.head<3>().norm() < config.same_rad && beside.tail<3>().norm() < config.same_m;
}

// The vertical is known, the place to a cell of the pyramid.
Matrix6d PlaceHypotheses::prior_covariance(const Pose& T_map_body) const {
  Vector6d sigmas_map;
  sigmas_map << config_.sigma_tilt_rad, config_.sigma_tilt_rad, config_.sigma_rad,
      Eigen::Vector3d::Constant(config_.sigma_m);
  const Matrix6d A = adjoint(inverse(Pose{T_map_body.R, Eigen::Vector3d::Zero()}));
  return A * sigmas_map.cwiseAbs2().asDiagonal() * A.transpose();
}

int PlaceHypotheses::blocked_rays(const Pose& T_map_odom) const {
  const auto landmarks = moved(evenly(view_.landmarks, config_.rays), T_map_odom);
  return static_cast<int>(std::ranges::count_if(landmarks, [this](const WindowLandmark& seen) {
    const Eigen::Vector3d along = (seen.p_map - seen.viewpoint_map).normalized();
    const double sigma_m = std::sqrt(along.dot(seen.covariance * along));
    return free_space_.is_blocked(seen.viewpoint_map, seen.p_map, sigma_m);
  }));
}

PlaceHypotheses::Config read_place_hypotheses_config(ConfigReader section) {
  return {.sigma_m = section.positive("sigma_m"),
          .sigma_rad = section.positive("sigma_rad"),
          .sigma_tilt_rad = section.positive("sigma_tilt_rad"),
          .same_m = section.positive("same_m"),
          .same_rad = section.positive("same_rad"),
          .min_log_odds = section.positive("min_log_odds"),
          .rays = section.integer("rays", 1, 10000),
          .blocked_score = section.number("blocked_score", 0.0, 1000.0),
          .turn_starts = section.integer("turn_starts", 1, 1000)};
}

}  // namespace fleetloc

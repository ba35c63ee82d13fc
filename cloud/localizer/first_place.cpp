#include "cloud/localizer/first_place.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "cloud/localizer/dead_reckoning.hpp"
#include "cloud/localizer/evenly.hpp"
#include "shared/geometry/covariance.hpp"

namespace fleetloc {

FirstPlace::FirstPlace(std::shared_ptr<const MapPyramid> pyramid,
                       const RigidAlignment& alignment,
                       const RigidAlignment::Gates& gates,
                       const Config& config,
                       const std::optional<Region>& region)
    : pyramid_(std::move(pyramid)),
      alignment_(alignment),
      gates_(gates),
      config_(config),
      region_(region) {}

std::optional<FirstPlace::Region> FirstPlace::region_of(const MapOdomEstimate& start,
                                                        const Config& config) {
  const PoseWithCovariance known = pose_where_known(start);
  const double sigma_m = max_sigma(known.covariance.bottomRightCorner<3, 3>());
  const double sigma_rad = max_sigma(known.covariance.topLeftCorner<3, 3>());
  if (sigma_m <= config.known_m && sigma_rad <= config.known_rad) return std::nullopt;
  constexpr double kSigmas = 3.0;
  return Region{.p_map = known.T_map_body.p, .radius_m = kSigmas * sigma_m, .p_odom = start.p_odom};
}

bool FirstPlace::is_due(double way_m, double travelled_m) const {
  if (is_running() || way_m < config_.min_way_m) return false;
  return !begun_at_m_ || travelled_m - *begun_at_m_ >= config_.next_way_m;
}

void FirstPlace::begin(View view, double travelled_m) {
  view_ = std::move(view);
  std::vector<SeenLandmark> seen;
  for (const WindowLandmark& landmark : view_.landmarks) {
    if (max_sigma(landmark.covariance) > config_.max_sigma_m) continue;
    seen.push_back({.p = landmark.p_map, .viewpoint = landmark.viewpoint_map});
  }
  auto standing = evenly(above_ground(seen, config_.ground), config_.max_landmarks);
  if (standing.size() < static_cast<std::size_t>(config_.min_landmarks)) return;
  SearchRegion region = heights_above_ground(camera_height(seen, config_.ground), standing);
  if (region_) restrict_to_region(standing, region);
  begun_at_m_ = travelled_m;
  refined_.clear();
  search_.emplace(*pyramid_,
                  standing,
                  region,
                  PlaceSearch::Config{.max_places = config_.max_places + 1,
                                      .min_share = config_.min_share,
                                      .same_m = config_.same_m,
                                      .same_rad = config_.same_rad});
}

// A robot whose camera is at a known height drives on the ground; any other may be at any height.
SearchRegion FirstPlace::heights_above_ground(const std::optional<double>& camera_height_m,
                                              std::vector<SeenLandmark>& landmarks) {
  double nearest_m = std::numeric_limits<double>::infinity();
  double mean_m = 0.0;
  view_ground_m_ = 0.0;
  for (SeenLandmark& landmark : landmarks) {
    const double ground_m = camera_height_m ? landmark.viewpoint.z() - *camera_height_m : 0.0;
    landmark.p.z() -= ground_m;
    mean_m += landmark.p.z() / static_cast<double>(landmarks.size());
    const double from_body_m = (landmark.viewpoint - view_.T_odom_body.p).norm();
    if (from_body_m < nearest_m) view_ground_m_ = ground_m;
    nearest_m = std::min(nearest_m, from_body_m);
  }
  const double cell_m = pyramid_->cell_m();
  SearchRegion region{cell_m * pyramid_->min().cast<double>(),
                      cell_m * pyramid_->max().cast<double>()};
  if (camera_height_m) {
    region.min_map.z() = mean_m - cell_m;
    region.max_map.z() = mean_m + cell_m;
  }
  return region;
}

// Wherever it looked from there, the landmarks' mean is as far from where it began.
void FirstPlace::restrict_to_region(const std::vector<SeenLandmark>& landmarks,
                                    SearchRegion& region) const {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const SeenLandmark& landmark : landmarks) mean += landmark.p.head<2>();
  mean /= static_cast<double>(landmarks.size());
  const double reach_m = region_->radius_m + (mean - region_->p_odom.head<2>()).norm();
  const Eigen::Vector2d center = region_->p_map.head<2>();
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(reach_m);
  region.min_map.head<2>() = region.min_map.head<2>().cwiseMax(center - reach);
  region.max_map.head<2>() = region.max_map.head<2>().cwiseMin(center + reach);
}

std::optional<Pose> FirstPlace::advance() {
  if (!search_) return std::nullopt;
  if (!search_->advance(static_cast<std::size_t>(config_.turn_evaluations))) {
    const auto limit = static_cast<std::size_t>(config_.max_evaluations);
    if (search_->evaluations() > limit) give_up();
    return std::nullopt;
  }
  const std::vector<FoundPlace>& places = search_->places();
  if (places.size() > static_cast<std::size_t>(config_.max_places)) {
    give_up();
    return std::nullopt;
  }
  if (refined_.size() < places.size()) {
    refine(places[refined_.size()]);
    return std::nullopt;
  }
  search_.reset();
  return decide();
}

// What fits too many places is looked for again when more has been seen.
void FirstPlace::give_up() {
  places_left_ = search_->places().size();
  search_.reset();
}

void FirstPlace::refine(const FoundPlace& place) {
  const Pose T_map_odom = in_map(place);
  const Pose T_map_body = T_map_odom * view_.T_odom_body;
  const PoseWithCovariance prior{T_map_body, prior_covariance(T_map_body)};
  const auto aligned = alignment_.align(moved(view_.landmarks, T_map_odom), prior, gates_);
  refined_.push_back({.T_map_odom = aligned.T_new_old * T_map_odom,
                      .T_map_body = aligned.T_new_old * T_map_body,
                      .score = aligned.score});
}

// From the height above the ground to that in the map: of the ground where the robot is.
Pose FirstPlace::in_map(const FoundPlace& place) const {
  Pose T_map_odom = place.T_map_seen;
  const Eigen::Vector3d p_map = T_map_odom * view_.T_odom_body.p;
  T_map_odom.p.z() += pyramid_->ground().at(p_map.x(), p_map.y()) - view_ground_m_;
  return T_map_odom;
}

// The vertical is known, the place to a cell of the pyramid.
Matrix6d FirstPlace::prior_covariance(const Pose& T_map_body) const {
  Vector6d sigmas_map;
  sigmas_map << config_.prior_tilt_rad, config_.prior_tilt_rad, config_.prior_sigma_rad,
      Eigen::Vector3d::Constant(config_.prior_sigma_m);
  const Matrix6d A = adjoint(inverse(Pose{T_map_body.R, Eigen::Vector3d::Zero()}));
  return A * sigmas_map.cwiseAbs2().asDiagonal() * A.transpose();
}

std::optional<Pose> FirstPlace::decide() {
  if (refined_.empty()) return std::nullopt;
  std::ranges::sort(refined_, {}, &Refined::score);
  const Refined& best = refined_.front();
  places_left_ = 1;
  for (const Refined& other : refined_) {
    const Vector6d beside = local_coordinates(best.T_map_body, other.T_map_body);
    const bool is_same =
        beside.head<3>().norm() < config_.same_rad && beside.tail<3>().norm() < config_.same_m;
    const double log_odds = (other.score - best.score) / alignment_.rival_score();
    if (!is_same && log_odds < config_.min_log_odds) ++places_left_;
  }
  if (places_left_ > 1) return std::nullopt;
  return best.T_map_odom;
}

FirstPlace::Config read_first_place_config(ConfigReader section) {
  return {.ground = read_ground_config(section.section("ground")),
          .max_places = section.integer("max_places", 1, 1000),
          .min_share = section.number("min_share", 0.0, 1.0),
          .same_m = section.positive("same_m"),
          .same_rad = section.positive("same_rad"),
          .max_landmarks = section.integer("max_landmarks", 10, 10000),
          .min_landmarks = section.integer("min_landmarks", 3, 10000),
          .max_sigma_m = section.positive("max_sigma_m"),
          .min_way_m = section.positive("min_way_m"),
          .next_way_m = section.positive("next_way_m"),
          .turn_evaluations = section.integer("turn_evaluations", 1, 1'000'000'000),
          .max_evaluations = section.integer("max_evaluations", 1, 2'000'000'000),
          .prior_sigma_m = section.positive("prior_sigma_m"),
          .prior_sigma_rad = section.positive("prior_sigma_rad"),
          .prior_tilt_rad = section.positive("prior_tilt_rad"),
          .min_log_odds = section.positive("min_log_odds"),
          .known_m = section.positive("known_m"),
          .known_rad = section.positive("known_rad")};
}

}  // namespace fleetloc

#include "cloud/localizer/first_place.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloud/localizer/dead_reckoning.hpp"
#include "cloud/localizer/evenly.hpp"
#include "cloud/locate/storeys.hpp"
#include "shared/geometry/covariance.hpp"

namespace fleetloc {

FirstPlace::FirstPlace(const LaserMap& map,
                       std::shared_ptr<const MapPyramid> pyramid,
                       const RigidAlignment& alignment,
                       const RigidAlignment::Gates& gates,
                       const Config& config,
                       const std::optional<Region>& region)
    : map_(map),
      pyramid_(std::move(pyramid)),
      config_(config),
      region_(region),
      hypotheses_(
          alignment, gates, FreeSpace(map, *pyramid_, config.free_space), config.hypotheses) {}

std::optional<FirstPlace::Region> FirstPlace::region_of(const MapOdomEstimate& start,
                                                        const Config& config) {
  const PoseWithCovariance known = pose_where_known(start);
  const double sigma_m = max_sigma(known.covariance.bottomRightCorner<3, 3>());
  const double sigma_rad = max_sigma(known.covariance.topLeftCorner<3, 3>());
  if (sigma_m <= config.known_m && sigma_rad <= config.known_rad) return std::nullopt;
  constexpr double kSigmas = 3.0;
  return Region{.where = MapRegion::circle(known.T_map_body.p.head<2>(), kSigmas * sigma_m),
                .p_odom = start.p_odom};
}

bool FirstPlace::is_due(double way_m, double travelled_m) const {
  if (is_running_ || way_m < config_.min_way_cells * cell_m()) return false;
  return is_search_due(travelled_m) ||
         (is_ambiguous() && travelled_m - followed_at_m_ >= config_.follow_way_cells * cell_m());
}

bool FirstPlace::is_search_due(double travelled_m) const {
  if (!searched_at_m_) return true;
  const double way_cells = is_ambiguous() ? config_.ambiguous_way_cells : config_.next_way_cells;
  return travelled_m - *searched_at_m_ >= way_cells * cell_m();
}

void FirstPlace::begin(View view, double travelled_m) {
  hypotheses_.see(std::move(view));
  followed_at_m_ = travelled_m;
  was_given_up_ = false;
  if (is_search_due(travelled_m)) begin_search(travelled_m);
  is_whole_ = search_.has_value();
  is_running_ = is_whole_ || hypotheses_.are_waiting();
}

void FirstPlace::begin_search(double travelled_m) {
  const std::vector<SeenLandmark> seen = certain_landmarks();
  auto standing =
      evenly(spread_out(above_ground(seen, config_.ground), config_.spacing_cells * cell_m()),
             config_.max_landmarks);
  if (standing.empty()) return;
  const std::optional<double> camera_height_m = camera_height(seen, config_.ground);
  const std::optional<double> view_ground_m = ground_below_view(camera_height_m, standing);
  SearchRegion region = heights_above_ground(camera_height_m, standing);
  if (region_) restrict_to_region(standing, view_ground_m, region);
  const double log_places = std::log(PlaceSearch::candidates(*pyramid_, standing, region));
  const auto landmarks = static_cast<double>(standing.size());
  if (landmarks < config_.landmarks_per_log_place * log_places) return;
  searched_at_m_ = travelled_m;
  view_ground_m_ = view_ground_m;
  search_.emplace(*pyramid_,
                  standing,
                  region,
                  PlaceSearch::Config{.max_places = config_.max_places + 1,
                                      .min_share = config_.min_share,
                                      .same_m = config_.hypotheses.same_m,
                                      .same_rad = config_.hypotheses.same_rad});
}

// The most certain first.
std::vector<SeenLandmark> FirstPlace::certain_landmarks() const {
  std::vector<std::pair<double, SeenLandmark>> seen;
  for (const WindowLandmark& landmark : hypotheses_.view().landmarks) {
    const double sigma_m = max_sigma(landmark.covariance);
    if (!(sigma_m <= config_.max_sigma_cells * cell_m())) continue;
    seen.push_back({sigma_m, {.p = landmark.p_map, .viewpoint = landmark.viewpoint_map}});
  }
  std::ranges::stable_sort(seen, {}, &std::pair<double, SeenLandmark>::first);
  std::vector<SeenLandmark> result;
  for (auto& [sigma_m, landmark] : seen) result.push_back(landmark);
  return result;
}

void FirstPlace::begin_anew() {
  stop();
  searched_at_m_.reset();
}

void FirstPlace::stop() {
  is_running_ = false;
  search_.reset();
  hypotheses_.clear();
  ambiguous_.clear();
}

// Below the nearest of the viewpoints.
std::optional<double> FirstPlace::ground_below_view(
    const std::optional<double>& camera_height_m,
    const std::vector<SeenLandmark>& landmarks) const {
  if (!camera_height_m || landmarks.empty()) return std::nullopt;
  const auto from_body_m = [this](const SeenLandmark& landmark) {
    return (landmark.viewpoint - hypotheses_.view().T_odom_body.p).norm();
  };
  return std::ranges::min_element(landmarks, {}, from_body_m)->viewpoint.z() - *camera_height_m;
}

// A robot whose camera is at a known height drives on the ground; any other may be at any height.
SearchRegion FirstPlace::heights_above_ground(const std::optional<double>& camera_height_m,
                                              std::vector<SeenLandmark>& landmarks) const {
  double mean_m = 0.0;
  for (SeenLandmark& landmark : landmarks) {
    if (camera_height_m) landmark.p.z() -= landmark.viewpoint.z() - *camera_height_m;
    if (camera_height_m && landmark.p.z() > config_.low_m) landmark.weight = config_.high_weight;
    mean_m += landmark.p.z() / static_cast<double>(landmarks.size());
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

// Wherever it looked from there, the landmarks' mean is as far from where it began. A storey is so
// much above the map's ground as that is uneven there, and the robot may have climbed since.
void FirstPlace::restrict_to_region(const std::vector<SeenLandmark>& landmarks,
                                    const std::optional<double>& view_ground_m,
                                    SearchRegion& region) const {
  const MapRegion& where = region_->where;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const SeenLandmark& landmark : landmarks) mean += landmark.p;
  mean /= static_cast<double>(landmarks.size());
  const Eigen::Vector2d reach =
      Eigen::Vector2d::Constant((mean - region_->p_odom).head<2>().norm());
  region.min_map.head<2>() = region.min_map.head<2>().cwiseMax(where.min_map - reach);
  region.max_map.head<2>() = region.max_map.head<2>().cwiseMin(where.max_map + reach);
  if (!region_->has_borders) return;
  const double cell_m = pyramid_->cell_m();
  region.is_possible = [this](const Pose& T_map_seen) { return is_in_region(in_map(T_map_seen)); };
  if (!is_storey_told()) return;
  const auto [lowest_ground_m, highest_ground_m] =
      pyramid_->ground().range(region.min_map.head<2>(), region.max_map.head<2>());
  const double robot_m =
      region_->p_odom.z() - (view_ground_m ? hypotheses_.view().T_odom_body.p.z() : 0.0);
  region.min_map.z() = mean.z() + where.lowest_m - highest_ground_m - robot_m - cell_m;
  region.max_map.z() = mean.z() + where.highest_m - lowest_ground_m - robot_m + cell_m;
}

// Above the ground, if that is known, or above what is told of it otherwise: itself.
double FirstPlace::body_height_m() const {
  return view_ground_m_ ? hypotheses_.view().T_odom_body.p.z() - *view_ground_m_ : 0.0;
}

bool FirstPlace::is_storey_told() const {
  return region_ && region_->has_borders && region_->where.lowest_m > -MapRegion::kUnlimited;
}

// As exactly as a search finds places.
bool FirstPlace::is_in_region(const Pose& T_map_odom) const {
  const Eigen::Vector3d p_map = T_map_odom * region_->p_odom;
  return region_->where.has(p_map.head<2>(), 2.0 * cell_m()) &&
         region_->where.has_storey(p_map.z() - body_height_m(), cell_m());
}

bool FirstPlace::is_within_borders(const Pose& T_map_odom) const {
  return !region_ || !region_->has_borders || is_in_region(T_map_odom);
}

std::optional<Pose> FirstPlace::advance() {
  if (!is_running_) return std::nullopt;
  if (search_) {
    search();
    return std::nullopt;
  }
  if (hypotheses_.align_next()) return std::nullopt;
  return decide();
}

void FirstPlace::search() {
  const bool has_ended = search_->advance(static_cast<std::size_t>(config_.turn_evaluations));
  const std::vector<FoundPlace>& places = search_->places();
  const bool is_too_long =
      search_->evaluations() > static_cast<std::size_t>(config_.max_evaluations);
  const bool are_too_many = places.size() > static_cast<std::size_t>(config_.max_places);
  if (!has_ended && !is_too_long) return;
  note_explained();
  if (!has_ended || are_too_many) return give_up();
  for (const FoundPlace& place : places) add_with_storeys(in_map(place.T_map_seen));
  search_.reset();
}

void FirstPlace::note_explained() {
  const std::vector<FoundPlace>& places = search_->places();
  explained_ = places.empty() ? search_->max_score_of_rest() : places.front().score;
  ++searches_;
}

// What fits too many places, or none, is looked for again when more has been seen. Places that were
// followed until then still are.
void FirstPlace::give_up() {
  is_only_one_left_ = false;
  if (!hypotheses_.are_waiting()) {
    places_left_ = search_->places().size();
    return stop();
  }
  search_.reset();
  is_whole_ = false;
  was_given_up_ = true;
}

// Storeys look alike, and of a robot that drives only the lowest ground has been searched, unless
// its storey is told.
void FirstPlace::add_with_storeys(const Pose& T_map_odom) {
  hypotheses_.add(T_map_odom);
  if (!view_ground_m_ || is_storey_told()) return;
  const Eigen::Vector3d p_map = T_map_odom * hypotheses_.view().T_odom_body.p;
  const double ground_m = pyramid_->ground().at(p_map.x(), p_map.y());
  for (const double storey_m : storeys_above(map_, p_map.head<2>(), ground_m)) {
    Pose T_storey_odom = T_map_odom;
    T_storey_odom.p.z() += storey_m - ground_m;
    hypotheses_.add(T_storey_odom);
  }
}

// From the height above the ground to that in the map: of the ground where the robot is.
Pose FirstPlace::in_map(const Pose& T_map_seen) const {
  Pose T_map_odom = T_map_seen;
  const Eigen::Vector3d p_map = T_map_odom * hypotheses_.view().T_odom_body.p;
  T_map_odom.p.z() += pyramid_->ground().at(p_map.x(), p_map.y()) - view_ground_m_.value_or(0.0);
  return T_map_odom;
}

// Places that are followed are not all there are: only a search tells that none but one is left.
std::optional<Pose> FirstPlace::decide() {
  is_running_ = false;
  // An alignment may have moved a place across the borders.
  hypotheses_.drop_if([this](const Pose& T_map_odom) { return !is_within_borders(T_map_odom); });
  hypotheses_.keep_likely(static_cast<std::size_t>(config_.max_places));
  const std::vector<PlaceHypotheses::Place>& places = hypotheses_.places();
  places_left_ = places.size();
  is_only_one_left_ = places_left_ == 1 && (is_whole_ || is_only_one_left_);
  ambiguous_.clear();
  if (places_left_ > 1) ambiguous_ = places;
  if (places_left_ != 1) return std::nullopt;
  if (is_whole_) return places.front().T_map_odom;
  if (!was_given_up_) searched_at_m_.reset();
  return std::nullopt;
}

FirstPlace::Config read_first_place_config(ConfigReader section) {
  return {.ground = read_ground_config(section.section("ground")),
          .free_space = read_free_space_config(section.section("free_space")),
          .hypotheses = read_place_hypotheses_config(section.section("hypotheses")),
          .max_places = section.integer("max_places", 1, 1000),
          .min_share = section.number("min_share", 0.0, 1.0),
          .min_explained = section.number("min_explained", 0.0, 1.0),
          .spacing_cells = section.positive("spacing_cells"),
          .max_sigma_cells = section.positive("max_sigma_cells"),
          .low_m = section.number("low_m", 0.0, 100.0),
          .high_weight = section.integer("high_weight", 1, 100),
          .max_landmarks = section.integer("max_landmarks", 10, 10000),
          .landmarks_per_log_place = section.number("landmarks_per_log_place", 0.0, 5.0),
          .min_way_cells = section.positive("min_way_cells"),
          .next_way_cells = section.positive("next_way_cells"),
          .ambiguous_way_cells = section.positive("ambiguous_way_cells"),
          .follow_way_cells = section.positive("follow_way_cells"),
          .turn_evaluations = section.integer("turn_evaluations", 1, 1'000'000'000),
          .max_evaluations = section.integer("max_evaluations", 1, 2'000'000'000),
          .known_m = section.positive("known_m"),
          .known_rad = section.positive("known_rad")};
}

}  // namespace fleetloc

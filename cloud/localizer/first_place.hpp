#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "cloud/localizer/map_match.hpp"
#include "cloud/localizer/rigid_alignment.hpp"
#include "cloud/locate/above_ground.hpp"
#include "cloud/locate/map_pyramid.hpp"
#include "cloud/locate/place_search.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Looks for where a robot is of which nobody has told. What it has seen is looked for in the whole
/// map (PlaceSearch), each place that explains it well is refined (RigidAlignment), and the best
/// one is taken if its odds against the second best are beyond doubt. Otherwise it is done again
/// with what is seen some metres further on.
///
/// Works in turns of bounded length. Deterministic, no threads, no clock.
class FirstPlace {
 public:
  struct Config {
    GroundConfig ground;
    int max_places;        ///< that are refined; if there are more, none is certain
    double min_share;      ///< of the best place's score in PlaceSearch
    double same_m;         ///< places nearer than this and
    double same_rad;       ///< turned by less than this are one
    int max_landmarks;     ///< are looked for, evenly sampled
    int min_landmarks;     ///< above the ground: fewer say nothing
    double max_sigma_m;    ///< of a landmark
    double min_way_m;      ///< driven in the window
    double next_way_m;     ///< driven from one search to the next
    int turn_evaluations;  ///< of a landmark, in a turn
    int max_evaluations;   ///< in a search; then it is given up
    double prior_sigma_m;  ///< of a place that PlaceSearch has found
    double prior_sigma_rad;
    double prior_tilt_rad;  ///< of the odometry's vertical axis
    double min_log_odds;    ///< of the best place against the second best
    double known_m;         ///< sigmas of a start pose: up to both
    double known_rad;       ///< of them nothing is searched
  };

  /// What the robot has seen last, in odom.
  struct View {
    std::vector<WindowLandmark> landmarks;
    Pose T_odom_body;  ///< of the newest keyframe
  };

  /// Where the robot was when its session began, as far as that is known.
  struct Region {
    Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
    Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< there
  };

  /// Nothing if the start pose is known so well that it is no region, but a place.
  static std::optional<Region> region_of(const MapOdomEstimate& start, const Config& config);

  /// @param alignment  outlives this
  /// @param region     none: the whole map
  FirstPlace(std::shared_ptr<const MapPyramid> pyramid,
             const RigidAlignment& alignment,
             const RigidAlignment::Gates& gates,
             const Config& config,
             const std::optional<Region>& region = std::nullopt);

  /// Whether a search is to begin.
  /// @param way_m        by the odometry, from the window's oldest to its newest keyframe
  /// @param travelled_m  by the odometry, until the newest one
  [[nodiscard]] bool is_due(double way_m, double travelled_m) const;

  void begin(View view, double travelled_m);

  /// Whatever was tried on the way so far, the next search is due.
  void begin_anew() { begun_at_m_.reset(); }

  /// In the whole map, wherever the session began.
  void forget_region() { region_.reset(); }

  /// Gives up a search that is running.
  void stop() { search_.reset(); }

  /// One turn.
  /// @return T_map_odom of the place, once it is certain
  std::optional<Pose> advance();

  /// How exactly a place is found.
  [[nodiscard]] double cell_m() const { return pyramid_->cell_m(); }

  /// Whether a search has begun and not ended.
  [[nodiscard]] bool is_running() const { return search_.has_value(); }

  /// That the last search could not tell apart, as far as it had come; 0 if none has ended.
  [[nodiscard]] std::size_t places_left() const { return places_left_; }

 private:
  struct Refined {
    Pose T_map_odom;
    Pose T_map_body;
    double score = 0.0;  // the smaller, the better
  };

  /// Takes the landmarks' heights from odom to the ground below the camera that saw them.
  SearchRegion heights_above_ground(const std::optional<double>& camera_height_m,
                                    std::vector<SeenLandmark>& landmarks);
  void restrict_to_region(const std::vector<SeenLandmark>& landmarks, SearchRegion& region) const;
  [[nodiscard]] Pose in_map(const FoundPlace& place) const;
  void give_up();
  void refine(const FoundPlace& place);
  std::optional<Pose> decide();
  [[nodiscard]] Matrix6d prior_covariance(const Pose& T_map_body) const;

  std::shared_ptr<const MapPyramid> pyramid_;
  const RigidAlignment& alignment_;
  RigidAlignment::Gates gates_;
  Config config_;
  std::optional<Region> region_;

  View view_;
  double view_ground_m_ = 0.0;        // below the newest view, in odom; 0 if it is not known
  std::optional<double> begun_at_m_;  // travelled, of the last search
  std::optional<PlaceSearch> search_;
  std::vector<Refined> refined_;
  std::size_t places_left_ = 0;
};

FirstPlace::Config read_first_place_config(ConfigReader section);

}  // namespace fleetloc

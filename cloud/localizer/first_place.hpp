#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "cloud/laser_map/map_regions.hpp"
#include "cloud/localizer/place_hypotheses.hpp"
#include "cloud/localizer/rigid_alignment.hpp"
#include "cloud/locate/above_ground.hpp"
#include "cloud/locate/map_pyramid.hpp"
#include "cloud/locate/place_search.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Looks for where a robot is of which nobody has told. What it has seen is looked for in the whole
/// map (PlaceSearch), and each place that explains it well is aligned with it (PlaceHypotheses).
/// The best one is taken if its odds against any other are beyond doubt. Otherwise those that are
/// left are followed as the robot moves, until only one is; then, and after some way, the whole map
/// is searched again, so that no place is taken because others have been overlooked.
///
/// Works in turns of bounded length. Deterministic, no threads, no clock.
class FirstPlace {
 public:
  struct Config {
    GroundConfig ground;
    FreeSpace::Config free_space;
    PlaceHypotheses::Config hypotheses;
    int max_places;        ///< that are aligned; if there are more, none is certain
    double min_share;      ///< of the best place's score in PlaceSearch
    double min_explained;  ///< share of the landmarks, by weight; with less it is not in the map
    /// What follows in cells is relative to those of the pyramid: smaller in a room.
    double spacing_cells;    ///< of landmarks: what stands together is one witness
    double max_sigma_cells;  ///< of a landmark
    double low_m;            ///< above the ground; lower things may be gone, such as vehicles
    int high_weight;         ///< of the higher ones, that of the lower ones is 1
    int max_landmarks;       ///< are looked for, evenly sampled
    /// Above the ground, of ln(places there are): fewer are too few to tell that many apart.
    double landmarks_per_log_place;
    double min_way_cells;        ///< driven in the window
    double next_way_cells;       ///< driven from one search to the next,
    double ambiguous_way_cells;  ///< the same while places are followed,
    double follow_way_cells;     ///< and from one of their alignments to the next
    int turn_evaluations;        ///< of a landmark, in a turn
    int max_evaluations;         ///< in a search; then it is given up
    double known_m;              ///< sigmas of a start pose: up to both
    double known_rad;            ///< of them nothing is searched
  };

  using View = PlaceHypotheses::View;

  /// Where the robot was when its session began, as far as that is known.
  struct Region {
    MapRegion where;
    Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< of the body there
    /// Places beyond are none; otherwise it only says where to look.
    bool has_borders = false;
  };

  /// Nothing if the start pose is known so well that it is no region, but a place.
  static std::optional<Region> region_of(const MapOdomEstimate& start, const Config& config);

  /// @param alignment  outlives this, like the map
  /// @param pyramid    of the map
  /// @param region     none: the whole map
  FirstPlace(const LaserMap& map,
             std::shared_ptr<const MapPyramid> pyramid,
             const RigidAlignment& alignment,
             const RigidAlignment::Gates& gates,
             const Config& config,
             const std::optional<Region>& region = std::nullopt);

  FirstPlace(const FirstPlace&) = delete;  // its search refers to it
  FirstPlace& operator=(const FirstPlace&) = delete;

  /// Whether places are to be searched or followed.
  /// @param way_m        by the odometry, from the window's oldest to its newest keyframe
  /// @param travelled_m  by the odometry, until the newest one
  [[nodiscard]] bool is_due(double way_m, double travelled_m) const;

  /// What is due.
  void begin(View view, double travelled_m);

  /// Whatever was tried on the way so far, the next search is due.
  void begin_anew();

  /// In the whole map, wherever the session began.
  void forget_region() { region_.reset(); }

  /// Gives up what is running.
  void stop();

  /// One turn.
  /// @return T_map_odom of the place, once it is certain
  std::optional<Pose> advance();

  /// Whether the session can have begun where this has it, by the borders that were told.
  [[nodiscard]] bool is_within_borders(const Pose& T_map_odom) const;

  /// How exactly a place is found.
  [[nodiscard]] double cell_m() const { return pyramid_->cell_m(); }

  /// Whether a search, or the alignment of places that are followed, has begun and not ended.
  [[nodiscard]] bool is_running() const { return is_running_; }

  /// Places that could not be told apart so far, if there are several, and few enough to be
  /// followed; the likeliest first.
  [[nodiscard]] bool is_ambiguous() const { return !ambiguous_.empty(); }
  [[nodiscard]] const std::vector<PlaceHypotheses::Place>& ambiguous() const { return ambiguous_; }

  /// Whether the last search of the whole map has left one place. One that was given up has not:
  /// more places explain as much than can be told apart.
  [[nodiscard]] bool is_only_one_left() const { return is_only_one_left_; }

  /// That the last search could not tell apart, as far as it had come; 0 if none has ended.
  [[nodiscard]] std::size_t places_left() const { return places_left_; }

  /// That have ended or were given up.
  [[nodiscard]] std::size_t searches() const { return searches_; }

  /// Share of the landmarks, by their weights, that the best place of the latest search explains,
  /// or as much as any place can if the search was given up before; 1 before the first search.
  [[nodiscard]] double explained() const { return explained_; }

  /// Whether no place explains enough of what was seen: the robot is not in the map, or not in the
  /// region that was told.
  [[nodiscard]] bool is_off_map() const { return explained_ < config_.min_explained; }

 private:
  [[nodiscard]] bool is_search_due(double travelled_m) const;
  void begin_search(double travelled_m);
  [[nodiscard]] std::vector<SeenLandmark> certain_landmarks() const;
  [[nodiscard]] std::optional<double> ground_below_view(
      const std::optional<double>& camera_height_m,
      const std::vector<SeenLandmark>& landmarks) const;
  /// Takes the landmarks' heights from odom to the ground below the camera that saw them.
  [[nodiscard]] SearchRegion heights_above_ground(const std::optional<double>& camera_height_m,
                                                  std::vector<SeenLandmark>& landmarks) const;
  void restrict_to_region(const std::vector<SeenLandmark>& landmarks,
                          const std::optional<double>& view_ground_m,
                          SearchRegion& region) const;
  [[nodiscard]] Pose in_map(const Pose& T_map_seen) const;
  void add_with_storeys(const Pose& T_map_odom);
  [[nodiscard]] bool is_storey_told() const;
  [[nodiscard]] bool is_in_region(const Pose& T_map_odom) const;
  [[nodiscard]] double body_height_m() const;
  void search();
  void note_explained();
  void give_up();
  std::optional<Pose> decide();

  const LaserMap& map_;
  std::shared_ptr<const MapPyramid> pyramid_;
  Config config_;
  std::optional<Region> region_;
  PlaceHypotheses hypotheses_;

  std::optional<double> view_ground_m_;  // below the view of the last search, in odom, if known
  std::optional<double> searched_at_m_;  // travelled, of the last search
  double followed_at_m_ = 0.0;           // of the last alignment of places
  bool is_running_ = false;
  bool is_whole_ = false;              // what is running, or ran last, is of the whole map
  bool was_given_up_ = false;          // a search that began with it
  bool is_only_one_left_ = false;      // after the last search of the whole map
  std::optional<PlaceSearch> search_;  // until it has ended
  std::vector<PlaceHypotheses::Place> ambiguous_;
  std::size_t places_left_ = 0;
  std::size_t searches_ = 0;
  double explained_ = 1.0;
};

FirstPlace::Config read_first_place_config(ConfigReader section);

}  // namespace fleetloc

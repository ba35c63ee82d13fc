#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "cloud/localizer/map_match.hpp"
#include "cloud/localizer/rigid_alignment.hpp"
#include "cloud/locate/free_space.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Places of the map at which a robot may be, and that what it has seen does not tell apart. They
/// are followed as the robot moves: each is aligned with what is seen then, from where it was.
class PlaceHypotheses {
 public:
  struct Config {
    double sigma_m;  ///< how exactly a place is known before it is aligned
    double sigma_rad;
    double sigma_tilt_rad;  ///< of the odometry's vertical axis
    double same_m;          ///< places nearer than this and
    double same_rad;        ///< turned by less than this are one
    double min_log_odds;    ///< of the best one against a place that is given up
    int rays;               ///< to landmarks, evenly sampled, that must be free
    double blocked_score;   ///< of a ray that is not, as a score of RigidAlignment
    int turn_starts;        ///< of an alignment, in a turn
  };

  /// What the robot has seen last, in odom.
  struct View {
    std::vector<WindowLandmark> landmarks;
    Pose T_odom_body;  ///< of the newest keyframe
  };

  struct Place {
    Pose T_map_odom;
    Pose T_map_body;        ///< of the view's newest keyframe
    double score = 0.0;     ///< the smaller, the better
    double log_odds = 0.0;  ///< of the best place against this one
  };

  /// @param alignment  outlives this, like what free_space refers to
  PlaceHypotheses(const RigidAlignment& alignment,
                  const RigidAlignment::Gates& gates,
                  const FreeSpace& free_space,
                  const Config& config)
      : alignment_(alignment), gates_(gates), free_space_(free_space), config_(config) {}

  /// All places are to be aligned with this.
  void see(View view);
  [[nodiscard]] const View& view() const { return view_; }

  /// Another place, as far as it is known, which is to be aligned with the view.
  /// No alignment may have begun.
  void add(const Pose& T_map_odom);

  [[nodiscard]] bool are_waiting() const { return !waiting_.empty(); }

  /// Goes on with the alignment of those that wait, one after another.
  /// @return whether one was left
  bool align_next();

  /// Once all are aligned: drops those whose T_map_odom this holds for.
  void drop_if(const std::function<bool(const Pose&)>& is_impossible);

  /// Once all are aligned: keeps those of which the best one is not certain, so many at most.
  void keep_likely(std::size_t max_places);

  void clear();

  /// That are aligned, the best first.
  [[nodiscard]] const std::vector<Place>& places() const { return places_; }

 private:
  void begin_alignment();
  void end_alignment();
  [[nodiscard]] Matrix6d prior_covariance(const Pose& T_map_body) const;
  [[nodiscard]] int blocked_rays(const Pose& T_map_odom) const;

  const RigidAlignment& alignment_;
  RigidAlignment::Gates gates_;
  FreeSpace free_space_;
  Config config_;
  View view_;
  std::vector<Pose> waiting_;                   // T_map_odom
  std::optional<RigidAlignment::Run> running_;  // of the last one
  std::vector<Place> places_;
};

/// Of a body: so near to each other, and turned by so little, that they are one.
bool is_same_place(const Pose& T_map_one,
                   const Pose& T_map_other,
                   const PlaceHypotheses::Config& config);

PlaceHypotheses::Config read_place_hypotheses_config(ConfigReader section);

}  // namespace fleetloc

#pragma once

#include <optional>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/map_association.hpp"
#include "cloud/localizer/pose_with_covariance.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// Moves the window as one rigid body onto the map, for poses that are known too roughly for the
/// association of single landmarks to be trusted: iterative closest point (ICP) from several starts
/// around a prior, of which the best result is taken.
class RigidAlignment {
 public:
  struct Config {
    int iterations;        ///< of each start
    int max_landmarks;     ///< evenly sampled from all
    double start_sigmas;   ///< distance of the starts from the prior, in its sigmas
    double kernel;         ///< Cauchy, in standard deviations
    double lifted_weight;  ///< of landmarks above level ground, as on snow
    double rival_step_m;   ///< starts for rivals of the best place, along its weakest direction
    int rival_steps;       ///< to either side
    double rival_score;    ///< in which the odds of a rival fall by e
  };
  struct Gates {
    double first_m;
    double final_m;
  };

  RigidAlignment(const LaserMap& map, const AssociationConfig& association, const Config& config)
      : map_(map), association_(association), config_(config) {}

  struct Result {
    Pose T_new_old;      ///< in the map: x_map is to become T_new_old * x_map
    double score = 0.0;  ///< the smaller, the better
    /// What is to be added to the covariance of the prior's keyframe there (right perturbation),
    /// since other places fit nearly as well: their mean square distance, by their odds.
    Matrix6d rivals = Matrix6d::Zero();
  };

  /// @param prior  of one keyframe of the window, at its present estimate
  /// @param guess  another start, as T_new_old
  [[nodiscard]] Result align(const std::vector<WindowLandmark>& landmarks,
                             const PoseWithCovariance& prior,
                             const Gates& gates,
                             const std::optional<Pose>& guess = std::nullopt) const;

  /// The same, start by start: for work in turns.
  class Run;

  /// In which the odds of a place fall by e.
  [[nodiscard]] double rival_score() const { return config_.rival_score; }

 private:
  struct Aligned {
    Pose T_new_old;
    double score = 0.0;                       // the smaller, the better
    Matrix6d information = Matrix6d::Zero();  // of a turn about the keyframe and a shift, map axes
  };

  [[nodiscard]] Aligned descend(const std::vector<WindowLandmark>& landmarks,
                                const PoseWithCovariance& prior,
                                const Gates& gates,
                                const Pose& start) const;
  [[nodiscard]] Matrix6d rivals_of(const std::vector<Aligned>& results,
                                   const Pose& T_old_body) const;
  [[nodiscard]] double score(const std::vector<WindowLandmark>& landmarks,
                             const PoseWithCovariance& prior,
                             double gate_m,
                             const Pose& T_new_old) const;

  const LaserMap& map_;
  const AssociationConfig& association_;
  const Config& config_;
};

class RigidAlignment::Run {
 public:
  /// See align().
  /// @param alignment  outlives this
  Run(const RigidAlignment& alignment,
      const std::vector<WindowLandmark>& landmarks,
      const PoseWithCovariance& prior,
      const Gates& gates,
      const std::optional<Pose>& guess = std::nullopt);

  /// Goes on from the next start.
  /// @return whether there was one
  bool advance();

  /// Once there is no start left.
  [[nodiscard]] Result result();

 private:
  void add_rivals();

  const RigidAlignment& alignment_;
  std::vector<WindowLandmark> landmarks_;  // sampled
  PoseWithCovariance prior_;
  Gates gates_;
  std::vector<Pose> starts_;
  bool has_rivals_ = false;  // starts beside the best place
  std::vector<Aligned> results_;
};

/// x_map becomes T_new_old * x_map.
std::vector<WindowLandmark> moved(std::vector<WindowLandmark> landmarks, const Pose& T_new_old);

RigidAlignment::Config read_rigid_alignment_config(ConfigReader section);

}  // namespace fleetloc

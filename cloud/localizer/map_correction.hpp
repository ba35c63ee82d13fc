#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "cloud/localizer/window_system.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/time.hpp"
#include "shared/model/correction.hpp"

namespace fleetloc {

struct CorrectionConfig {
  int keyframes;                ///< number of the latest ones, at most, which are corrected
  int robot_window;             ///< keyframes; what has left the robot's window is of no use
  int max_landmarks;            ///< those with the largest information gain
  double max_landmark_sigma_m;  ///< by the robot's measurements, given its poses
  double min_gain;              ///< items with a smaller information gain are not sent [nat]
  double pose_floor_rad;  ///< added to the standard deviations of what is sent: systematic errors
  double pose_floor_m;
  double landmark_floor_m;
  /// Factor of the covariances. The items' errors are correlated, but the robot takes them as
  /// independent: calibrated so that its estimate from all of them together is consistent.
  double pose_inflation;
  double landmark_inflation;
};

/// Covariances of relative quantities, from the robot's own measurements alone and with the map; of
/// the errors as stated in Correction. They are marginals over the window's pose in the map: a
/// shift or rotation of the whole map has no effect.
struct RelativeMarginals {
  template <int N>
  struct Covariances {
    Eigen::Matrix<double, N, N> without_map = Eigen::Matrix<double, N, N>::Zero();
    Eigen::Matrix<double, N, N> with_map = Eigen::Matrix<double, N, N>::Zero();

    /// Information gain by the map: half the log of the determinants' ratio [nat].
    [[nodiscard]] double gain() const;
  };
  struct RelativePose {
    KeyframeId from{};
    KeyframeId to{};
    Pose T_from_to;
    Covariances<6> covariances;
  };
  struct Landmark {
    LandmarkId id{};
    Eigen::Vector3d p_anchor = Eigen::Vector3d::Zero();  ///< in body at the anchor [m]
    Covariances<3> covariances;
  };

  KeyframeId anchor{};                       ///< the newest keyframe
  std::vector<RelativePose> relative_poses;  ///< increasing by `to`
  std::vector<Landmark> landmarks;           ///< increasing by id
};

/// How many of the latest keyframes (the paper's l) the robot will still have in its window when a
/// correction arrives, at most `config.keyframes`.
/// @param interval    between keyframes; none are corrected if it is not positive
/// @param round_trip  of the network: from sending a keyframe to the arrival of its answer
int correctable_keyframes(Duration interval, Duration round_trip, const CorrectionConfig& config);

/// For the latest `keyframes` keyframes and the matched landmarks that they observe, at most
/// twice `config.max_landmarks` of these. To other landmarks the map adds nothing beyond the
/// relative poses.
/// @return nothing if one of the systems is singular
std::optional<RelativeMarginals> relative_marginals(const WindowSystem& system,
                                                    int keyframes,
                                                    const CorrectionConfig& config);

/// The items of a correction (for e_pp and e_rt; paper, eq. 9 and 10): values with the map, and the
/// information that only the map has added. So an answer can only pull the robot's estimate towards
/// the cloud's, never beyond it, however often information is counted.
Correction map_correction(const RelativeMarginals& marginals, const CorrectionConfig& config);

CorrectionConfig read_correction_config(ConfigReader section);

}  // namespace fleetloc

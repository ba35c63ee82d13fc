#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "cloud/localizer/window_system.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/model/correction.hpp"

namespace fleetloc {

struct CorrectionConfig {
  int keyframes;                ///< the latest so many are corrected
  int max_landmarks;            ///< those of which the map says most
  double max_landmark_sigma_m;  ///< by the robot's measurements, given its poses
  double min_gain;              ///< an item of which the map says less is not sent [nat]
  double pose_floor_rad;  ///< added to the standard deviations of what is sent: systematic errors
  double pose_floor_m;
  double landmark_floor_m;
  /// Of the covariances. The items' errors are correlated, and the robot counts them as
  /// independent: calibrated so that what it makes of all of them together is honest.
  double pose_inflation;
  double landmark_inflation;
};

/// What is known of relative quantities: by the robot's own measurements alone, and with the map.
/// Covariances of the errors as stated in Correction. All of them are marginals: the pose of the
/// window in the map is as uncertain as it is, so that a map that is shifted or turned as a whole
/// changes nothing.
struct RelativeKnowledge {
  template <int N>
  struct Covariances {
    Eigen::Matrix<double, N, N> of_robot = Eigen::Matrix<double, N, N>::Zero();
    Eigen::Matrix<double, N, N> with_map = Eigen::Matrix<double, N, N>::Zero();

    /// How much more the map says: half the log of the determinants' ratio [nat].
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
    Eigen::Vector3d p_anchor = Eigen::Vector3d::Zero();
    Covariances<3> covariances;
  };

  KeyframeId anchor{};                       ///< the newest keyframe
  std::vector<RelativePose> relative_poses;  ///< increasing by `to`
  std::vector<Landmark> landmarks;           ///< increasing by id
};

/// Of the latest `config.keyframes` keyframes and the matched landmarks that they see, at most
/// twice `config.max_landmarks` of these. Other landmarks have nothing from the map but what they
/// have through the relative poses. Nothing if one of the systems is singular.
std::optional<RelativeKnowledge> relative_knowledge(const WindowSystem& system,
                                                    const CorrectionConfig& config);

/// The items of a correction: values with the map, and the information that only the map has
/// added. With the values an answer can only draw the robot's estimate towards the cloud's, never
/// beyond it, however often information is counted.
Correction map_correction(const RelativeKnowledge& knowledge, const CorrectionConfig& config);

CorrectionConfig read_correction_config(ConfigReader section);

}  // namespace fleetloc

#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "robot/inertial/inertial_window.hpp"
#include "robot/submap/landmark_selection.hpp"
#include "robot/submap/sparsification.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// A keyframe of the odometry's window.
struct SubmapInputKeyframe {
  KeyframeId id{};
  Timestamp stamp;
  double tilt_sigma = 0.0;  ///< of roll and pitch, without what came from the cloud [rad]
  std::vector<StereoObservation> observations;  ///< strictly increasing by landmark
};

/// The odometry's window after an optimization.
struct SubmapInput {
  InertialWindow inertial;                     ///< states of the same keyframes
  std::vector<SubmapInputKeyframe> keyframes;  ///< oldest first, strictly increasing by id
  std::vector<CandidateLandmark> landmarks;    ///< strictly increasing by id
};

/// Builds the paper's virtual observation from each window of one session.
///
/// An observation that was sent is repeated with its keyframe in later submaps. The odometry drops
/// a landmark's last observations when it marginalizes the first one, and in fast motion that is
/// most of them; the cloud, whose window is longer, would lose them with the keyframe's next
/// revision. Only observations that the odometry has rejected are removed.
class SubmapBuilder {
 public:
  struct Config {
    InertialModel model;
    /// An edge is final as soon as that many newer ones are in the window; it is repeated unchanged
    /// from then on. Recomputed as it slides through the window, its covariance would only shrink.
    int final_behind_edges;
    /// Factor on the covariance of each edge: edges of a chain count as independent, and are not.
    double edge_covariance_inflation;
    bool use_tilt;
    double tilt_floor_rad;
    LandmarkSelection landmarks;
  };

  struct Diagnostics {
    std::optional<SparsificationRefusal> refusal;  ///< no new edges
    double kl_divergence = 0.0;  ///< of the dense distribution from the edges, not inflated [nat]
    int reliable_landmarks = 0;  ///< whether there was room for them or not
    int selected_landmarks = 0;
  };

  explicit SubmapBuilder(const Config& config);

  /// Robot, session, incarnation and number are set by the sender. Revisions start at one,
  /// and increase when an item differs from what it was in the submap before.
  Submap build(const SubmapInput& input);

  [[nodiscard]] const Diagnostics& diagnostics() const { return diagnostics_; }

 private:
  struct SentEdge {
    VirtualEdge edge;
    bool final = false;
  };
  using EdgeKey = std::pair<KeyframeId, KeyframeId>;  // to, from

  /// Observations of a keyframe, including those that the odometry has marginalized out.
  [[nodiscard]] std::vector<StereoObservation> with_marginalized(
      const SubmapInputKeyframe& keyframe) const;
  void record_marginalized(const SubmapInput& input);
  void update_edges(const SubmapInput& input);
  void update_edge(const EdgeKey& key, const RelativePose& relative, bool final);
  void add_keyframes(const SubmapInput& input, Submap& submap);
  [[nodiscard]] double tilt_sigma(const SubmapInputKeyframe& keyframe) const;
  void forget_before(KeyframeId oldest);

  Config config_;
  std::map<LandmarkId, Eigen::Vector3d> sent_landmarks_;  ///< p_odom, as estimated last [m]
  std::set<LandmarkId> marginalized_;  ///< of them, left the window with a keyframe
  std::map<KeyframeId, SubmapKeyframe> sent_keyframes_;
  std::map<EdgeKey, SentEdge> sent_edges_;
  Diagnostics diagnostics_;
};

SubmapBuilder::Config read_submap_builder_config(ConfigReader section);

}  // namespace fleetloc

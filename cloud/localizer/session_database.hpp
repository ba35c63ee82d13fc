#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "shared/model/submap.hpp"

namespace fleetloc {

/// The keyframes, observations, landmarks and edges that one robot has sent in one session, and the
/// cloud's solution for them. Items are identified by their ids: the newer revision replaces the
/// older one, and nothing is counted twice. Either half of a keyframe's observations has a revision
/// of its own, so that samples with one of them may come in any order.
///
/// Bounded: what is older than the latest `window` keyframes is removed.
class SessionDatabase {
 public:
  struct Config {
    int window;  ///< keyframes
    /// Where the robot was blind for longer than this, the edge across, if it tells the position no
    /// better than to this sigma, does not hold a window together.
    double blind_s = std::numeric_limits<double>::infinity();
    double loose_edge_m = std::numeric_limits<double>::infinity();
  };

  struct Keyframe {
    SubmapKeyframe item;
    /// Of its observations, by ObservationSubset{2, i}: a sample may hold every second one.
    std::array<Revision, 2> halves{};
    std::optional<Pose> T_map_body;  ///< the cloud's solution; a new revision does not reset it
  };

  struct Landmark {
    /// The robot's estimate, relative to a keyframe of the same submap: it stays valid however
    /// `odom` moves. Nothing if the robot sent none, or if the keyframe was removed.
    struct Estimate {
      KeyframeId keyframe{};
      Eigen::Vector3d p_body = Eigen::Vector3d::Zero();
    };
    std::optional<Estimate> estimate;
    std::optional<Eigen::Vector3d> p_map;  ///< the cloud's solution
  };

  /// Counts of the items of a submap, by what became of them.
  struct Added {
    int stored = 0;    ///< new, or a newer revision
    int repeated = 0;  ///< known already
    int stale = 0;     ///< older than the window
    friend auto operator<=>(const Added&, const Added&) = default;
  };

  explicit SessionDatabase(const Config& config) : config_(config) {}

  Added add(const Submap& submap);

  /// What the robot has sent stays.
  void forget_solutions();

  /// As if nothing before this keyframe, which there must be, had ever been sent.
  void forget_before(KeyframeId first);

  [[nodiscard]] bool empty() const { return keyframes_.empty(); }

  /// The keyframes that edges hold together with the newest one, oldest first.
  [[nodiscard]] std::vector<KeyframeId> window() const;

  /// The edges that hold keyframes together, without loops, the shortest first (Kruskal, 1956):
  /// longer ones only bridge the gaps between, since they span the same IMU samples and would count
  /// them twice.
  ///
  /// A loose edge holds if landmarks are seen from both sides. What hangs on it alone would not be
  /// rigid: the keyframes before it would keep their place in the map, and those behind it slip to
  /// wherever chance matches them.
  [[nodiscard]] std::vector<const VirtualEdge*> spanning_edges() const;

  [[nodiscard]] const Keyframe& newest() const { return keyframes_.rbegin()->second; }
  [[nodiscard]] const Keyframe& keyframe(KeyframeId id) const { return keyframes_.at(id); }
  [[nodiscard]] const std::map<KeyframeId, Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] const std::map<LandmarkId, Landmark>& landmarks() const { return landmarks_; }

  /// The landmarks that these keyframes observe, sorted; some several times.
  [[nodiscard]] std::vector<LandmarkId> seen_by(std::span<const KeyframeId> keyframes) const;

  /// Poses in the map for the keyframes of `window`: the cloud's solution where there is one, else
  /// chained along spanning edges from a solved keyframe, else by `T_map_odom` where no solved
  /// keyframe is connected.
  [[nodiscard]] std::map<KeyframeId, Pose> placed(const std::vector<KeyframeId>& window,
                                                  const Pose& T_map_odom) const;

  void store_solution(KeyframeId id, const Pose& T_map_body);
  void store_solution(LandmarkId id, const Eigen::Vector3d& p_map);

  /// Approximate.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  using EdgeKey = std::pair<KeyframeId, KeyframeId>;  // to, from

  [[nodiscard]] bool is_loose(const VirtualEdge& edge) const;
  void join();
  void add_keyframe(const SubmapKeyframe& item, Added& added);
  void add_edge(const VirtualEdge& edge, Added& added);
  void add_estimates(const Submap& submap);
  void forget_behind_window();
  void forget_unobserved();

  Config config_;
  std::map<KeyframeId, Keyframe> keyframes_;
  std::map<EdgeKey, VirtualEdge> edges_;
  std::vector<EdgeKey> spanning_;
  std::map<LandmarkId, Landmark> landmarks_;  // of the observations of keyframes_
  KeyframeId horizon_{};                      // what is older has been removed
  bool unobserved_landmarks_ = false;         // there may be landmarks that no keyframe observes
};

}  // namespace fleetloc

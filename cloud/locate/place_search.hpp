#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

#include <Eigen/Core>

#include "cloud/locate/map_pyramid.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// A landmark as the robot knows it before it knows where it is: in a frame whose z axis points up.
struct SeenLandmark {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();          ///< [m]
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();  ///< of the camera that saw it last [m]
  int weight = 1;                                       ///< from 1
};

/// A place for the landmarks: x_map = T_map_seen * x.
struct FoundPlace {
  Pose T_map_seen;     ///< turned about z only; z becomes the height above the ground
  double score = 0.0;  ///< share of the landmarks that the map explains, by weight, in 0..1
};

/// Where the robot may be.
struct SearchRegion {
  /// Of the landmarks' mean [m]. Its height is that above the ground; where it is known to a cell,
  /// the search is much faster.
  Eigen::Vector3d min_map = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_map = Eigen::Vector3d::Zero();
  /// Of T_map_seen (FoundPlace): what it does not hold for is no place. None: holds for all.
  std::function<bool(const Pose&)> is_possible = {};
};

/// Looks for the places of a map that explain what a robot has seen best, over all positions of a
/// region and all headings: branch and bound over a MapPyramid, of positions and headings alike
/// (Aoki et al., "3D-BBS", ICRA 2024, branch over angles, too). Places are found in the order of
/// their score, and none is left out: what the finest cells and headings can express is compared as
/// if each had been tried. It is best first only in steps: in each sweep over the region what has a
/// bound of the next twentieth is split wherever it is, so that what is looked at one after the
/// other lies side by side in memory.
class PlaceSearch {
 public:
  struct Config {
    int max_places;    ///< are looked for
    double min_share;  ///< of the best place's score: places with less are of no interest
    double same_m;     ///< places nearer than this, and
    double same_rad;   ///< turned by less than this, are one
  };

  PlaceSearch(const MapPyramid& map,
              std::vector<SeenLandmark> landmarks,
              const SearchRegion& region,
              const Config& config);

  /// Goes on for about so many evaluations of a landmark.
  /// @return whether it has ended
  bool advance(std::size_t evaluations);

  /// So far, the best first: these are final, and no other place has more than max_score_of_rest().
  [[nodiscard]] const std::vector<FoundPlace>& places() const { return places_; }
  [[nodiscard]] double max_score_of_rest() const;
  [[nodiscard]] std::size_t evaluations() const { return evaluations_; }
  /// Steps of the heading in a turn: none moves a landmark by more than a cell.
  [[nodiscard]] int headings() const { return static_cast<int>(turned_.front().size()); }

  /// How many places there are to choose from: positions in the region, each with all headings.
  static double candidates(const MapPyramid& map,
                           const std::vector<SeenLandmark>& landmarks,
                           const SearchRegion& region);

 private:
  /// Columns of a landmark, over a block of headings.
  struct Turned {
    int x = 0;  ///< the least
    int y = 0;
    std::uint16_t wide = 0;  ///< to the largest
    std::uint16_t deep = 0;
  };
  using Landmarks = std::vector<Turned>;

  /// Positions [at, at + 2^level) along x and y, at any height, and as many headings: block `yaw`
  /// of them. A leaf has one height.
  struct Node {
    int bound = 0;
    int level = 0;
    int yaw = 0;
    Eigen::Vector3i at = Eigen::Vector3i::Zero();
    [[nodiscard]] bool is_leaf() const { return level == kLeaf; }
    bool operator<(const Node& other) const {
      return bound != other.bound ? bound < other.bound : level > other.level;
    }
  };
  static constexpr int kLeaf = -1;

  /// Of a node that is split.
  struct Part {
    Node node;
    const Turned* landmarks = nullptr;
  };

  void turn(const std::vector<SeenLandmark>& landmarks);
  [[nodiscard]] static Landmarks joined(const Landmarks& block, const Landmarks& next);
  [[nodiscard]] const Landmarks& block(int level, int yaw) const;
  [[nodiscard]] int value(const Node& node, std::size_t landmark, const Turned& turned) const;
  void split(const Node& node);
  void add_quarters(const Node& node);
  void add_part(int bound_of_whole, int level, int yaw, const Eigen::Vector3i& at);
  template <typename ValueInWhole>
  void bound_parts(const ValueInWhole& value_in_whole);
  [[nodiscard]] bool is_dropped(const Node& node, int least);
  void add(const Node& node);
  [[nodiscard]] int enough() const;
  bool begin_sweep();
  void open_next_root();
  void bound_root();
  void take(const Node& leaf);
  [[nodiscard]] Pose pose_of(int yaw, const Eigen::Vector3i& at) const;
  [[nodiscard]] double score_of(const Node& node) const;

  const MapPyramid& map_;
  Config config_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();  // of the landmarks
  std::vector<int> weights_;
  std::vector<int> heights_;                                      // relative to the center [cells]
  std::vector<std::vector<Landmarks>> turned_;                    // by level and block of headings
  std::vector<std::vector<const MapPyramid::Windows*>> windows_;  // by level, of each landmark
  std::function<bool(const Pose&)> is_possible_;
  Eigen::Vector3i first_;  // position of the region
  Eigen::Vector3i last_;
  Eigen::Array2i roots_ = Eigen::Array2i::Zero();  // along x and y; each has all blocks of headings
  int full_score_ = 0;
  int sweep_from_ = 0;                      // what has a smaller bound waits for the next sweep:
  std::vector<std::vector<Node>> waiting_;  // by root
  std::size_t next_root_ = 0;
  std::size_t root_ = 0;    // that is searched now:
  std::vector<Node> open_;  // what is yet to be split of it
  std::vector<Part> parts_;
  std::priority_queue<Node> leaves_;
  std::vector<FoundPlace> places_;
  std::size_t evaluations_ = 0;
  int best_leaf_ = 0;     // that was added so far
  int best_dropped_ = 0;  // bound of what is of no interest
};

}  // namespace fleetloc

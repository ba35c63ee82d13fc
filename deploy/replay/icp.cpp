#include "deploy/replay/icp.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>

#include "cloud/point_cloud/quiet_pcl.hpp"

namespace fleetloc {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;
using PclTree = pcl::search::KdTree<pcl::PointXYZ>;

PclCloud::Ptr pcl_cloud(const std::vector<Eigen::Vector3f>& points) {
  auto cloud = std::make_shared<PclCloud>();
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  return cloud;
}

/// Single precision makes the product of PCL's steps no rotation in the end.
Pose pose_of(const Eigen::Matrix4f& T) {
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>().cast<double>();
  return {.R = Eigen::Quaterniond(R).normalized(), .p = T.topRightCorner<3, 1>().cast<double>()};
}

}  // namespace

struct IcpTarget::Cloud {
  PclCloud::Ptr points;
  PclTree::Ptr tree;

  /// How well points that have been moved lie on it.
  void measure(const PclCloud& moved, double max_distance_m, IcpResult& result) const {
    std::vector<int> index(1);
    std::vector<float> squared(1);
    std::size_t matched = 0;
    double sum = 0.0;
    for (const pcl::PointXYZ& point : moved) {
      if (tree->nearestKSearch(point, 1, index, squared) != 1) continue;
      const auto squared_m = static_cast<double>(squared.front());
      if (squared_m > max_distance_m * max_distance_m) continue;
      ++matched;
      sum += squared_m;
    }
    if (matched == 0) return;
    result.matched_share = static_cast<double>(matched) / static_cast<double>(moved.size());
    result.rms_m = std::sqrt(sum / static_cast<double>(matched));
  }
};

IcpTarget::IcpTarget(const std::vector<Eigen::Vector3f>& points) {
  assert(!points.empty());
  Cloud cloud{.points = pcl_cloud(points), .tree = std::make_shared<PclTree>(false)};
  cloud.tree->setInputCloud(cloud.points);
  cloud_ = std::make_unique<const Cloud>(std::move(cloud));
}

IcpTarget::IcpTarget(IcpTarget&& other) noexcept = default;
IcpTarget& IcpTarget::operator=(IcpTarget&& other) noexcept = default;
IcpTarget::~IcpTarget() = default;

IcpResult IcpTarget::align(const std::vector<Eigen::Vector3d>& source,
                           const Pose& start,
                           const IcpConfig& config) const {
  const QuietPcl quiet;
  // The start is applied beforehand, in double precision.
  std::vector<Eigen::Vector3f> placed;
  placed.reserve(source.size());
  for (const Eigen::Vector3d& p : source) placed.emplace_back((start * p).cast<float>());
  const auto cloud = pcl_cloud(placed);
  IcpResult result{.T_target_source = start};
  if (cloud->empty()) return result;

  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  constexpr bool kKeepTree = true;
  icp.setSearchMethodTarget(cloud_->tree, kKeepTree);
  icp.setInputTarget(cloud_->points);
  icp.setInputSource(cloud);
  icp.setMaxCorrespondenceDistance(config.max_distance_m);
  icp.setMaximumIterations(config.iterations);
  icp.setTransformationEpsilon(config.settled_m * config.settled_m);  // of the squared step
  PclCloud moved;
  icp.align(moved);
  result.converged = icp.hasConverged();
  if (!result.converged) return result;
  result.T_target_source = pose_of(icp.getFinalTransformation()) * start;
  cloud_->measure(moved, config.max_distance_m, result);
  return result;
}

}  // namespace fleetloc

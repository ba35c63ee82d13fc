#include "shared/ros2/pose_codec.hpp"
#include "test/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto pose = decode_pose({data, size});
  if (!pose) return 0;
  require(pose->T_a_b.p.allFinite(), "a position is finite");
  require(std::abs(pose->T_a_b.R.norm() - 1.0) < 1e-9, "a rotation is one");
  require(pose->covariance.allFinite(), "a covariance is finite");
  require(pose->covariance == pose->covariance.transpose(), "a covariance is symmetric");
  return 0;
}

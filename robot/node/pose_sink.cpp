#include "robot/node/pose_sink.hpp"

#include "shared/wire/pose_codec.hpp"

namespace fleetloc {

void PoseSink::add(const RobotOutput& output) {
  if (!output.pose || output.pose->quality == Quality::kInitializing) return;
  try {
    publisher_.publish(encode(RobotPoseEstimate{robot_, *output.pose}));
  } catch (const NotEncodable&) {
    ++unpublished_;
  }
}

std::map<std::string, std::uint64_t> PoseSink::faults() const {
  if (unpublished_ == 0) return {};
  return {{"unpublished_poses", unpublished_}};
}

}  // namespace fleetloc

#include "shared/compact/answer_sample.hpp"
#include "test/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto answer = decode_answer({data, size});
  if (!answer) return 0;
  if (answer->result.status == LocalizationStatus::kLocalized) {
    require(answer->result.T_map_body.p.allFinite(), "a pose is finite");
    require(answer->result.covariance.allFinite(), "a covariance is finite");
  }
  if (!answer->correction) return 0;
  for (const auto& landmark : answer->correction->landmarks) {
    require(landmark.p_anchor.allFinite() && landmark.information.allFinite(), "a landmark");
  }
  for (const auto& pose : answer->correction->relative_poses) {
    require(pose.from < pose.to && pose.information.allFinite(), "a relative pose");
  }
  return 0;
}

#include "deploy/evaluation/errors/eval_place.hpp"

#include <algorithm>
#include <optional>

#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

constexpr double kJump_m = 1.0;  // no robot moves as far from one line of ground truth to the next

double metres_off(const PosePair& pair) {
  return (pair.T_truth_body.p - pair.T_estimate_body.p).norm();
}

double degrees_off(const PosePair& pair) {
  return kDegPerRad * pair.T_truth_body.R.angularDistance(pair.T_estimate_body.R);
}

bool is_at_wrong_place(const PosePair& pair) {
  return metres_off(pair) > kPlaceMetres || degrees_off(pair) > kPlaceDegrees;
}

bool claims_its_place(Timestamp stamp, const RunCovariances& covariances) {
  return std::ranges::binary_search(covariances.localized, stamp);
}

bool is_wrong_and_sure(const PosePair& pair, const RunCovariances& covariances) {
  return claims_its_place(pair.stamp, covariances) && is_at_wrong_place(pair);
}

/// Way of the ground truth, without jumps [m].
double way(const Trajectory& truth, Timestamp from, Timestamp to) {
  double sum_m = 0.0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    if (truth[i - 1].stamp < from || truth[i].stamp > to) continue;
    const double step_m = (truth[i].T_ref_body.p - truth[i - 1].T_ref_body.p).norm();
    if (step_m <= kJump_m) sum_m += step_m;
  }
  return sum_m;
}

struct Jump {
  Timestamp stamp;  // of the first pose after it
  double distance_m = 0.0;
};

std::optional<Jump> first_jump(const Trajectory& truth, Timestamp from) {
  for (std::size_t i = 1; i < truth.size(); ++i) {
    if (truth[i - 1].stamp < from) continue;
    const double step_m = (truth[i].T_ref_body.p - truth[i - 1].T_ref_body.p).norm();
    if (step_m > kJump_m) return Jump{.stamp = truth[i].stamp, .distance_m = step_m};
  }
  return std::nullopt;
}

}  // namespace

nlohmann::json first_place(const Trajectory& truth,
                           const std::vector<PosePair>& map_poses,
                           const RunCovariances& covariances) {
  const auto wrong = std::ranges::count_if(
      map_poses, [&](const PosePair& pair) { return is_wrong_and_sure(pair, covariances); });
  nlohmann::json result = {{"found", !map_poses.empty()},
                           {"after_s", nullptr},
                           {"way_m", nullptr},
                           {"error_m", nullptr},
                           {"error_deg", nullptr},
                           {"wrong_frames", wrong}};
  if (map_poses.empty() || !covariances.first_frame) return result;
  const PosePair& first = map_poses.front();
  result["after_s"] = to_seconds(first.stamp - *covariances.first_frame);
  result["way_m"] = way(truth, *covariances.first_frame, first.stamp);
  result["error_m"] = metres_off(first);
  result["error_deg"] = degrees_off(first);
  return result;
}

nlohmann::json carried_away(const Trajectory& truth,
                            const std::vector<PosePair>& map_poses,
                            const RunCovariances& covariances) {
  if (!covariances.first_frame) return nullptr;
  const auto jump = first_jump(truth, *covariances.first_frame);
  if (!jump) return nullptr;
  nlohmann::json result = {{"after_s", to_seconds(jump->stamp - *covariances.first_frame)},
                           {"distance_m", jump->distance_m},
                           {"noticed_s", nullptr},
                           {"right_s", nullptr},
                           {"right_m", nullptr}};
  double wrong_s = 0.0;
  auto pose = map_poses.begin();
  const auto& frames = covariances.frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i] < jump->stamp) continue;
    while (pose != map_poses.end() && pose->stamp < frames[i]) ++pose;
    const bool has_pose = pose != map_poses.end() && pose->stamp == frames[i];
    const double since_s = to_seconds(frames[i] - jump->stamp);
    if (has_pose && is_wrong_and_sure(*pose, covariances)) {
      if (i + 1 < frames.size()) wrong_s += to_seconds(frames[i + 1] - frames[i]);
      continue;
    }
    if (result["noticed_s"].is_null()) result["noticed_s"] = since_s;
    if (has_pose && claims_its_place(frames[i], covariances) && result["right_s"].is_null()) {
      result["right_s"] = since_s;
      result["right_m"] = way(truth, jump->stamp, frames[i]);
    }
  }
  result["wrong_and_sure_s"] = wrong_s;
  return result;
}

}  // namespace fleetloc

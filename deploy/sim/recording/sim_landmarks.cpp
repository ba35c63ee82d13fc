#include "deploy/sim/recording/sim_landmarks.hpp"

#include <vector>

#include "deploy/sim/sensors/landmark_survey.hpp"
#include "deploy/sim/sensors/stereo_renderer.hpp"

namespace fleetloc {

double unmapped_share(const SimMotion& motion,
                      const SeasonScene& season,
                      const SeasonScene& survey,
                      const SimConfig& config,
                      std::uint64_t seed) {
  constexpr int kImages = 16;
  constexpr int kCorners = 400;
  const auto T_map_body_at = [&](double s) { return motion.motion.at(s).T_map_body; };
  std::vector<VisibleLandmark> landmarks;
  for (int i = 0; i < kImages; ++i) {
    const double time_s = motion.motion.duration() * (i + 0.5) / kImages;
    StereoRenderer renderer(config.cameras, season, config.renderer, seed);  // a first exposure
    const StereoFrame frame =
        renderer.render({.stamp = motion.start, .time_s = time_s, .frame = 0}, T_map_body_at);
    const auto seen = visible_landmarks(frame.left,
                                        season.at(time_s).caster,
                                        config.cameras.cam0,
                                        T_map_body_at(time_s) * config.cameras.T_body_cam0,
                                        kCorners);
    landmarks.insert(landmarks.end(), seen.begin(), seen.end());
  }
  return unmapped_share(landmarks, survey.fixed());
}

}  // namespace fleetloc

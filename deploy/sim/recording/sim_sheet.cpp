#include "deploy/sim/recording/sim_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "deploy/sim/sensors/lidar.hpp"
#include "deploy/sim/sensors/stereo_renderer.hpp"

namespace fleetloc {
namespace {

constexpr std::array kPlaces{0.12, 0.37, 0.62, 0.87};  // of the motion's time
constexpr int kHeight_px = 240;                        // of a row
constexpr double kAcross_m = 60.0;                     // of a lidar's picture
constexpr double kWhite = 255.0;

void label(cv::Mat& picture, const std::string& text) {
  const cv::Point place(8, 20);
  cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar(0), 4);
  cv::putText(picture, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar(kWhite), 1);
}

cv::Mat camera_picture(const SimMotion& motion,
                       const SeasonScene& season,
                       const SimConfig& config,
                       std::uint64_t seed,
                       double time_s) {
  StereoRenderer renderer(config.cameras, season, config.renderer, seed);
  const StereoFrame frame =
      renderer.render({.stamp = motion.start + from_seconds(time_s), .time_s = time_s, .frame = 0},
                      [&motion](double at_s) { return motion.motion.at(at_s).T_map_body; });
  cv::Mat picture;
  const int width_px = frame.left.cols * kHeight_px / frame.left.rows;
  cv::resize(frame.left, picture, {width_px, kHeight_px}, 0.0, 0.0, cv::INTER_AREA);
  return picture;
}

cv::Mat lidar_picture(const SimMotion& motion,
                      const SeasonScene& season,
                      const SimConfig& config,
                      std::uint64_t seed,
                      double time_s) {
  constexpr double kHighest_m = 6.0;  // of the shades
  const Lidar lidar(config.lidar, seed);
  const auto index = static_cast<std::uint64_t>(time_s * config.lidar.calibration.rate_hz);
  const LidarScan scan = lidar.scan(season.at(time_s).caster, motion.motion, motion.start, index);
  cv::Mat picture(kHeight_px, kHeight_px, CV_8U, cv::Scalar(kWhite));
  for (const LidarPoint& point : scan.points) {
    const Eigen::Vector3d p = point.p_lidar.cast<double>();
    const int column = static_cast<int>(std::floor((0.5 - p.y() / kAcross_m) * kHeight_px));
    const int row = static_cast<int>(std::floor((0.5 - p.x() / kAcross_m) * kHeight_px));
    if (column < 0 || row < 0 || column >= kHeight_px || row >= kHeight_px) continue;
    const double height = std::clamp(p.z() / kHighest_m, 0.0, 1.0);
    auto& pixel = picture.at<std::uint8_t>(row, column);
    pixel = std::min(pixel, static_cast<std::uint8_t>(190.0 * (1.0 - height)));
  }
  return picture;
}

}  // namespace

cv::Mat contact_sheet(const SimMotion& motion,
                      std::span<const SeasonScene> seasons,
                      const SimConfig& config,
                      std::uint64_t seed) {
  std::vector<cv::Mat> rows;
  for (const SeasonScene& season : seasons) {
    std::vector<cv::Mat> pictures;
    for (const double place : kPlaces) {
      const double time_s = place * motion.motion.duration();
      pictures.push_back(camera_picture(motion, season, config, seed, time_s));
    }
    label(pictures.front(), season.config().name);
    const double first_s = kPlaces.front() * motion.motion.duration();
    pictures.push_back(lidar_picture(motion, season, config, seed, first_s));
    rows.emplace_back();
    cv::hconcat(pictures, rows.back());
  }
  cv::Mat sheet;
  cv::vconcat(rows, sheet);
  return sheet;
}

}  // namespace fleetloc

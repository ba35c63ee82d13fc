// tracking_bench DATASET [BIAS_X BIAS_Y BIAS_Z]: what the front end costs and finds in a dataset
// folder. The bias of the gyroscope [rad/s] is taken off its prediction; without it there is none.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "deploy/config/default_config.hpp"
#include "robot/dataset/dataset_reader.hpp"
#include "robot/tracking/feature_tracker.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

double thread_cpu_ms() {
  return 1e3 * to_seconds(thread_cpu_time());
}

class Figure {
 public:
  void add(double value) { values_.push_back(value); }

  void print(const char* name) {
    if (values_.empty()) return;
    std::sort(values_.begin(), values_.end());
    double sum = 0.0;
    for (const double value : values_) sum += value;
    std::printf("%-24s mean %8.3f  p50 %8.3f  p99 %8.3f\n",
                name,
                sum / static_cast<double>(values_.size()),
                values_[values_.size() / 2],
                values_[values_.size() * 99 / 100]);
  }

 private:
  std::vector<double> values_;
};

/// Rotation of the body since the last frame, samples held until the next one.
class Gyroscope {
 public:
  explicit Gyroscope(std::optional<Eigen::Vector3d> bias) : bias_(std::move(bias)) {}

  void add(const ImuSample& sample) {
    turn_until(sample.stamp);
    last_ = sample;
  }

  Eigen::Quaterniond take(Timestamp stamp) {
    turn_until(stamp);
    return std::exchange(R_, Eigen::Quaterniond::Identity());
  }

 private:
  void turn_until(Timestamp stamp) {
    if (!last_ || !bias_) return;
    R_ = R_ * exp_so3((last_->angular_velocity - *bias_) * to_seconds(stamp - last_->stamp));
    last_->stamp = stamp;
  }

  std::optional<Eigen::Vector3d> bias_;
  std::optional<ImuSample> last_;
  Eigen::Quaterniond R_ = Eigen::Quaterniond::Identity();
};

struct Figures {
  Figure cpu_ms;
  Figure features;
  Figure disparity_share;
  Figure lost;
  Figure rejected;
  Figure row_error_px;
  Figure motion_error_px;
  std::map<LandmarkId, int> lengths;

  void add(const TrackedFrame& frame, const TrackingDiagnostics& diagnostics) {
    features.add(static_cast<double>(frame.observations.size()));
    if (!frame.observations.empty()) {
      disparity_share.add(diagnostics.with_disparity /
                          static_cast<double>(frame.observations.size()));
    }
    lost.add(diagnostics.lost);
    rejected.add(diagnostics.rejected_by_motion);
    row_error_px.add(diagnostics.row_error_px);
    motion_error_px.add(diagnostics.motion_error_px);
    for (const auto& observation : frame.observations) ++lengths[observation.landmark];
  }

  void print() {
    cpu_ms.print("CPU per frame [ms]");
    features.print("features");
    disparity_share.print("share with disparity");
    lost.print("lost by KLT");
    rejected.print("rejected by motion");
    row_error_px.print("row error [px]");
    motion_error_px.print("motion error [px]");
    Figure per_track;
    Figure per_observation;
    for (const auto& [landmark, length] : lengths) {
      per_track.add(length);
      for (int i = 0; i < length; ++i) per_observation.add(length);
    }
    per_track.print("track length [frames]");
    per_observation.print("the same, per feature");
  }
};

void run(const char* folder, const std::optional<Eigen::Vector3d>& gyroscope_bias) {
  DatasetReader dataset({.folder = folder});
  FeatureTracker tracker(
      dataset.calibration(),
      read_feature_tracker_config(
          ConfigReader::from_string(default_config("robot")).section("tracking")));
  Gyroscope gyroscope(gyroscope_bias);
  Figures figures;
  while (const auto item = dataset.next()) {
    if (const auto* sample = std::get_if<ImuSample>(&*item)) {
      gyroscope.add(*sample);
      continue;
    }
    const auto& images = std::get<StereoFrame>(std::get<CameraFrame>(*item));
    const Eigen::Quaterniond R_previous_current = gyroscope.take(images.stamp);
    const double begin_ms = thread_cpu_ms();
    const TrackedFrame frame = tracker.track(images, R_previous_current);
    figures.cpu_ms.add(thread_cpu_ms() - begin_ms);
    figures.add(frame, tracker.diagnostics());
  }
  figures.print();
}

}  // namespace
}  // namespace fleetloc

int main(int argc, char** argv) {
  if (argc != 2 && argc != 5) {
    std::fprintf(stderr, "usage: tracking_bench DATASET [BIAS_X BIAS_Y BIAS_Z]\n");
    return 2;
  }
  try {
    cv::setNumThreads(1);
    std::optional<Eigen::Vector3d> bias;
    if (argc == 5) {
      bias = Eigen::Vector3d(std::stod(argv[2]), std::stod(argv[3]), std::stod(argv[4]));
    }
    fleetloc::run(argv[1], bias);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tracking_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}

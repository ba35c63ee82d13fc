#include "robot/dataset/dataset_reader.hpp"

#include <algorithm>
#include <utility>

#include "robot/calibration/euroc_rig.hpp"
#include "robot/dataset/csv_file.hpp"
#include "robot/dataset/stereo_images.hpp"
#include "robot/dataset/track_files.hpp"

namespace fleetloc {
namespace {

constexpr Duration kImuLead = std::chrono::seconds(1);

std::filesystem::path mav0_of(const std::filesystem::path& folder) {
  if (std::filesystem::is_directory(folder / "mav0")) return folder / "mav0";
  if (std::filesystem::is_directory(folder / "cam0")) return folder;
  throw DatasetError(folder.string() + ": not a dataset in the EuRoC layout, there is no mav0");
}

/// How many regular measurements are missing between two stamps.
std::uint64_t missing_between(Timestamp before, Timestamp after, Duration interval) {
  const double intervals = to_seconds(after - before) / to_seconds(interval);
  return intervals < 1.5 ? 0 : static_cast<std::uint64_t>(std::lround(intervals)) - 1;
}

}  // namespace

DatasetReader::DatasetReader(const Options& options)
    : imu_file_(open_csv(mav0_of(options.folder) / "imu0" / "data.csv")) {
  const auto mav0 = mav0_of(options.folder);
  read_calibration(mav0);
  if (options.tracks) {
    frames_ = std::make_unique<TrackFiles>(mav0 / "tracks0");
  } else {
    frames_ = std::make_unique<StereoImages>(mav0, calibration_);
  }
  select_frames(options);
  do {
    read_imu_sample();
  } while (imu_sample_ && imu_sample_->stamp < frames_->stamps()[first_frame_] - kImuLead);
  if (!imu_sample_) throw DatasetError(imu_file_.file().string() + ": ends before the first frame");
  faults_["imu_gaps"] = 0;  // only those of the selected part count
}

void DatasetReader::read_calibration(const std::filesystem::path& mav0) {
  const SensorRig rig = read_euroc_rig(euroc_files(mav0));
  calibration_ = rig.cameras;
  imu_noise_ = rig.imu_noise;
  frame_interval_ = from_seconds(1.0 / rig.frame_rate_hz);
  imu_interval_ = from_seconds(1.0 / rig.imu_rate_hz);
}

void DatasetReader::select_frames(const Options& options) {
  const std::vector<Timestamp>& stamps = frames_->stamps();
  recording_start_ = stamps.front();
  const Timestamp start = recording_start_ + from_seconds(options.start_s);
  const auto first = std::ranges::lower_bound(stamps, start);
  const auto end = options.duration_s
                       ? std::ranges::upper_bound(stamps, start + from_seconds(*options.duration_s))
                       : stamps.end();
  if (first >= end) throw DatasetError(options.folder.string() + ": no frame in the selected part");
  first_frame_ = static_cast<std::size_t>(first - stamps.begin());
  end_frame_ = static_cast<std::size_t>(end - stamps.begin());
  next_frame_ = first_frame_;
}

void DatasetReader::read_imu_sample() {
  const std::optional<ImuSample> before = std::exchange(imu_sample_, std::nullopt);
  try {
    if (!imu_file_.next()) return;
    imu_file_.expect_columns(7);
    const auto vector_at = [this](std::size_t column) {
      return Eigen::Vector3d(
          imu_file_.number(column), imu_file_.number(column + 1), imu_file_.number(column + 2));
    };
    imu_sample_ = {.stamp = imu_file_.nanoseconds(0),
                   .angular_velocity = vector_at(1),
                   .specific_force = vector_at(4)};
    if (before && imu_sample_->stamp <= before->stamp) {
      imu_file_.fail("the stamp is not later than the one before");
    }
  } catch (const TextFileError& error) {
    throw DatasetError(error.what());
  }
  if (before && missing_between(before->stamp, imu_sample_->stamp, imu_interval_) > 0) {
    ++faults_["imu_gaps"];
  }
}

CameraFrame DatasetReader::read_next_frame() {
  const std::vector<Timestamp>& stamps = frames_->stamps();
  CameraFrame frame = frames_->read(next_frame_);
  if (const auto* images = std::get_if<StereoFrame>(&frame)) {
    if (images->left.empty() || images->right.empty()) ++faults_["unpaired_images"];
  }
  if (next_frame_ > first_frame_) {
    faults_["dropped_frames"] +=
        missing_between(stamps[next_frame_ - 1], stamps[next_frame_], frame_interval_);
  }
  ++next_frame_;
  return frame;
}

std::optional<SensorMeasurement> DatasetReader::next(const std::stop_token& stop) {
  if (finished_ || stop.stop_requested()) return std::nullopt;
  const std::vector<Timestamp>& stamps = frames_->stamps();
  const bool frames_left = next_frame_ < end_frame_;
  if (frames_left && (!imu_sample_ || stamps[next_frame_] < imu_sample_->stamp)) {
    return read_next_frame();
  }
  if (!frames_left) finished_ = !imu_sample_ || imu_sample_->stamp > stamps[end_frame_ - 1];
  if (!imu_sample_) return std::nullopt;
  const ImuSample sample = *imu_sample_;
  if (!finished_) read_imu_sample();
  if (!imu_sample_ && next_frame_ < end_frame_) ++faults_["imu_gaps"];  // its end is missing
  return sample;
}

}  // namespace fleetloc

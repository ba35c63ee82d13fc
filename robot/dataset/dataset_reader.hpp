#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot/dataset/frame_source.hpp"
#include "robot/sensors/sensor_source.hpp"
#include "shared/config/delimited_file.hpp"
#include "shared/dataset/dataset_error.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

/// Plays a folder in the EuRoC/ASL layout (mav0/{cam0,cam1,imu0}) in time order; an IMU sample
/// comes before a frame of the same stamp. The IMU record begins one second before the first frame
/// that is played and ends with the first sample after the last one. Frames are read in next(),
/// never ahead. The body is the IMU, whatever frame the files state their poses in.
class DatasetReader final : public SensorSource {
 public:
  struct Options {
    std::filesystem::path folder;  ///< that holds mav0, or mav0 itself
    double start_s = 0.0;          ///< of the recording to skip, from its first frame
    std::optional<double> duration_s = std::nullopt;  ///< of the frames to play
    bool tracks = false;  ///< plays mav0/tracks0 (see TrackFiles) instead of the images
  };

  /// Throws DatasetError.
  explicit DatasetReader(const Options& options);

  [[nodiscard]] const StereoCalibration& calibration() const { return calibration_; }
  [[nodiscard]] const ImuNoise& imu_noise() const { return imu_noise_; }

  /// The first frame of the whole recording, whatever part of it is selected.
  [[nodiscard]] Timestamp recording_start() const { return recording_start_; }

  /// Of the selected part.
  [[nodiscard]] std::optional<std::size_t> frame_count() const override {
    return end_frame_ - first_frame_;
  }

  /// Throws DatasetError that names file and line.
  std::optional<SensorMeasurement> next(const std::stop_token& stop) override;
  using SensorSource::next;

  /// "unpaired_images" (their frame has one empty image), "dropped_frames" and "imu_gaps", by the
  /// rates that the sensors' files state.
  std::map<std::string, std::uint64_t> close() override { return faults_; }

 private:
  void read_calibration(const std::filesystem::path& mav0);
  void select_frames(const Options& options);
  void read_imu_sample();
  CameraFrame read_next_frame();

  StereoCalibration calibration_;
  ImuNoise imu_noise_;
  Duration frame_interval_{};
  Duration imu_interval_{};
  Timestamp recording_start_;
  std::unique_ptr<FrameSource> frames_;
  std::size_t first_frame_ = 0;  // of the selected part, as are the next two
  std::size_t next_frame_ = 0;
  std::size_t end_frame_ = 0;
  DelimitedFile imu_file_;
  std::optional<ImuSample> imu_sample_;  // the next one; nothing at the end of the file
  bool finished_ = false;
  std::map<std::string, std::uint64_t> faults_ = {
      {"unpaired_images", 0}, {"dropped_frames", 0}, {"imu_gaps", 0}};
};

}  // namespace fleetloc

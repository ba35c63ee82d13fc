#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <vector>

#include "robot/dataset/frame_source.hpp"
#include "shared/config/delimited_file.hpp"

namespace fleetloc {

/// Tracks instead of images, in a folder tracks0: `data.csv` lists the frames (stamp, number of
/// observations), `observations.csv` their observations one after the other (landmark, u, v and
/// disparity in the rectified pair of the cameras [px]; disparity 0: not seen by the right one).
class TrackFiles final : public FrameSource {
 public:
  /// Throws DatasetError for a missing file and what is wrong with the list.
  explicit TrackFiles(const std::filesystem::path& folder);

  [[nodiscard]] const std::vector<Timestamp>& stamps() const override { return stamps_; }
  /// Throws DatasetError that names file and line.
  CameraFrame read(std::size_t index) override;

 private:
  StereoObservation read_observation();

  std::vector<Timestamp> stamps_;
  std::vector<std::size_t> sizes_;
  DelimitedFile observations_;
  std::size_t next_ = 0;
};

/// Writes what TrackFiles reads; pixels to 1e-4.
class TrackWriter {
 public:
  /// Throws DatasetError.
  explicit TrackWriter(const std::filesystem::path& folder);

  void add(const TrackedFrame& frame);

  /// Throws DatasetError if not everything could be written. Nothing may be added afterwards.
  void finish();

 private:
  std::filesystem::path folder_;
  std::ofstream frames_;
  std::ofstream observations_;
};

}  // namespace fleetloc

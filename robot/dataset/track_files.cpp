#include "robot/dataset/track_files.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

#include "robot/dataset/csv_file.hpp"

namespace fleetloc {
namespace {

constexpr const char* kFrames = "data.csv";
constexpr const char* kObservations = "observations.csv";
constexpr double kMaxObservations = 10'000.0;  // of a frame
constexpr double kMaxLandmarks = std::numeric_limits<std::uint32_t>::max();

std::size_t whole_number(const DelimitedFile& csv, std::size_t column, double max) {
  const double number = csv.number(column);
  if (number < 0.0 || number > max || number != std::floor(number)) {
    csv.fail("'" + std::string(csv.text(column)) + "' is not a whole number up to " +
             std::to_string(static_cast<std::uint64_t>(max)));
  }
  return static_cast<std::size_t>(number);
}

std::ofstream create(const std::filesystem::path& file, std::string_view header) {
  std::ofstream stream(file);
  stream << header << '\n';
  if (!stream) throw DatasetError(file.string() + ": cannot be written");
  return stream;
}

/// With as few digits as 1e-4 needs.
std::string pixel_text(double pixel) {
  constexpr int kDecimals = 4;
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.begin(), text.end(), pixel, std::chars_format::fixed, kDecimals);
  return error == std::errc() ? std::string(text.begin(), end) : std::string("nan");
}

}  // namespace

TrackFiles::TrackFiles(const std::filesystem::path& folder)
    : observations_(open_csv(folder / kObservations)) {
  DelimitedFile csv = open_csv(folder / kFrames);
  try {
    while (csv.next()) {
      csv.expect_columns(2);
      const Timestamp stamp = csv.nanoseconds(0);
      if (!stamps_.empty() && stamp <= stamps_.back()) {
        csv.fail("the stamp is not later than the one before");
      }
      stamps_.push_back(stamp);
      sizes_.push_back(whole_number(csv, 1, kMaxObservations));
    }
  } catch (const TextFileError& error) {
    throw DatasetError(error.what());
  }
  if (stamps_.empty()) throw DatasetError(csv.file().string() + ": lists no frame");
}

StereoObservation TrackFiles::read_observation() {
  if (!observations_.next()) {
    throw DatasetError(observations_.file().string() + ": ends before the last frame");
  }
  observations_.expect_columns(4);
  StereoObservation observation;
  observation.landmark = LandmarkId(whole_number(observations_, 0, kMaxLandmarks));
  observation.left = {observations_.number(1), observations_.number(2)};
  observation.disparity = observations_.number(3);
  if (observation.disparity < 0.0) observations_.fail("the disparity is negative");
  return observation;
}

CameraFrame TrackFiles::read(std::size_t index) {
  try {
    for (; next_ < index; ++next_) {
      for (std::size_t i = 0; i < sizes_[next_]; ++i) read_observation();
    }
    ++next_;
    TrackedFrame frame{.stamp = stamps_[index], .observations = {}};
    for (std::size_t i = 0; i < sizes_[index]; ++i) {
      const StereoObservation observation = read_observation();
      if (i > 0 && observation.landmark <= frame.observations.back().landmark) {
        observations_.fail("the landmark's number is not greater than the one before");
      }
      frame.observations.push_back(observation);
    }
    return frame;
  } catch (const TextFileError& error) {
    throw DatasetError(error.what());
  }
}

TrackWriter::TrackWriter(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw DatasetError(folder.string() + ": " + error.message());
  frames_ = create(folder / kFrames, "#timestamp [ns],observations");
  observations_ = create(folder / kObservations, "#landmark,u [px],v [px],disparity [px]");
}

void TrackWriter::add(const TrackedFrame& frame) {
  frames_ << frame.stamp.time_since_epoch().count() << ',' << frame.observations.size() << '\n';
  for (const StereoObservation& observation : frame.observations) {
    observations_ << static_cast<std::uint32_t>(observation.landmark) << ','
                  << pixel_text(observation.left.x()) << ',' << pixel_text(observation.left.y())
                  << ',' << pixel_text(observation.disparity) << '\n';
  }
}

void TrackWriter::finish() {
  frames_.close();
  observations_.close();
  if (!frames_ || !observations_) {
    throw DatasetError(folder_.string() + ": could not be written completely");
  }
}

}  // namespace fleetloc

#include "test/system/checked_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "shared/config/delimited_file.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

/// State and covariance of the position, from diagnostics.csv.
class StatedFrames {
 public:
  explicit StatedFrames(const std::filesystem::path& run) : file_(run / "diagnostics.csv", ',') {
    file_.next();
    std::ranges::transform(std::array{"cm44", "cm45", "cm46", "cm55", "cm56", "cm66"},
                           columns_.begin(),
                           [this](const char* name) { return column(name); });
  }

  /// Goes on to the frame of this stamp.
  void find(Timestamp stamp) {
    while (file_.next()) {
      if (file_.seconds(0) == stamp) return;
    }
    throw std::runtime_error(file_.file().string() + ": a frame is missing");
  }
  [[nodiscard]] std::string state() const { return std::string(file_.text(1)); }
  /// In body axes.
  [[nodiscard]] Eigen::Matrix3d covariance() const {
    std::array<double, 6> c{};
    std::ranges::transform(columns_, c.begin(), [&](std::size_t i) { return file_.number(i); });
    Eigen::Matrix3d covariance;
    covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    return covariance;
  }

 private:
  [[nodiscard]] std::size_t column(const std::string& name) const {
    for (std::size_t i = 0; i < file_.columns(); ++i) {
      if (file_.text(i) == name) return i;
    }
    throw std::runtime_error("no column " + name);
  }

  DelimitedFile file_;
  std::array<std::size_t, 6> columns_{};
};

}  // namespace

std::vector<CheckedFrame> checked_frames(const std::filesystem::path& run,
                                         const RecordedFlight& flight,
                                         const std::vector<Duration>& clock_steps) {
  constexpr std::chrono::milliseconds kMaxGap{100};
  constexpr std::chrono::seconds kSmallestStep{5};
  const auto truth = read_trajectory(flight.ground_truth);
  DelimitedFile poses(run / "localization_frames.tum", ' ');
  StatedFrames stated(run);
  std::vector<CheckedFrame> frames;
  Duration ahead{};
  std::size_t steps = 0;
  std::optional<Timestamp> last;
  while (poses.next()) {
    const Timestamp stamp = poses.seconds(0);
    if (last && std::chrono::abs(stamp - *last) > kSmallestStep && steps < clock_steps.size()) {
      ahead += clock_steps[steps++];
    }
    last = stamp;
    stated.find(stamp);
    const auto T_map_body = interpolate(truth, stamp - ahead, kMaxGap);
    if (!T_map_body) continue;
    const Eigen::Vector3d p(poses.number(1), poses.number(2), poses.number(3));
    const Eigen::Quaterniond R(poses.number(7), poses.number(4), poses.number(5), poses.number(6));
    const Eigen::Vector3d error = R.conjugate() * (T_map_body->p - p);
    frames.push_back({.stamp = stamp - ahead,
                      .state = stated.state(),
                      .error_m = error.norm(),
                      .sigmas = std::sqrt(error.dot(stated.covariance().ldlt().solve(error)))});
  }
  return frames;
}

double worst_while_localized(const std::vector<CheckedFrame>& frames) {
  double worst = 0.0;
  for (const CheckedFrame& frame : frames) {
    if (frame.state != "localized") continue;
    worst = std::max(worst, frame.error_m);
    EXPECT_FALSE(frame.error_m > 0.5 && frame.sigmas > 3.0)
        << frame.error_m << " m, " << frame.sigmas << " sigmas";
  }
  return worst;
}

}  // namespace fleetloc

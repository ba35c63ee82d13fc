#include "deploy/faults/fault_injector.hpp"

#include <array>
#include <limits>
#include <utility>

#include <opencv2/core.hpp>

#include "shared/core/uniform.hpp"

namespace fleetloc {
namespace {

constexpr std::array kKinds{FaultKind::kBlackImages,
                            FaultKind::kSaturatedImages,
                            FaultKind::kFrozenImages,
                            FaultKind::kMissingLeft,
                            FaultKind::kMissingRight,
                            FaultKind::kDroppedFrames,
                            FaultKind::kDoubledFrames,
                            FaultKind::kDisorderedFrames,
                            FaultKind::kResizedImages,
                            FaultKind::kZeroImageStamps,
                            FaultKind::kImuGap,
                            FaultKind::kDoubledImu,
                            FaultKind::kDisorderedImu,
                            FaultKind::kNonFiniteImu,
                            FaultKind::kZeroImuStamps,
                            FaultKind::kClockStep};

constexpr bool is_of_images(FaultKind kind) {
  return kind <= FaultKind::kZeroImageStamps;
}

constexpr bool is_of_the_imu(FaultKind kind) {
  return !is_of_images(kind) && kind != FaultKind::kClockStep;
}

constexpr bool has_share(FaultKind kind) {
  switch (kind) {
    case FaultKind::kDroppedFrames:
    case FaultKind::kDoubledFrames:
    case FaultKind::kDisorderedFrames:
    case FaultKind::kDoubledImu:
    case FaultKind::kDisorderedImu:
    case FaultKind::kNonFiniteImu:
      return true;
    default:
      return false;
  }
}

FaultKind kind_named(const std::string& text, const std::string& origin) {
  std::string known;
  for (const FaultKind kind : kKinds) {
    if (text == name(kind)) return kind;
    known += (known.empty() ? "" : ", ") + std::string(name(kind));
  }
  throw ConfigError(origin + ": kind: '" + text + "' is none of " + known);
}

Fault read_fault(ConfigReader& config, const std::string& origin) {
  constexpr double kLongest = 1e6;
  Fault fault;
  fault.kind = kind_named(config.get<std::string>("kind"), origin);
  fault.start_s = config.get<double>("start_s");
  const bool valid = fault.start_s >= 0.0 && fault.start_s <= kLongest;  // false for NaN
  if (!valid) throw ConfigError(origin + ": start_s: must be in 0..1e6");
  if (fault.kind == FaultKind::kClockStep) {
    constexpr double kLargestStep = 1e8;  // three years
    fault.step_s = config.number("step_s", -kLargestStep, kLargestStep);
    return fault;
  }
  fault.duration_s = config.positive("duration_s");
  if (fault.duration_s > kLongest) throw ConfigError(origin + ": duration_s: must be at most 1e6");
  if (has_share(fault.kind)) fault.share = config.positive("share");
  if (fault.share > 1.0) throw ConfigError(origin + ": share: must be at most 1");
  return fault;
}

// The images may be shared with whoever keeps them, so they are not written to.
void paint(StereoFrame& frame, int gray) {
  for (cv::Mat* image : {&frame.left, &frame.right}) {
    if (!image->empty()) *image = cv::Mat(image->size(), image->type(), cv::Scalar(gray));
  }
}

void cut_out(StereoFrame& frame) {
  for (cv::Mat* image : {&frame.left, &frame.right}) {
    if (image->rows < 2 || image->cols < 2) continue;
    *image = (*image)(cv::Rect(0, 0, image->cols / 2, image->rows / 2)).clone();
  }
}

/// @param last  the frame before, if there was one
void inject_fault(StereoFrame& frame, FaultKind kind, const StereoFrame* last) {
  if (kind == FaultKind::kBlackImages) paint(frame, 0);
  if (kind == FaultKind::kSaturatedImages) paint(frame, std::numeric_limits<uchar>::max());
  if (kind == FaultKind::kMissingLeft) frame.left = cv::Mat();
  if (kind == FaultKind::kMissingRight) frame.right = cv::Mat();
  if (kind == FaultKind::kResizedImages) cut_out(frame);
  if (kind == FaultKind::kFrozenImages && last != nullptr && !last->left.empty()) {
    frame.left = last->left;
    frame.right = last->right;
  }
}

/// What a front end would have made of such images.
void inject_fault(TrackedFrame& frame, FaultKind kind, const TrackedFrame* last) {
  const bool hides_landmarks = kind == FaultKind::kBlackImages ||
                               kind == FaultKind::kSaturatedImages ||
                               kind == FaultKind::kMissingLeft || kind == FaultKind::kResizedImages;
  if (hides_landmarks) frame.observations.clear();
  if (kind == FaultKind::kMissingRight) {
    for (StereoObservation& observation : frame.observations) observation.disparity = 0.0;
  }
  if (kind == FaultKind::kFrozenImages && last != nullptr) frame.observations = last->observations;
}

}  // namespace

std::string_view name(FaultKind kind) {
  switch (kind) {
    case FaultKind::kBlackImages:
      return "black_images";
    case FaultKind::kSaturatedImages:
      return "saturated_images";
    case FaultKind::kFrozenImages:
      return "frozen_images";
    case FaultKind::kMissingLeft:
      return "missing_left";
    case FaultKind::kMissingRight:
      return "missing_right";
    case FaultKind::kDroppedFrames:
      return "dropped_frames";
    case FaultKind::kDoubledFrames:
      return "doubled_frames";
    case FaultKind::kDisorderedFrames:
      return "disordered_frames";
    case FaultKind::kResizedImages:
      return "resized_images";
    case FaultKind::kZeroImageStamps:
      return "zero_image_stamps";
    case FaultKind::kImuGap:
      return "imu_gap";
    case FaultKind::kDoubledImu:
      return "doubled_imu";
    case FaultKind::kDisorderedImu:
      return "disordered_imu";
    case FaultKind::kNonFiniteImu:
      return "non_finite_imu";
    case FaultKind::kZeroImuStamps:
      return "zero_imu_stamps";
    case FaultKind::kClockStep:
      return "clock_step";
  }
  return "unknown";
}

FaultPlan read_fault_plan(ConfigReader config) {
  FaultPlan plan;
  plan.seed = config.get<std::uint64_t>("seed");
  const auto faults = config.get<std::vector<YAML::Node>>("faults");
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const std::string origin =
        "line " + std::to_string(faults[i].Mark().line + 1) + ": faults[" + std::to_string(i) + "]";
    ConfigReader fault = ConfigReader::from_string(YAML::Dump(faults[i]), origin);
    plan.faults.push_back(read_fault(fault, origin));
    fault.expect_fully_read();
  }
  config.expect_fully_read();
  return plan;
}

FaultInjector::FaultInjector(std::unique_ptr<SensorSource> recording,
                             Timestamp start,
                             FaultPlan plan)
    : recording_(std::move(recording)),
      start_(start),
      plan_(std::move(plan)),
      injected_(plan_.faults.size(), 0) {
  for (std::size_t i = 0; i < plan_.faults.size(); ++i) {
    std::seed_seq seed{static_cast<std::uint32_t>(plan_.seed),
                       static_cast<std::uint32_t>(plan_.seed >> 32U),
                       static_cast<std::uint32_t>(i)};
    random_.emplace_back(seed);
  }
}

std::map<std::string, std::uint64_t> FaultInjector::close() {
  std::map<std::string, std::uint64_t> faults = recording_->close();
  for (std::size_t i = 0; i < plan_.faults.size(); ++i) {
    faults["injected_" + std::string(name(plan_.faults[i].kind))] += injected_[i];
  }
  return faults;
}

std::optional<SensorMeasurement> FaultInjector::next(const std::stop_token& stop) {
  if (stop.stop_requested()) return std::nullopt;
  while (ready_.empty()) {
    auto measurement = recording_->next(stop);
    if (measurement) {
      std::visit([this](auto& any) { take(std::move(any)); }, *measurement);
    } else if (late_frame_) {
      ready_.push_back(*std::exchange(late_frame_, std::nullopt));
    } else if (late_sample_) {
      ready_.push_back(*std::exchange(late_sample_, std::nullopt));
    } else {
      return std::nullopt;
    }
  }
  SensorMeasurement measurement = std::move(ready_.front());
  ready_.pop_front();
  return measurement;
}

bool FaultInjector::occurs(std::size_t fault, Timestamp stamp) {
  const Fault& plan = plan_.faults[fault];
  const Duration since = stamp - start_ - from_seconds(plan.start_s);
  if (since < Duration{} || since >= from_seconds(plan.duration_s)) return false;
  const bool occurs = plan.share >= 1.0 || uniform(random_[fault]) < plan.share;
  injected_[fault] += occurs ? 1 : 0;
  return occurs;
}

void FaultInjector::take(CameraFrame frame) {
  const Timestamp stamp = stamp_of(frame);
  bool dropped = false;
  bool doubled = false;
  bool late = false;
  bool no_stamp = false;
  for (std::size_t i = 0; i < plan_.faults.size(); ++i) {
    const FaultKind kind = plan_.faults[i].kind;
    if (!is_of_images(kind) || !occurs(i, stamp)) continue;
    dropped = dropped || kind == FaultKind::kDroppedFrames;
    doubled = doubled || kind == FaultKind::kDoubledFrames;
    late = late || kind == FaultKind::kDisorderedFrames;
    no_stamp = no_stamp || kind == FaultKind::kZeroImageStamps;
    std::visit(
        [&]<typename Frame>(Frame& any) {
          inject_fault(any, kind, last_frame_ ? std::get_if<Frame>(&*last_frame_) : nullptr);
        },
        frame);
  }
  last_frame_ = frame;
  std::visit([&](auto& any) { any.stamp = no_stamp ? Timestamp{} : any.stamp + clock_ahead_; },
             frame);
  if (!dropped) deliver(std::move(frame), late_frame_, doubled, late);
}

void FaultInjector::take(const ImuSample& sample) {
  step_clock(sample.stamp);
  ImuSample faulty = sample;
  faulty.stamp += clock_ahead_;
  bool dropped = false;
  bool doubled = false;
  bool late = false;
  for (std::size_t i = 0; i < plan_.faults.size(); ++i) {
    const FaultKind kind = plan_.faults[i].kind;
    if (!is_of_the_imu(kind) || !occurs(i, sample.stamp)) continue;
    dropped = dropped || kind == FaultKind::kImuGap;
    doubled = doubled || kind == FaultKind::kDoubledImu;
    late = late || kind == FaultKind::kDisorderedImu;
    if (kind == FaultKind::kNonFiniteImu) {
      faulty.angular_velocity.x() = std::numeric_limits<double>::quiet_NaN();
      faulty.specific_force.z() = std::numeric_limits<double>::infinity();
    }
    if (kind == FaultKind::kZeroImuStamps) faulty.stamp = Timestamp{};
  }
  if (!dropped) deliver(faulty, late_sample_, doubled, late);
}

// The IMU's clock is the robot's: frames between its last sample and the step keep the old one.
void FaultInjector::step_clock(Timestamp stamp) {
  for (std::size_t i = 0; i < plan_.faults.size(); ++i) {
    const Fault& fault = plan_.faults[i];
    if (fault.kind != FaultKind::kClockStep || injected_[i] > 0) continue;
    if (stamp - start_ < from_seconds(fault.start_s)) continue;
    ++injected_[i];
    clock_ahead_ += from_seconds(fault.step_s);
    ready_.push_back(
        ClockStep{.stamp = stamp + clock_ahead_, .unseen = stamp - last_imu_.value_or(stamp)});
  }
  last_imu_ = stamp;
}

void FaultInjector::take(const ClockStep& step) {
  ready_.push_back(step);
}

void FaultInjector::deliver(SensorMeasurement measurement,
                            std::optional<SensorMeasurement>& held_back,
                            bool twice,
                            bool late) {
  if (late && !held_back) {
    held_back = std::move(measurement);
    return;
  }
  if (twice) ready_.push_back(measurement);
  ready_.push_back(std::move(measurement));
  if (held_back) ready_.push_back(*std::exchange(held_back, std::nullopt));
}

}  // namespace fleetloc

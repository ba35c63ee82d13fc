#include "robot/live/sensor_assembler.hpp"

#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxHeld = 16;
constexpr std::size_t kMaxEvents = 64;

std::string size_text(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

cv::Size size_of(const fleetloc::Camera& camera) {
  return {camera.width_px, camera.height_px};
}

std::string step_text(const std::string& topic, Duration step) {
  return topic + ": its clock was set " + (step < Duration{} ? "back" : "forward") + " by " +
         seconds_text(std::chrono::abs(step));
}

}  // namespace

SensorAssembler::SensorAssembler(const Config& config,
                                 const Topics& topics,
                                 const StereoCalibration& cameras)
    : config_(config),
      cameras_{Camera{.watch = {topics.left, config.silence},
                      .gate = {},
                      .size = size_of(cameras.cam0),
                      .said = {}},
               Camera{.watch = {topics.right, config.silence},
                      .gate = {},
                      .size = size_of(cameras.cam1),
                      .said = {}}},
      imu_watch_(topics.imu, config.silence),
      pairing_(config.pairing, config.max_wait),
      queue_(config.max_frames, config.max_imu) {}

void SensorAssembler::add_left(Timestamp stamp,
                               cv::Mat gray,
                               ArrivalTime arrival,
                               Duration decoding_cpu) {
  add_image(Side::kLeft, {stamp, std::move(gray), arrival, decoding_cpu});
}

void SensorAssembler::add_right(Timestamp stamp,
                                cv::Mat gray,
                                ArrivalTime arrival,
                                Duration decoding_cpu) {
  add_image(Side::kRight, {stamp, std::move(gray), arrival, decoding_cpu});
}

void SensorAssembler::add_image(Side side, LiveImage image) {
  Camera& its = camera(side);
  const ArrivalTime now = image.arrival;
  if (auto event = its.watch.arrived(now)) say(std::move(*event));
  if (accept(its, image)) {
    check_image(its, image.gray);
    if (!pairing_.add(side, std::move(image))) {
      count("images_late");
      complain(its.watch.topic() + " late", now, its.watch.topic() + ": images come too late");
    }
  }
  poll(now);
}

bool SensorAssembler::accept(Camera& its, LiveImage& image) {
  const std::string& topic = its.watch.topic();
  const auto accepted = its.gate.check(image.stamp, image.arrival);
  if (!accepted) {
    count("images_" + std::string(name(accepted.error())));
    if (accepted.error() == StampRefusal::kZero) {
      complain(topic + " zero", image.arrival, topic + ": images have no stamps (zero)");
    }
    return false;
  }
  if (accepted->step) {
    count("camera_clock_steps");
    say(step_text(topic, *accepted->step));
    drop_waiting_frames();
  }
  image.stamp += config_.camera_time_shift;
  return true;
}

// An image that cannot be used stays in the pair as an empty one: its partner need not wait.
void SensorAssembler::check_image(Camera& its, cv::Mat& gray) {
  const std::string& topic = its.watch.topic();
  if (gray.type() == CV_8UC1 && gray.size() == its.size) {
    if (its.said) say(topic + ": images have " + size_text(its.size) + " pixels again");
    its.said.reset();
    return;
  }
  if (!its.said || *its.said != gray.size()) {
    say(topic + ": images of " + size_text(gray.size()) +
        (gray.size() == its.size
             ? " pixels that are not 8 bit gray are not used"
             : " pixels are not used: the calibration is for " + size_text(its.size)));
  }
  its.said = gray.size();
  gray = cv::Mat();
  count("wrong_images");
}

void SensorAssembler::add_imu(const ImuSample& sample, ArrivalTime arrival) {
  if (auto event = imu_watch_.arrived(arrival)) say(std::move(*event));
  if (accept(sample, arrival)) {
    newest_imu_ = sample.stamp;
    queue_.push(sample);
  }
  poll(arrival);
}

bool SensorAssembler::accept(const ImuSample& sample, ArrivalTime arrival) {
  const std::string& topic = imu_watch_.topic();
  if (!is_possible(sample)) {
    count("imu_impossible");
    complain(
        "imu impossible",
        arrival,
        topic + ": values that are not finite, or beyond 100 rad/s or 1000 m/s^2, are left out");
    return false;
  }
  const auto accepted = imu_gate_.check(sample.stamp, arrival);
  if (!accepted) {
    count("imu_" + std::string(name(accepted.error())));
    if (accepted.error() == StampRefusal::kZero) {
      complain("imu zero", arrival, topic + ": samples have no stamps (zero)");
    }
    return false;
  }
  if (accepted->step) imu_clock_stepped(*accepted, sample.stamp);
  return true;
}

void SensorAssembler::imu_clock_stepped(const AcceptedStamp& accepted, Timestamp stamp) {
  count("clock_steps");
  say(step_text(imu_watch_.topic(), *accepted.step) + "; the odometry begins anew");
  drop_waiting_frames();
  newest_frame_.reset();
  for (Camera& one : cameras_) one.gate.forget();  // theirs has probably been set with it
  queue_.push(ClockStep{.stamp = stamp, .unseen = accepted.unseen});
}

void SensorAssembler::drop_waiting_frames() {
  count("frames_at_clock_step", held_.size() + pairing_.clear());
  held_.clear();
}

void SensorAssembler::poll(ArrivalTime now) {
  for (TopicWatch* watch : {&cameras_[0].watch, &cameras_[1].watch, &imu_watch_}) {
    if (auto event = watch->check(now)) say(std::move(*event));
  }
  advance(now);
}

void SensorAssembler::advance(ArrivalTime now) {
  for (StereoFrame& frame : pairing_.take(now)) {
    if (frame.left.empty() && frame.right.empty()) continue;  // both were wrong
    if (held_.size() == kMaxHeld) {
      held_.pop_front();
      count("dropped_backlog");
    }
    held_.push_back({std::move(frame), now});
  }
  while (!held_.empty() && release(held_.front(), now)) held_.pop_front();
}

// False while the frame waits for the IMU.
bool SensorAssembler::release(const HeldFrame& held, ArrivalTime now) {
  const std::string& topic = camera(Side::kLeft).watch.topic();
  const Duration ahead = newest_imu_ ? held.frame.stamp - *newest_imu_ : Duration::max();
  if (ahead > Duration{} && now - held.complete < config_.max_wait) return false;
  if (ahead > config_.max_ahead_of_imu) {
    count("frames_ahead_of_imu");
    if (newest_imu_) {
      complain("ahead", now, topic + ": stamps are " + seconds_text(ahead) + " ahead of the IMU's");
    }
  } else if (ahead < -config_.max_behind_imu) {
    count("frames_behind_imu");
    complain("behind", now, topic + ": stamps are " + seconds_text(-ahead) + " behind the IMU's");
  } else if (newest_frame_ && held.frame.stamp <= *newest_frame_) {
    count("images_late");  // the cameras' clock was set, but not the IMU's
  } else {
    give(held.frame);
  }
  return true;
}

void SensorAssembler::give(StereoFrame frame) {
  if (frame.left.empty() || frame.right.empty()) count("unpaired_images");
  newest_frame_ = frame.stamp;
  queue_.push(CameraFrame(std::move(frame)));
}

std::vector<std::string> SensorAssembler::take_events() {
  std::vector<std::string> events(events_.begin(), events_.end());
  events_.clear();
  return events;
}

std::map<std::string, std::uint64_t> SensorAssembler::faults() const {
  std::map<std::string, std::uint64_t> faults(counts_.begin(), counts_.end());
  faults["dropped_backlog"] += queue_.dropped_frames() + pairing_.dropped();
  faults["dropped_imu_backlog"] += queue_.dropped_imu();
  return faults;
}

std::size_t SensorAssembler::held() const {
  return pairing_.waiting() + held_.size() + queue_.size();
}

std::vector<std::string> SensorAssembler::silent_topics() const {
  std::vector<std::string> topics;
  for (const TopicWatch* watch : {&cameras_[0].watch, &cameras_[1].watch, &imu_watch_}) {
    if (watch->is_silent()) topics.push_back(watch->topic());
  }
  return topics;
}

void SensorAssembler::count(std::string_view name, std::uint64_t number) {
  if (number == 0) return;
  const auto found = counts_.find(name);
  if (found == counts_.end()) {
    counts_.emplace(name, number);
  } else {
    found->second += number;
  }
}

void SensorAssembler::say(std::string event) {
  if (events_.size() == kMaxEvents) events_.pop_front();
  events_.push_back(std::move(event));
}

void SensorAssembler::complain(std::string_view kind, ArrivalTime now, const std::string& event) {
  if (complaints_.is_new(kind, now)) say(event);
}

}  // namespace fleetloc

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <variant>

#include "robot/submap/submap_builder.hpp"
#include "robot/vio/initializer.hpp"
#include "robot/vio/sliding_window.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// Processor time that the calling thread has used; only for reports. Null: nothing is measured.
using CpuClock = std::function<Duration()>;

/// Input of the back end: the first keyframes of a session, or one more.
using KeyframeJob = std::variant<Initialization, KeyframeInput>;

struct KeyframeResult {
  std::shared_ptr<const WindowEstimate> window;
  Submap submap;                                  ///< robot, session and number are not set
  std::optional<SparsificationRefusal> no_edges;  ///< why it has no new ones
  Duration cpu{};                                 ///< what the job took
};

/// Optimizes the window and builds the submap. One session, one thread at a time.
class KeyframeWorker {
 public:
  struct Config {
    SlidingWindow::Config window;
    SubmapBuilder::Config submap;
  };
  KeyframeWorker(RectifiedStereo stereo,
                 const ImuNoise& noise,
                 const Config& config,
                 CpuClock cpu_clock);

  KeyframeResult run(const KeyframeJob& job);

 private:
  WindowEstimate optimize(const KeyframeJob& job);

  RectifiedStereo stereo_;
  ImuNoise noise_;
  Config config_;
  CpuClock cpu_clock_;
  std::optional<SlidingWindow> window_;
  SubmapBuilder builder_;
};

/// Runs a KeyframeWorker beside the tracking, one job at a time.
class BackEnd {
 public:
  BackEnd() = default;
  virtual ~BackEnd() = default;
  BackEnd(const BackEnd&) = delete;
  BackEnd& operator=(const BackEnd&) = delete;

  /// Starts a job. The result of the job before must have been taken.
  virtual void start(KeyframeJob job, Timestamp now) = 0;

  /// The result of a finished job; each is returned once.
  virtual std::optional<KeyframeResult> take(Timestamp now) = 0;
};

}  // namespace fleetloc

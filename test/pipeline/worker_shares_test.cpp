// How the workers of one localizer are shared by many robots.
#include <algorithm>

#include <gmock/gmock.h>

#include "test/pipeline/many_robots.hpp"

namespace fleetloc {
namespace {

class Shares : public ManyRobots {
 protected:
  struct Running {
    LocalizerPool::Job job;
    int done_ms;
  };

  static constexpr int kWarmUpMilliseconds =
      3000;  // before that, who has had nothing yet comes first

  void serve(int workers, const std::map<RobotId, int>& job_ms, int duration_ms) {
    for (const auto& [robot, ms] : job_ms) open(session_of(robot), 0.0);
    std::vector<Running> running;
    for (int ms = 0; ms < duration_ms; ++ms) {
      send_due(job_ms, ms);
      std::erase_if(running, [&](Running& one) {
        if (one.done_ms > ms) return false;
        finish(one, job_ms, ms);
        return true;
      });
      while (static_cast<int>(running.size()) < workers) {
        auto job = pool_.take_job(at(1e-3 * ms));
        if (!job) break;
        const int cost = job_ms.at(job->robot);
        running.push_back({std::move(*job), ms + cost});
      }
    }
  }

  void send_due(const std::map<RobotId, int>& job_ms, int ms) {
    int phase = 0;
    for (const auto& [robot, cost] : job_ms) {
      if ((ms + 37 * phase++) % 500 != 0) continue;
      send(submap_of(session_of(robot), static_cast<std::uint32_t>(ms)), 1e-3 * ms);
    }
  }

  void finish(const Running& one, const std::map<RobotId, int>& job_ms, int ms) {
    const double waited_s = 1e-3 * ms - to_seconds(one.job.received.time_since_epoch());
    double& longest_s = longest_s_[one.job.robot];
    if (ms > kWarmUpMilliseconds) longest_s = std::max(longest_s, waited_s);
    used_s_[one.job.robot] += 1e-3 * job_ms.at(one.job.robot);
    pool_.finish(one.job, LocalizationResult{}, 1.0, at(1e-3 * ms));
  }

  std::map<RobotId, double> longest_s_;  // from the oldest submap of a job to its answer
  std::map<RobotId, double> used_s_;
};

TEST_F(Shares, TwoSlowRobotsDelayTheOthersByOneJobOnly) {
  std::map<RobotId, int> job_ms{{"slow_1", 800}, {"slow_2", 800}};
  for (int i = 0; i < 8; ++i) job_ms["robot_" + std::to_string(i)] = 20;
  serve(1, job_ms, 60'000);
  for (const auto& [robot, longest_s] : longest_s_) {
    if (job_ms.at(robot) == 20) {
      EXPECT_LE(longest_s, 0.8 + 2 * 8 * 0.02) << robot;
    }
  }
  EXPECT_NEAR(used_s_["slow_1"], used_s_["slow_2"], 2.0);
  EXPECT_GT(used_s_["slow_1"], 15.0) << "what the others leave is used";
}

TEST_F(Shares, ASlowRobotOccupiesOneWorkerOnly) {
  std::map<RobotId, int> job_ms{{"slow", 3000}};
  for (int i = 0; i < 8; ++i) job_ms["robot_" + std::to_string(i)] = 20;
  serve(2, job_ms, 30'000);
  for (const auto& [robot, longest_s] : longest_s_) {
    if (robot != "slow") {
      EXPECT_LE(longest_s, 8 * 0.02 + 0.01) << robot;
    }
  }
}

TEST_F(Shares, AllGetTheSameWhenTheWorkersAreOverloaded) {
  std::map<RobotId, int> job_ms;
  for (int i = 0; i < 5; ++i) job_ms["quick_" + std::to_string(i)] = 250;
  for (int i = 0; i < 5; ++i) job_ms["slow_" + std::to_string(i)] = 500;
  serve(1, job_ms, 120'000);
  for (const auto& [robot, used_s] : used_s_) EXPECT_NEAR(used_s, 12.0, 1.5) << robot;
}

}  // namespace
}  // namespace fleetloc

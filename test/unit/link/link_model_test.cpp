#include "shared/link/link_model.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Timestamp kStart{std::chrono::seconds(100)};
constexpr std::size_t kBytes = 100;

using Fates = std::vector<std::vector<Timestamp>>;

/// Of datagrams that are sent each millisecond.
Fates fates(const LinkDirection& direction, int datagrams, std::uint64_t seed = 1) {
  LinkModel link(direction, seed);
  Fates fates;
  for (int i = 0; i < datagrams; ++i) {
    fates.push_back(link.arrivals(kStart + milliseconds(i), kBytes));
  }
  return fates;
}

/// Everything at once.
LinkDirection terrible() {
  return {.loss = 0.3,
          .delay_s = 0.1,
          .rate_bytes_per_s = 80'000.0,
          .queue_bytes = 4000,
          .burst_length = 3.0,
          .jitter_s = 0.05,
          .reordering = 0.1,
          .reordering_delay_s = 0.2,
          .duplication = 0.2,
          .rate_trace = {.steps = {{0.0, 100'000.0}, {0.1, 50'000.0}}, .repeat_s = 0.2},
          .outages = {.at = {{.from_s = 0.05, .for_s = 0.02}},
                      .periodic = {.every_s = 0.1, .from_s = 0.01, .for_s = 0.01}}};
}

TEST(LinkModel, IsPerfectByDefault) {
  for (const auto& arrivals : fates(perfect_link().uplink, 100)) ASSERT_THAT(arrivals, SizeIs(1));
  EXPECT_THAT(LinkModel(perfect_link().uplink, 1).arrivals(kStart, 1000), ElementsAre(kStart));
}

TEST(LinkModel, GivesTheSameFatesForTheSameSeedOnly) {
  for (const LinkDirection& direction : {LinkDirection{.loss = 0.5}, terrible()}) {
    EXPECT_EQ(fates(direction, 500, 7), fates(direction, 500, 7));
    EXPECT_NE(fates(direction, 500, 7), fates(direction, 500, 8));
  }
}

TEST(LinkModel, DelaysBehindTheBottleneck) {
  LinkModel link({.delay_s = 1.0, .rate_bytes_per_s = 10'000.0, .queue_bytes = 100'000}, 1);
  EXPECT_THAT(link.arrivals(kStart, 1000), ElementsAre(kStart + milliseconds(1100)));
  EXPECT_THAT(link.arrivals(kStart, 500), ElementsAre(kStart + milliseconds(1150)));
}

TEST(LinkModel, UsesTheBottleneckForWhatIsLostBehindIt) {
  LinkModel lossy({.loss = 1.0, .rate_bytes_per_s = 1000.0, .queue_bytes = 1500}, 1);
  EXPECT_THAT(lossy.arrivals(kStart, 1000), IsEmpty());
  LinkModel lossless({.rate_bytes_per_s = 1000.0, .queue_bytes = 1500}, 1);
  EXPECT_THAT(lossless.arrivals(kStart, 1000), SizeIs(1));
  EXPECT_THAT(lossless.arrivals(kStart, 1000), IsEmpty());
}

TEST(LinkModel, LosesWhatLeavesTheBottleneckInAnOutage) {
  LinkModel link({.delay_s = 5.0,
                  .rate_bytes_per_s = 1000.0,
                  .queue_bytes = 10'000,
                  .outages = {.at = {{.from_s = 2.5, .for_s = 1.0}}}},
                 1);
  EXPECT_THAT(link.arrivals(kStart, 1000), ElementsAre(kStart + seconds(6)));
  EXPECT_THAT(link.arrivals(kStart, 1000), ElementsAre(kStart + seconds(7)));
  EXPECT_THAT(link.arrivals(kStart, 1000), IsEmpty());
  EXPECT_THAT(link.arrivals(kStart, 1000), ElementsAre(kStart + seconds(9)));
}

TEST(LinkModel, CountsTimeFromItsStart) {
  const LinkDirection out{.outages = {.at = {{.from_s = 10.0, .for_s = 1.0}}}};
  LinkModel by_itself(out, 1);
  EXPECT_THAT(by_itself.arrivals(kStart, kBytes), SizeIs(1));
  EXPECT_THAT(by_itself.arrivals(kStart + seconds(10), kBytes), IsEmpty());
  LinkModel before(out, 1);
  before.start(kStart - seconds(4));
  before.start(kStart);  // too late
  EXPECT_THAT(before.arrivals(kStart + seconds(6), kBytes), IsEmpty());
  EXPECT_THAT(before.arrivals(kStart + seconds(10), kBytes), SizeIs(1));
}

TEST(LinkModel, NeverGoesBackInTime) {
  LinkModel link({.delay_s = 1.0}, 1);
  EXPECT_THAT(link.arrivals(kStart + seconds(1), kBytes), ElementsAre(kStart + seconds(2)));
  EXPECT_THAT(link.arrivals(kStart, kBytes), ElementsAre(kStart + seconds(2)));
}

TEST(LinkModel, LetsDatagramsOvertakeEachOtherByJitter) {
  int overtaken = 0;
  Timestamp latest{};
  for (const auto& arrivals : fates({.jitter_s = 0.01}, 1000)) {
    if (arrivals.front() < latest) ++overtaken;
    latest = std::max(latest, arrivals.front());
  }
  EXPECT_GT(overtaken, 500);
  EXPECT_LT(overtaken, 1000);
}

TEST(LinkModel, DoublesTheShareOfWhatArrivesThatItIsTold) {
  constexpr int kDatagrams = 20'000;
  constexpr double kShare = 0.2;
  const Fates all = fates({.loss = 0.5, .jitter_s = 0.01, .duplication = kShare}, kDatagrams, 3);
  const auto with = [&](std::size_t copies) {
    return static_cast<double>(std::ranges::count(all, copies, &std::vector<Timestamp>::size));
  };
  const double arrived = with(1) + with(2);
  EXPECT_NEAR(arrived / kDatagrams, 0.5, 5.0 * std::sqrt(0.25 / kDatagrams));
  EXPECT_NEAR(with(2) / arrived, kShare, 5.0 * std::sqrt(kShare * (1.0 - kShare) / arrived));
  for (const auto& arrivals : all) {
    if (arrivals.size() < 2) continue;
    ASSERT_NE(arrivals[0], arrivals[1]) << "each has its own delay";
  }
}

// What makes settings comparable at one seed.
TEST(LinkModel, DrawsTheSameForADatagramWhateverTheOtherSettingsAre) {
  constexpr int kDatagrams = 1000;
  LinkDirection without = terrible();
  without.rate_bytes_per_s = 0.0;
  without.rate_trace = {};
  without.outages = {};
  const Fates limited = fates(terrible(), kDatagrams);
  const Fates unlimited = fates(without, kDatagrams);
  int passed = 0;
  for (std::size_t i = 0; i < kDatagrams; ++i) {
    if (limited[i].empty()) continue;
    ++passed;
    ASSERT_EQ(limited[i].size(), unlimited[i].size()) << i;
    if (limited[i].size() == 1) continue;
    EXPECT_EQ(limited[i][1] - limited[i][0], unlimited[i][1] - unlimited[i][0]) << i;
  }
  EXPECT_GT(passed, 100);
  EXPECT_LT(passed, std::ranges::count_if(unlimited, [](const auto& all) { return !all.empty(); }));

  LinkDirection late = without;
  late.delay_s += 1.0;
  const Fates delayed = fates(late, kDatagrams);
  for (std::size_t i = 0; i < kDatagrams; ++i) {
    ASSERT_EQ(delayed[i].size(), unlimited[i].size());
    for (std::size_t copy = 0; copy < delayed[i].size(); ++copy) {
      const double later = to_seconds(delayed[i][copy] - unlimited[i][copy]);
      EXPECT_NEAR(later, 1.0, 2e-9) << i;
    }
  }
}

}  // namespace
}  // namespace fleetloc

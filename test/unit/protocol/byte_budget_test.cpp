#include "shared/protocol/byte_budget.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "shared/link/link_model.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

ByteBudget::Config some_config() {
  return {.max_bytes_per_s = 3000.0,
          .max_bytes_per_s_high_loss = 6000.0,
          .high_loss = 0.75,
          .min_bytes_per_s = 300.0,
          .burst_bytes = 1600.0,
          .max_queueing_s = 0.2,
          .increase_bytes_per_s2 = 100.0,
          .decrease = 0.7,
          .shortest_memory_s = 120.0,
          .unmeasured_bytes_per_s = 1200.0,
          .measured_for_s = 10.0};
}

/// Sends 500-byte datagrams as fast as its budget allows over a bottleneck that others may share.
class Sender {
 public:
  explicit Sender(LinkModel& bottleneck) : bottleneck_(&bottleneck) {}

  void step(double s) {
    budget_.advance(at(s), 0.0);
    while (!under_way_.empty() && under_way_.front().second <= at(s)) {
      budget_.measured(under_way_.front().second - under_way_.front().first, at(s));
      under_way_.erase(under_way_.begin());
    }
    if (!budget_.allows(500)) return;
    budget_.spend(500);
    if (s > 120.0) sent_ += 500.0;
    for (const Timestamp arrival : bottleneck_->arrivals(at(s), 500)) {
      under_way_.emplace_back(at(s), arrival);
    }
  }
  [[nodiscard]] double bytes() const { return sent_; }
  [[nodiscard]] const ByteBudget& budget() const { return budget_; }

 private:
  LinkModel* bottleneck_;
  ByteBudget budget_{some_config()};
  std::vector<std::pair<Timestamp, Timestamp>> under_way_;
  double sent_ = 0.0;
};

TEST(ByteBudget, BringsItsRateOnALinkWithoutAQueue) {
  LinkModel link({.loss = 0.0, .delay_s = 0.5}, 1);
  Sender sender(link);
  for (double s = 0.0; s < 180.0; s += 0.005) sender.step(s);
  EXPECT_NEAR(sender.bytes() / 60.0, 3000.0, 60.0);
}

TEST(ByteBudget, LossAloneDoesNotSlowItDown) {
  ByteBudget budget(some_config());
  auto advance_to = [&, s = 0.0](double end_s, double loss) mutable {
    for (; s < end_s; s += 1.0) {
      budget.advance(at(s), loss);
      budget.measured(from_seconds(0.5), at(s));
    }
  };
  advance_to(60.0, 0.5);
  EXPECT_EQ(budget.bytes_per_s(), 3000.0);
  advance_to(120.0, 0.8);
  EXPECT_EQ(budget.bytes_per_s(), 6000.0);
}

TEST(ByteBudget, KeepsTheQueueOfABottleneckShort) {
  LinkModel link({.loss = 0.0, .delay_s = 0.3, .rate_bytes_per_s = 1000.0, .queue_bytes = 60'000},
                 1);
  Sender sender(link);
  double longest_s = 0.0;
  for (double s = 0.0; s < 300.0; s += 0.005) {
    sender.step(s);
    if (s > 60.0) longest_s = std::max(longest_s, to_seconds(sender.budget().queueing()));
  }
  EXPECT_LT(longest_s, 2.0);
  EXPECT_GT(sender.bytes() / 180.0, 600.0);
  EXPECT_LT(sender.bytes() / 180.0, 1010.0);
}

// Jain's index of their shares.
TEST(ByteBudget, SharesABottleneckEvenly) {
  LinkModel link({.loss = 0.0, .delay_s = 0.1, .rate_bytes_per_s = 8000.0, .queue_bytes = 60'000},
                 1);
  std::vector<Sender> senders(6, Sender(link));
  for (double s = 0.0; s < 600.0; s += 0.005) {
    for (std::size_t i = 0; i < senders.size(); ++i) {
      if (s > 5.0 * static_cast<double>(i)) senders[i].step(s);  // one joins after the other
    }
  }
  double sum = 0.0;
  double squares = 0.0;
  for (const Sender& sender : senders) {
    sum += sender.bytes();
    squares += sender.bytes() * sender.bytes();
  }
  EXPECT_GT(sum * sum / (6.0 * squares), 0.95);
  EXPECT_GT(sum / 480.0, 0.7 * 8000.0);
}

TEST(ByteBudget, IsSmallWhileNobodyAnswers) {
  ByteBudget budget(some_config());
  budget.advance(at(0.0), 0.7);
  EXPECT_EQ(budget.bytes_per_s(), 1200.0);
  budget.measured(from_seconds(0.5), at(5.0));
  budget.advance(at(14.0), 0.7);
  EXPECT_EQ(budget.bytes_per_s(), 3000.0);
  budget.advance(at(16.0), 0.7);
  EXPECT_EQ(budget.bytes_per_s(), 1200.0);
  budget.measured(from_seconds(0.5), at(60.0));
  budget.advance(at(60.0), 0.7);
  EXPECT_EQ(budget.bytes_per_s(), 3000.0);
}

TEST(ByteBudget, ALocalizerThatTakesOverGetsBytesOnTop) {
  ByteBudget budget(some_config());
  budget.advance(at(0.0), 0.0);
  budget.grant(6000);
  EXPECT_FALSE(budget.allows(5000));  // on a link of which nothing is known
  budget.measured(from_seconds(0.5), at(0.0));
  EXPECT_FALSE(budget.allows(5000));
  budget.grant(6000);
  EXPECT_TRUE(budget.allows(5000));
}

}  // namespace
}  // namespace fleetloc

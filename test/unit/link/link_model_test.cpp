#include "shared/link/link_model.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr Timestamp kStart{std::chrono::seconds(100)};

std::vector<std::optional<Timestamp>> fates(LinkModel link, int datagrams) {
  std::vector<std::optional<Timestamp>> arrivals;
  arrivals.reserve(static_cast<std::size_t>(datagrams));
  for (int i = 0; i < datagrams; ++i) {
    arrivals.push_back(link.arrival(kStart + milliseconds(i), 100));
  }
  return arrivals;
}

TEST(LinkModel, IsPerfectByDefault) {
  for (const auto& arrival : fates(LinkModel(perfect_link().uplink, 1), 100)) {
    ASSERT_TRUE(arrival);
  }
  EXPECT_EQ(LinkModel(perfect_link().uplink, 1).arrival(kStart, 1000), kStart);
}

TEST(LinkModel, GivesTheSameFatesForTheSameSeedOnly) {
  const LinkDirection half{.loss = 0.5, .delay_s = 0.1};
  EXPECT_EQ(fates(LinkModel(half, 7), 200), fates(LinkModel(half, 7), 200));
  EXPECT_NE(fates(LinkModel(half, 7), 200), fates(LinkModel(half, 8), 200));
}

TEST(LinkModel, LosesTheShareThatItIsTold) {
  constexpr int kDatagrams = 20'000;
  for (const double loss : {0.0, 0.1, 0.5, 0.7, 1.0}) {
    const auto arrivals = fates(LinkModel({.loss = loss}, 3), kDatagrams);
    const auto lost = std::ranges::count(arrivals, false, &std::optional<Timestamp>::has_value);
    EXPECT_NEAR(static_cast<double>(lost) / kDatagrams, loss, 0.015) << loss;
  }
}

TEST(LinkModel, Delays) {
  EXPECT_EQ(LinkModel({.delay_s = 0.25}, 1).arrival(kStart, 1000), kStart + milliseconds(250));
}

TEST(LinkModel, SendsOneDatagramAfterTheOtherAtItsRate) {
  LinkModel link({.delay_s = 1.0, .rate_bytes_per_s = 10'000.0, .queue_bytes = 100'000}, 1);
  EXPECT_EQ(link.arrival(kStart, 1000), kStart + milliseconds(1100));
  EXPECT_EQ(link.arrival(kStart, 500), kStart + milliseconds(1150));
  // The bottleneck is free again.
  EXPECT_EQ(link.arrival(kStart + milliseconds(500), 1000), kStart + milliseconds(1600));
}

TEST(LinkModel, DropsWhatItsQueueCannotHold) {
  LinkModel link({.rate_bytes_per_s = 1000.0, .queue_bytes = 2000}, 1);
  EXPECT_TRUE(link.arrival(kStart, 1000));
  EXPECT_TRUE(link.arrival(kStart, 1000));
  EXPECT_FALSE(link.arrival(kStart, 1000));
  // Half of the first has left; 500 bytes fit, and what was refused takes no time.
  EXPECT_EQ(link.arrival(kStart + milliseconds(500), 500), kStart + milliseconds(2500));
}

TEST(LinkModel, UsesTheBottleneckForWhatIsLostBehindIt) {
  LinkModel link({.loss = 1.0, .rate_bytes_per_s = 1000.0, .queue_bytes = 1500}, 1);
  EXPECT_FALSE(link.arrival(kStart, 1000));
  LinkModel lossless({.rate_bytes_per_s = 1000.0, .queue_bytes = 1500}, 1);
  EXPECT_TRUE(lossless.arrival(kStart, 1000));
  EXPECT_FALSE(lossless.arrival(kStart, 1000));
}

std::string link_yaml(const std::string& uplink) {
  return "seed: 5\nuplink: {" + uplink +
         "}\ndownlink: {loss: 0, delay_s: 0.5, rate_bytes_per_s: 0, queue_bytes: 0}\n";
}

LinkConfig read(const std::string& uplink) {
  return read_link_config(ConfigReader::from_string(link_yaml(uplink)));
}

std::string config_error(const std::string& uplink) {
  try {
    read(uplink);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(LinkConfig, IsReadFromYaml) {
  const LinkConfig link =
      read("loss: 0.3, delay_s: 1.5, rate_bytes_per_s: 31250, queue_bytes: 65536");
  EXPECT_EQ(link.seed, 5);
  EXPECT_EQ(link.uplink.loss, 0.3);
  EXPECT_EQ(link.uplink.delay_s, 1.5);
  EXPECT_EQ(link.uplink.rate_bytes_per_s, 31250.0);
  EXPECT_EQ(link.uplink.queue_bytes, 65536);
  EXPECT_EQ(link.downlink.delay_s, 0.5);
}

TEST(LinkConfig, NamesWhatIsWrong) {
  EXPECT_THAT(config_error("loss: 1.1, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 0"),
              HasSubstr("uplink.loss: must be in 0..1"));
  EXPECT_THAT(config_error("loss: .nan, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 0"),
              HasSubstr("loss: must be in"));
  EXPECT_THAT(config_error("loss: 0, delay_s: 0, rate_bytes_per_s: 1000, queue_bytes: 0"),
              HasSubstr("queue_bytes: must be in 1500.."));
  EXPECT_THAT(config_error("loss: 0, delay_s: 0, rate_bytes_per_s: 0.5, queue_bytes: 9000"),
              HasSubstr("rate_bytes_per_s: must be 0 (unlimited) or at least 1"));
  EXPECT_THAT(config_error("loss: 0, delay_s: 0, queue_bytes: 0"),
              HasSubstr("rate_bytes_per_s: missing"));
  EXPECT_THAT(config_error("loss: 0, delay_s: 0, rate_bytes_per_s: 0, queue_bytes: 0, jitter_s: 1"),
              HasSubstr("uplink.jitter_s: unknown key"));
}

}  // namespace
}  // namespace fleetloc

#include "cloud/pool/early_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr SessionNumber kSession{3};

SubmapSample sample(std::uint32_t number, const RobotId& robot = "robot") {
  SubmapSample sample;
  sample.robot = robot;
  sample.session = kSession;
  sample.number = SampleNumber{number};
  return sample;
}

TEST(EarlySamples, AreKeptInTheirOrderUntilTheSessionComes) {
  EarlySamples early;
  early.keep(sample(1), 500, at(0));
  early.keep(sample(2), 600, at(1));
  const auto taken = early.take("robot", kSession);
  ASSERT_THAT(taken, SizeIs(2));
  EXPECT_EQ(taken[0].sample.number, SampleNumber{1});
  EXPECT_EQ(taken[1].bytes, 600);
  EXPECT_THAT(early.take("robot", kSession), IsEmpty());
}

TEST(EarlySamples, OfAnotherSessionOrRobotAreNotTaken) {
  EarlySamples early;
  early.keep(sample(1), 500, at(0));
  early.keep(sample(1, "other"), 500, at(0));
  EXPECT_THAT(early.take("robot", SessionNumber{4}), IsEmpty());
  EXPECT_THAT(early.take("robot", kSession), IsEmpty());
  EXPECT_THAT(early.take("other", kSession), SizeIs(1));
}

TEST(EarlySamples, ALaterSessionTakesThePlaceOfAnEarlierOne) {
  EarlySamples early;
  early.keep(sample(1), 500, at(0));
  SubmapSample later = sample(1);
  later.session = SessionNumber{4};
  early.keep(later, 500, at(0));
  EXPECT_THAT(early.take("robot", SessionNumber{4}), SizeIs(1));
}

TEST(EarlySamples, AreBoundedInNumber) {
  EarlySamples early;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    early.keep(sample(i), 500, at(0));
    early.keep(sample(i, "robot_" + std::to_string(i)), 500, at(0));
  }
  EXPECT_THAT(early.take("robot", kSession), SizeIs(16));
  EXPECT_THAT(early.take("robot_10", kSession), SizeIs(1));
  EXPECT_THAT(early.take("robot_999", kSession), IsEmpty());
}

TEST(EarlySamples, AreForgottenAfterTenSeconds) {
  EarlySamples early;
  early.keep(sample(1), 500, at(0));
  early.clean_up(at(9.9));
  early.keep(sample(1, "other"), 500, at(9.9));
  early.clean_up(at(10.1));
  EXPECT_THAT(early.take("robot", kSession), IsEmpty());
  EXPECT_THAT(early.take("other", kSession), SizeIs(1));
}

}  // namespace
}  // namespace fleetloc

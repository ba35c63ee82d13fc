#include "cloud/pool/admission.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

class AdmissionTest : public testing::Test {
 protected:
  static constexpr Admission::Config kConfig{.max_load = 0.8,
                                             .open_load = 0.6,
                                             .max_wait_s = 0.5,
                                             .open_wait_s = 0.25,
                                             .new_for_s = 5.0,
                                             .session_load = 0.1};
  Admission admission_{kConfig};
};

TEST_F(AdmissionTest, FollowsTheMeasuredWorkAndNotTheNumberOfRobots) {
  EXPECT_TRUE(admission_.update(0.5, {.all = 500}, at(0.0)));
  EXPECT_FALSE(admission_.update(0.85, {.all = 3}, at(1.0)));
}

TEST_F(AdmissionTest, OpensAgainOnlyAfterClearlyLessWork) {
  EXPECT_FALSE(admission_.update(0.9, {.all = 5}, at(0.0)));
  EXPECT_FALSE(admission_.update(0.7, {.all = 5}, at(1.0)));
  EXPECT_TRUE(admission_.update(0.5, {.all = 5}, at(2.0)));
  EXPECT_TRUE(admission_.update(0.7, {.all = 5}, at(3.0)));
}

TEST_F(AdmissionTest, CountsRobotsThatCameAMomentAgoWithTheWorkOfAMeanOne) {
  EXPECT_TRUE(admission_.is_new(at(1.0), at(5.0)));
  EXPECT_FALSE(admission_.is_new(at(1.0), at(7.0)));
  EXPECT_TRUE(admission_.update(0.4, {.all = 14, .fresh = 4}, at(0.0))) << "0.56 are expected";
  EXPECT_FALSE(admission_.update(0.4, {.all = 21, .fresh = 11}, at(1.0))) << "0.84";
}

TEST_F(AdmissionTest, AnIdleLocalizerDoesNotTakeAWholeFleetAtOnce) {
  EXPECT_TRUE(admission_.update(0.0, {.all = 7, .fresh = 7}, at(0.0)));
  EXPECT_FALSE(admission_.update(0.0, {.all = 8, .fresh = 8}, at(0.1)));
  EXPECT_TRUE(admission_.update(0.2, {.all = 8, .fresh = 0}, at(6.0))) << "they do little";
}

TEST_F(AdmissionTest, ClosesWhileSubmapsWaitForAWorker) {
  admission_.waited(milliseconds(100), at(0.0));
  EXPECT_TRUE(admission_.update(0.5, {.all = 5}, at(0.1)));
  admission_.waited(milliseconds(900), at(1.0));
  EXPECT_FALSE(admission_.update(0.5, {.all = 5}, at(1.1)));
  EXPECT_FALSE(admission_.update(0.5, {.all = 5}, at(3.0)));
  EXPECT_TRUE(admission_.update(0.5, {.all = 5}, at(6.0))) << "none has since";
}

}  // namespace
}  // namespace fleetloc

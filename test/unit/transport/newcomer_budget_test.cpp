#include "shared/transport/workarounds/newcomer_budget.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

class NewcomerBudgetTest : public testing::Test {
 protected:
  int spend(std::uint32_t address, int times) {
    int spent = 0;
    for (int i = 0; i < times; ++i) spent += budget_.spend(address, now_) ? 1 : 0;
    return spent;
  }

  NewcomerBudget budget_;
  NewcomerBudget::Time now_{hours(1000)};
};

TEST_F(NewcomerBudgetTest, OfAnAddressIsAThousandAndReturnsByTwoASecond) {
  EXPECT_EQ(spend(1, 2000), 1000);
  now_ += seconds(10);
  EXPECT_EQ(spend(1, 2000), 20);
  EXPECT_EQ(spend(2, 2000), 1000) << "another one has its own";
}

TEST_F(NewcomerBudgetTest, OfAllIsThreeThousandAndReturnsByTwentyASecond) {
  int spent = 0;
  for (std::uint32_t address = 1; address <= 10'000; ++address) spent += spend(address, 1);
  EXPECT_EQ(spent, 3000);
  now_ += seconds(10);
  EXPECT_EQ(spend(77'777, 2000), 200);
}

}  // namespace
}  // namespace fleetloc

#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "shared/model/localization_result.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {
namespace {

TEST(Names, OfStatusAreDistinctAndKnown) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(LocalizationStatus::kLost); ++i) {
    names.insert(name(static_cast<LocalizationStatus>(i)));
  }
  EXPECT_EQ(names.size(), 11U);
  EXPECT_EQ(names.count("unknown"), 0U);
  EXPECT_EQ(name(LocalizationStatus::kTooFewMatches), "too_few_matches");
}

TEST(Names, OfQualityAreDistinctAndKnown) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(Quality::kSearching); ++i) {
    names.insert(name(static_cast<Quality>(i)));
  }
  EXPECT_EQ(names.size(), 5U);
  EXPECT_EQ(names.count("unknown"), 0U);
  EXPECT_EQ(name(Quality::kDeadReckoning), "dead_reckoning");
}

}  // namespace
}  // namespace fleetloc

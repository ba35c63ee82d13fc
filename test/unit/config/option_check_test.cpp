#include "shared/config/option_check.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<std::string> kNoNumbers{
    "", "nan", "-nan", "inf", "-inf", "1e999", "one", "1x", "1 ", "0x10", "1,5"};

std::string verdict(const CLI::Validator& check, std::string text) {
  return check(text);
}

TEST(OptionCheck, TakesNumbersOfTheRangeAlone) {
  const auto check = number_in(0.0, 2.5);
  for (const char* text : {"0", "-0", "1.5", "2.5", "1e-3"}) {
    EXPECT_THAT(verdict(check, text), IsEmpty()) << text;
  }
  for (const char* text : {"-1e-9", "2.6", "1e10"}) {
    EXPECT_THAT(verdict(check, text), HasSubstr("is not 0 to 2.5")) << text;
  }
  for (const auto& text : kNoNumbers) EXPECT_THAT(verdict(check, text), HasSubstr(text)) << text;
}

TEST(OptionCheck, TakesPositiveNumbersAlone) {
  const auto check = positive_up_to(1e6);
  for (const char* text : {"1e-9", "1", "1000000"}) {
    EXPECT_THAT(verdict(check, text), IsEmpty()) << text;
  }
  for (const char* text : {"0", "-0", "-1", "1000001"}) {
    EXPECT_THAT(verdict(check, text), HasSubstr("above 0")) << text;
  }
  for (const auto& text : kNoNumbers) {
    EXPECT_THAT(verdict(check, text), HasSubstr("above 0")) << text;
  }
}

TEST(OptionCheck, TakesWholeNumbersWithoutASignAlone) {
  const auto check = whole_number();
  for (const char* text : {"0", "1", "18446744073709551615"}) {
    EXPECT_THAT(verdict(check, text), IsEmpty()) << text;
  }
  for (const char* text : {"-1", "1.5", "18446744073709551616"}) {
    EXPECT_THAT(verdict(check, text), HasSubstr("whole number")) << text;
  }
  for (const auto& text : kNoNumbers) {
    EXPECT_THAT(verdict(check, text), HasSubstr("whole number")) << text;
  }
}

}  // namespace
}  // namespace fleetloc

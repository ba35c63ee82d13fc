#include "shared/config/delimited_file.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;

DelimitedFile file_with(const std::string& content, char separator) {
  const std::string file = (test_folder() / "fleetloc_delimited_file.txt").string();
  std::ofstream(file) << content;
  return {file, separator};
}

template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const TextFileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(DelimitedFile, SkipsCommentsAndEmptyLinesButCountsThem) {
  DelimitedFile file = file_with("#a,b\r\n\r\n 1 , 2.5,x\r\n", ',');
  ASSERT_TRUE(file.next());
  EXPECT_EQ(file.line(), 3U);
  EXPECT_EQ(file.columns(), 3U);
  EXPECT_EQ(file.number(1), 2.5);
  EXPECT_EQ(file.text(2), "x");
  EXPECT_FALSE(file.next());
}

TEST(DelimitedFile, TakesRunsOfBlanksForOneSeparator) {
  DelimitedFile file = file_with("  1  2\t3 \n", ' ');
  ASSERT_TRUE(file.next());
  file.expect_columns(3);
  EXPECT_EQ(file.number(2), 3.0);
}

TEST(DelimitedFile, KeepsEmptyFieldsBetweenCommas) {
  DelimitedFile file = file_with("1,,3,\n", ',');
  ASSERT_TRUE(file.next());
  EXPECT_EQ(file.columns(), 4U);
  EXPECT_THAT(error_of([&] { static_cast<void>(file.number(1)); }), HasSubstr(":1: ''"));
}

TEST(DelimitedFile, ReadsStampsExactly) {
  DelimitedFile file = file_with("1403636580.838555648 1403636580838555648 7 0.5\n", ' ');
  ASSERT_TRUE(file.next());
  EXPECT_EQ(file.seconds(0), file.nanoseconds(1));
  EXPECT_EQ(file.seconds(2), Timestamp(std::chrono::seconds(7)));
  EXPECT_EQ(file.seconds(3), Timestamp(std::chrono::milliseconds(500)));
}

TEST(DelimitedFile, RefusesStampsWhoseDifferencesWouldOverflow) {
  DelimitedFile file = file_with("4611686018427387904,-4611686018427387905,9e9\n", ',');
  ASSERT_TRUE(file.next());
  EXPECT_EQ(file.nanoseconds(0), Timestamp(Duration(std::int64_t{1} << 62)));
  EXPECT_THAT(error_of([&] { static_cast<void>(file.nanoseconds(1)); }),
              HasSubstr(":1: '-4611686018427387905' is too large for a stamp"));
}

TEST(DelimitedFile, NamesFileAndLineOfWhatItCannotRead) {
  DelimitedFile file = file_with("1,2\n3,nan\n", ',');
  file.next();
  file.next();
  EXPECT_THAT(error_of([&] { static_cast<void>(file.number(1)); }),
              HasSubstr("fleetloc_delimited_file.txt:2: 'nan' is not a finite number"));
  EXPECT_THAT(error_of([&] { file.expect_columns(3); }), HasSubstr(":2: 2 columns instead of 3"));
  EXPECT_THAT(error_of([&] { static_cast<void>(file.seconds(1)); }), HasSubstr("not a stamp"));
  EXPECT_THAT(error_of([] { DelimitedFile("/nowhere", ','); }),
              HasSubstr("/nowhere: no such file"));
}

}  // namespace
}  // namespace fleetloc

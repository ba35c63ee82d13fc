#include "deploy/monitor/line_tail.hpp"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>

#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(LineTail, GivesEachLineOnceAndOnlyWhenItHasEnded) {
  const auto file = test_folder() / "growing.txt";
  LineTail tail(file);
  EXPECT_THAT(tail.new_lines(), IsEmpty());  // there is no file yet
  std::ofstream stream(file);
  stream << "one\ntwo\nthr" << std::flush;
  EXPECT_THAT(tail.new_lines(), ElementsAre("one", "two"));
  EXPECT_THAT(tail.new_lines(), IsEmpty());
  stream << "e" << std::flush;
  EXPECT_THAT(tail.new_lines(), IsEmpty());
  stream << "e\n\nfour\n" << std::flush;
  EXPECT_THAT(tail.new_lines(), ElementsAre("three", "", "four"));
}

TEST(LineTail, FollowsAFileThatIsBegunAnew) {
  const auto file = test_folder() / "rotated.csv";
  CsvTail table(file);
  std::vector<double> values;
  const auto read = [&] { table.read([&] { values.push_back(table.number("value")); }); };
  std::ofstream(file) << "name,value\na,1\nb,2\n";
  read();
  std::filesystem::rename(file, test_folder() / "rotated.csv.1");
  std::ofstream(file) << "name,value\nc,3\n";
  read();
  EXPECT_THAT(values, ElementsAre(1.0, 2.0, 3.0));
}

TEST(CsvTail, FindsFieldsByTheirColumn) {
  const auto file = test_folder() / "table.csv";
  CsvTail table(file);
  std::ofstream stream(file);
  std::vector<double> values;
  const auto read = [&] {
    stream.flush();
    table.read([&] { values.push_back(table.number("value")); });
  };
  stream << "name,value\n";
  read();
  stream << "first,1.5\ntoo,many,fields\nshort\nsecond,-2\n";
  read();
  EXPECT_THAT(values, ElementsAre(1.5, -2.0));
  EXPECT_EQ(table.text("name"), "second");
  EXPECT_TRUE(std::isnan(table.number("name")));
  EXPECT_TRUE(std::isnan(table.number("no_such_column")));
}

}  // namespace
}  // namespace fleetloc

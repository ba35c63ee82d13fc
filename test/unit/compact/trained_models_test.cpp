#include "shared/compact/trained_models.hpp"

#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

/// A table with every model at the same start, without the row of one name.
std::string table_of(int share, const std::string& left_out = "") {
  CompactModels models;
  std::ostringstream table;
  for_each_row(models, [&](const std::string& name, std::span<BitModel>) {
    if (name != left_out) table << name << ' ' << share << '\n';
  });
  return table.str();
}

std::string reason_against(const std::string& table) {
  try {
    read_models(table);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(TrainedModels, EveryModelIsInOneRow) {
  CompactModels models;
  std::set<std::string> names;
  std::set<const BitModel*> in_rows;
  std::size_t rows = 0;
  for_each_row(models, [&](const std::string& name, std::span<BitModel> row) {
    ++rows;
    names.insert(name);
    for (const BitModel& model : row) in_rows.insert(&model);
  });
  EXPECT_EQ(names.size(), rows);
  EXPECT_EQ(in_rows.size() * sizeof(BitModel), sizeof(CompactModels));  // it holds nothing else
}

TEST(TrainedModels, TheTableOfTheSpecificationIsRead) {
  CompactModels models = trained_models();
  std::set<std::uint32_t> probabilities;
  for_each_row(models, [&](const std::string&, std::span<BitModel> row) {
    for (const BitModel& model : row) probabilities.insert(model.probability_of_zero());
  });
  EXPECT_GT(probabilities.size(), 50U);
}

TEST(TrainedModels, ARowStartsItsModelsAndLeavesTheRestAtOneHalf) {
  const std::string row = "submap.u.1.longer";
  CompactModels models = read_models(table_of(128, row) + row + " 64 32  # behind it a comment\n");
  for_each_row(models, [&](const std::string& name, std::span<BitModel> models_of_row) {
    std::size_t place = 0;
    for (const BitModel& model : models_of_row) {
      const std::uint32_t set = (1U << 15U) - model.probability_of_zero();
      const std::uint32_t expected = name != row || place > 1 ? 128 : place == 0 ? 64 : 32;
      EXPECT_EQ(set, expected << 7U) << name << ' ' << place;
      ++place;
    }
  });
}

TEST(TrainedModels, ATableThatDoesNotFitIsRefusedByTheNameOfItsRow) {
  using testing::HasSubstr;
  EXPECT_EQ(reason_against(table_of(77)), "");
  EXPECT_THAT(reason_against(table_of(77, "submap.follows")), HasSubstr("submap.follows: no row"));
  const auto with = [](const std::string& row) { return reason_against(table_of(77) + row); };
  EXPECT_THAT(with("submap.follow 3\n"), HasSubstr("submap.follow: no such models"));
  EXPECT_THAT(with("submap.follows 3\n"), HasSubstr("submap.follows: a second row"));
  const auto in_place = [](const std::string& shares) {
    return reason_against(table_of(77, "submap.follows") + "submap.follows" + shares + '\n');
  };
  EXPECT_THAT(in_place(""), HasSubstr("submap.follows: no shares"));
  EXPECT_THAT(in_place(" 1 2"), HasSubstr("submap.follows: more shares than models"));
  for (const char* share : {"0", "256", "-1", "1x", "1e2", "99999999999"}) {
    EXPECT_THAT(in_place(std::string(" ") + share), HasSubstr("is no share")) << share;
  }
}

}  // namespace
}  // namespace fleetloc

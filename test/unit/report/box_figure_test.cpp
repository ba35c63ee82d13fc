#include "deploy/evaluation/report/box_figure.hpp"

#include <numeric>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

BoxFigure figure_of(std::vector<BoxGroup> groups) {
  return {.id = "boxes",
          .title = "errors",
          .x_label = "link",
          .y_label = "error [m]",
          .series = {"localized", "aligned once"},
          .groups = std::move(groups)};
}

TEST(Box, HoldsTheQuantilesOfItsValues) {
  std::vector<double> values(101);
  std::iota(values.rbegin(), values.rend(), 0.0);
  const auto box = box_of(values);
  ASSERT_TRUE(box);
  EXPECT_EQ(box->p5, 5.0);
  EXPECT_EQ(box->q1, 25.0);
  EXPECT_EQ(box->median, 50.0);
  EXPECT_EQ(box->q3, 75.0);
  EXPECT_EQ(box->p95, 95.0);
  EXPECT_EQ(box->max, 100.0);
  EXPECT_FALSE(box_of({}));
}

TEST(BoxFigureDrawing, NamesGroupsAndSeries) {
  const auto small = box_of({0.01, 0.02, 0.03});
  const auto large = box_of({1.0, 2.0, 3.0});
  const std::string svg = box_figure(figure_of({{"ideal", {small, large}}, {"poor", {small, {}}}}));
  for (const char* text : {"ideal", "poor", "localized", "aligned once", "error [m]"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(BoxFigureDrawing, LeavesOutASeriesWithoutBoxes) {
  const std::string svg = box_figure(figure_of({{"ideal", {box_of({0.0, 1.0}), {}}}}));
  EXPECT_THAT(svg, HasSubstr("localized"));
  EXPECT_THAT(svg, Not(HasSubstr("aligned once")));
}

TEST(BoxFigureDrawing, IsEmptyWithoutBoxes) {
  EXPECT_THAT(box_figure(figure_of({{"ideal", {{}, {}}}})), IsEmpty());
  EXPECT_THAT(box_figure(figure_of({})), IsEmpty());
}

}  // namespace
}  // namespace fleetloc

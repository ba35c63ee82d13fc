#include "deploy/evaluation/report/map_layer.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

const View kView{.corner_m = {-1.0, 2.0}, .metres_per_px = 0.05, .width_px = 100, .height_px = 60};

/// Area of the runs [m^2].
double area(const std::vector<std::vector<double>>& runs, const MapLayer& layer) {
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < runs.size(); i += 3) length += runs[i + 1][0] - runs[i][0];
  return length * layer.cell_px * kView.metres_per_px;
}

/// A floor of 5 m x 3 m with points everywhere, and a wall of 3 m height on 0.4 m of it.
std::vector<Eigen::Vector3f> floor_with_wall(float spacing_m) {
  std::vector<Eigen::Vector3f> points;
  const auto columns = static_cast<int>(std::round(5.0F / spacing_m));
  const auto rows = static_cast<int>(std::round(3.0F / spacing_m));
  for (int i = 0; i < columns * rows; ++i) {
    const float x = -1.0F + spacing_m * (static_cast<float>(i % columns) + 0.5F);
    const float y = 2.0F + spacing_m * (static_cast<float>(i / columns) + 0.5F);
    const int heights = x > 1.0F && x < 1.4F ? 30 : 1;
    for (int k = 0; k < heights; ++k) points.emplace_back(x, y, 0.1F * static_cast<float>(k));
  }
  return points;
}

TEST(MapLayer, TellsWallsFromFloor) {
  const MapLayer layer = map_layer(floor_with_wall(0.02F), kView);
  EXPECT_NEAR(area(layer.light, layer), 4.6 * 3.0, 0.6);
  EXPECT_NEAR(area(layer.dark, layer), 0.4 * 3.0, 0.6);
  EXPECT_EQ(layer.cell_px, 2.0);
}

TEST(MapLayer, TakesLargerCellsForASparserMap) {
  const MapLayer layer = map_layer(floor_with_wall(0.1F), kView);
  EXPECT_GT(layer.cell_px, 2.0);
  EXPECT_NEAR(area(layer.light, layer) + area(layer.dark, layer), 5.0 * 3.0, 0.8);
}

TEST(MapLayer, StaysSmallForAMapOfMuchDetail) {
  // A chequerboard of the smallest cells, which has no runs longer than one.
  const View view{.metres_per_px = 0.05, .width_px = 400, .height_px = 500};
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < 250; ++row) {
    for (int column = row % 2; column < 200; column += 2) {
      const Eigen::Vector3f middle(0.1F * (static_cast<float>(column) + 0.5F),
                                   0.1F * (static_cast<float>(row) + 0.5F),
                                   0.0F);
      points.insert(points.end(), 5, middle);
    }
  }
  const MapLayer layer = map_layer(points, view);
  EXPECT_LT(layer.light.size(), 20'000U);
  EXPECT_FALSE(layer.light.empty());
}

TEST(MapLayer, LeavesOutWhatIsBesideTheViewOrNotFinite) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points{{-1.1F, 3.0F, 0.0F},
                                            {4.1F, 3.0F, 0.0F},
                                            {0.0F, 1.9F, 0.0F},
                                            {0.0F, 5.2F, 0.0F},
                                            {0.0F, kNaN, 0.0F}};
  const MapLayer layer = map_layer(points, kView);
  EXPECT_TRUE(layer.light.empty());
  EXPECT_TRUE(layer.dark.empty());
}

}  // namespace
}  // namespace fleetloc

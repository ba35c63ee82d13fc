#include "cloud/locate/place_search.hpp"

#include <algorithm>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "test/unit/locate/street_map.hpp"

namespace fleetloc {
namespace {

const PlaceSearch::Config kConfig{
    .max_places = 4, .min_share = 0.5, .same_m = 2.0, .same_rad = 0.3};
constexpr std::size_t kAll = 1'000'000'000;

SearchRegion all_of(const LaserMap& map) {
  return {.min_map = map.info().min, .max_map = map.info().max};
}

/// What a robot sees that stands at `T_map_seen`, in its own frame.
std::vector<SeenLandmark> seen_at(const Pose& T_map_seen,
                                  const std::vector<Eigen::Vector3d>& p_map) {
  std::vector<SeenLandmark> landmarks;
  for (const Eigen::Vector3d& p : p_map) {
    landmarks.push_back({.p = inverse(T_map_seen) * p});
    landmarks.back().weight = 1 + static_cast<int>(landmarks.size() % 3);
  }
  return landmarks;
}

Pose some_place(std::uint64_t seed) {
  const CounterRandom random(seed, 2);
  return {exp_so3({0.0, 0.0, 2.0 * std::numbers::pi * random.uniform(0)}),
          {8.0 + 24.0 * random.uniform(1), 8.0 + 14.0 * random.uniform(2), 1.2}};
}

/// All headings and positions, each tried: those with at least `min_share` of the best one's score.
std::vector<FoundPlace> by_trying_all(const MapPyramid& map,
                                      const std::vector<SeenLandmark>& landmarks,
                                      const SearchRegion& region,
                                      int headings,
                                      double min_share) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const SeenLandmark& landmark : landmarks) center += landmark.p;
  center /= static_cast<double>(landmarks.size());
  const Eigen::Vector3i first = (region.min_map / map.cell_m()).array().floor().cast<int>();
  const Eigen::Vector3i last = (region.max_map / map.cell_m()).array().floor().cast<int>();
  int full = 0;
  for (const SeenLandmark& landmark : landmarks) full += MapPyramid::kFull * landmark.weight;
  std::vector<FoundPlace> places;
  double best = 0.0;
  for (int heading = 0; heading < headings; ++heading) {
    const double yaw = heading * (2.0 * std::numbers::pi / headings);
    const Eigen::Quaterniond R = exp_so3({0.0, 0.0, yaw});
    std::vector<Eigen::Vector3i> cells;
    for (const SeenLandmark& landmark : landmarks) {
      const Eigen::Vector3d p = (landmark.p - center) / map.cell_m();
      const Eigen::Vector3d turned(std::cos(yaw) * p.x() - std::sin(yaw) * p.y(),
                                   std::sin(yaw) * p.x() + std::cos(yaw) * p.y(),
                                   p.z());
      cells.emplace_back(turned.array().floor().cast<int>());
    }
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) {
          int sum = 0;
          for (std::size_t i = 0; i < cells.size(); ++i) {
            sum += landmarks[i].weight *
                   map.value(x + cells[i].x(), y + cells[i].y(), z + cells[i].z());
          }
          const double score = static_cast<double>(sum) / full;
          best = std::max(best, score);
          if (score < min_share * best) continue;
          const Pose T{R, map.cell_m() * Eigen::Vector3d(x, y, z) - R * center};
          places.push_back({T, score});
        }
      }
    }
  }
  std::erase_if(places, [&](const FoundPlace& place) { return place.score < min_share * best; });
  return places;
}

/// That both are one for a search.
bool is_one(const FoundPlace& place, const FoundPlace& other, const Eigen::Vector3d& center) {
  const Pose& T = place.T_map_seen;
  const Pose& T_other = other.T_map_seen;
  return (T * center - T_other * center).norm() < kConfig.same_m + 1e-9 &&
         log_so3(T.R.conjugate() * T_other.R).norm() < kConfig.same_rad + 1e-9;
}

/// In the region, nothing that has `min_share` of the best one's score is missed.
void expect_all_found(std::uint64_t seed,
                      const MapPyramid& pyramid,
                      const std::vector<SeenLandmark>& landmarks,
                      const SearchRegion& region,
                      double min_share) {
  PlaceSearch::Config config = kConfig;
  config.min_share = min_share;
  config.max_places = 1000;
  PlaceSearch search(pyramid, landmarks, region, config);
  ASSERT_TRUE(search.advance(kAll));
  ASSERT_FALSE(search.places().empty());
  const auto all = by_trying_all(pyramid, landmarks, region, search.headings(), min_share);
  const double best = std::ranges::max(all, {}, &FoundPlace::score).score;
  EXPECT_NEAR(search.places().front().score, best, 1e-12) << "seed " << seed;
  EXPECT_TRUE(std::ranges::is_sorted(search.places(), std::ranges::greater{}, &FoundPlace::score));
  EXPECT_LE(search.max_score_of_rest(), search.places().back().score);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const SeenLandmark& landmark : landmarks) center += landmark.p;
  center /= static_cast<double>(landmarks.size());
  for (const FoundPlace& place : all) {
    const bool is_found = std::ranges::any_of(search.places(), [&](const FoundPlace& found) {
      return is_one(place, found, center) && found.score >= place.score - 1e-12;
    });
    ASSERT_TRUE(is_found) << "seed " << seed << ", share " << min_share << ", score "
                          << place.score;
  }
}

TEST(PlaceSearch, FindsWhatTryingAllFinds) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const StreetMap street(seed, 8);
    const LaserMap map = street.map();
    const MapPyramid pyramid(map, pyramid_config());
    const Pose truth = some_place(seed);
    // Half of what is seen is not in the map.
    auto landmarks = seen_at(truth, street.seen_from(truth.p, 10.0, 12));
    const CounterRandom random(seed, 3);
    for (std::uint64_t i = 0; i < 12; ++i) {
      landmarks.push_back({.p = 4.0 * random.normal3(i), .weight = 2});
    }
    const SearchRegion any_height = all_of(map);
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const SeenLandmark& landmark : landmarks) center += truth * landmark.p;
    const double center_m = center.z() / static_cast<double>(landmarks.size());
    SearchRegion known_height = any_height;
    known_height.min_map.z() = center_m - pyramid.cell_m();
    known_height.max_map.z() = center_m + pyramid.cell_m();
    for (const double min_share : {0.5, 0.9, 1.0}) {
      expect_all_found(seed, pyramid, landmarks, any_height, min_share);
      expect_all_found(seed, pyramid, landmarks, known_height, min_share);
    }
  }
}

TEST(PlaceSearch, FindsWhereTheRobotIsFromAnyPlaceAndHeading) {
  int found = 0;
  std::size_t evaluations = 0;
  constexpr int kTrials = 20;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    const StreetMap street(seed);
    const LaserMap map = street.map();
    const MapPyramid pyramid(map, pyramid_config());
    const Pose truth = some_place(seed);
    const auto p_map = street.seen_from(truth.p, 12.0, 100);
    ASSERT_FALSE(p_map.empty()) << "seed " << seed;
    PlaceSearch search(pyramid, seen_at(truth, p_map), all_of(map), kConfig);
    ASSERT_TRUE(search.advance(kAll));
    evaluations += search.evaluations();
    const FoundPlace& best = search.places().front();
    double worst_m = 0.0;
    for (const Eigen::Vector3d& p : p_map) {
      worst_m = std::max(worst_m, (best.T_map_seen * (inverse(truth) * p) - p).norm());
    }
    EXPECT_GT(best.score, 0.9) << "seed " << seed;
    found += worst_m < 2.0 ? 1 : 0;
  }
  std::printf("%d of %d found, %.1f million evaluations each\n",
              found,
              kTrials,
              1e-6 * static_cast<double>(evaluations) / kTrials);
  EXPECT_GE(found, 18);
}

TEST(PlaceSearch, GoesOnWhereItPaused) {
  const StreetMap street(4);
  const LaserMap map = street.map();
  const MapPyramid pyramid(map, pyramid_config());
  const Pose truth = some_place(4);
  const auto landmarks = seen_at(truth, street.seen_from(truth.p, 12.0, 60));
  PlaceSearch at_once(pyramid, landmarks, all_of(map), kConfig);
  ASSERT_TRUE(at_once.advance(kAll));
  PlaceSearch in_turns(pyramid, landmarks, all_of(map), kConfig);
  EXPECT_EQ(in_turns.max_score_of_rest(), 1.0);
  int turns = 1;
  double rest = 1.0;
  while (!in_turns.advance(20'000)) {
    ++turns;
    EXPECT_LE(in_turns.max_score_of_rest(), rest);
    rest = in_turns.max_score_of_rest();
    if (!in_turns.places().empty()) continue;
    EXPECT_GE(rest, at_once.places().front().score) << "turn " << turns;
  }
  EXPECT_GT(turns, 3);
  EXPECT_EQ(in_turns.evaluations(), at_once.evaluations());
  ASSERT_EQ(in_turns.places().size(), at_once.places().size());
  for (std::size_t i = 0; i < in_turns.places().size(); ++i) {
    EXPECT_EQ(in_turns.places()[i].score, at_once.places()[i].score);
  }
}

TEST(PlaceSearch, LooksOnlyWhereTheRobotMayBe) {
  const StreetMap street(4);
  const LaserMap map = street.map();
  const MapPyramid pyramid(map, pyramid_config());
  const Pose truth = some_place(4);
  const auto p_map = street.seen_from(truth.p, 12.0, 60);
  SearchRegion region = all_of(map);
  region.min_map.x() = truth.p.x() > 20.0 ? 0.0 : 20.0;
  region.max_map.x() = region.min_map.x() + 19.0;
  PlaceSearch search(pyramid, seen_at(truth, p_map), region, kConfig);
  ASSERT_TRUE(search.advance(kAll));
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : p_map) center += p / static_cast<double>(p_map.size());
  for (const FoundPlace& place : search.places()) {
    const double x = (place.T_map_seen * (inverse(truth) * center)).x();
    EXPECT_GE(x, region.min_map.x() - 0.5);
    EXPECT_LE(x, region.max_map.x());
  }
}

TEST(PlaceSearch, BearsALandmarkThatIsFarAwayByMistake) {
  const StreetMap street(4);
  const LaserMap map = street.map();
  const MapPyramid pyramid(map, pyramid_config());
  const Pose truth{exp_so3({0.0, 0.0, 6.1}), some_place(4).p};
  std::vector<Eigen::Vector3d> p_map = street.seen_from(truth.p, 12.0, 30);
  std::vector<SeenLandmark> landmarks = seen_at(truth, p_map);
  landmarks.push_back({.p = {3000.0, 0.0, 1.0}});
  landmarks.push_back({.p = {-3000.0, 0.0, 1.0}});  // so that their mean is in the map
  PlaceSearch search(pyramid, landmarks, all_of(map), kConfig);
  EXPECT_GT(search.headings(), 32'767);
  ASSERT_TRUE(search.advance(kAll));
  for (const Eigen::Vector3d& p : p_map) {
    EXPECT_LT((search.places().front().T_map_seen * (inverse(truth) * p) - p).norm(), 2.0);
  }
}

TEST(PlaceSearch, ChoosesAmongThePositionsOfItsRegionWithEachHeading) {
  const LaserMap map = StreetMap(1).map();
  const MapPyramid pyramid(map, pyramid_config());
  const SearchRegion region{.min_map = pyramid.cell_m() * Eigen::Vector3d(0.5, 10.5, 1.5),
                            .max_map = pyramid.cell_m() * Eigen::Vector3d(19.5, 14.5, 3.5)};
  const std::vector<SeenLandmark> landmarks = {{.p = {5.0, 0.0, 0.0}}, {.p = {-5.0, 0.0, 0.0}}};
  const PlaceSearch search(pyramid, landmarks, region, kConfig);
  EXPECT_EQ(PlaceSearch::candidates(pyramid, landmarks, region),
            20.0 * 5.0 * 3.0 * search.headings());
  // None moves a landmark, 5 m from their mean, by more than a cell.
  EXPECT_NEAR(search.headings(), 2.0 * std::numbers::pi * 5.0 / pyramid.cell_m(), 1.0);
}

TEST(PlaceSearch, FindsNoPlaceThatExplainsAnythingWhereNothingStands) {
  const LaserMap level = StreetMap(1, 0).map();
  const MapPyramid pyramid(level, pyramid_config());
  const std::vector<SeenLandmark> landmarks = {{.p = {5.0, 0.0, 2.0}}, {.p = {-5.0, 0.0, 2.0}}};
  SearchRegion region = all_of(level);
  for (const double height_m : {0.0, 20.0}) {
    region.max_map.z() = region.min_map.z() + height_m;
    PlaceSearch search(pyramid, landmarks, region, kConfig);
    ASSERT_TRUE(search.advance(kAll));
    EXPECT_TRUE(search.places().empty());
  }
}

TEST(PlaceSearch, FindsNothingInARegionThatHasNoPositions) {
  const LaserMap map = StreetMap(1).map();
  const MapPyramid pyramid(map, pyramid_config());
  SearchRegion region = all_of(map);
  region.max_map.x() = region.min_map.x() - 1.0;
  PlaceSearch search(pyramid, {{.p = {5.0, 0.0, 2.0}}}, region, kConfig);
  EXPECT_TRUE(search.advance(kAll));
  EXPECT_TRUE(search.places().empty());
  EXPECT_EQ(search.max_score_of_rest(), 0.0);
}

TEST(PlaceSearch, FindsNothingWithoutLandmarks) {
  const LaserMap map = StreetMap(1).map();
  const MapPyramid pyramid(map, pyramid_config());
  PlaceSearch search(pyramid, {}, all_of(map), kConfig);
  EXPECT_TRUE(search.advance(kAll));
  EXPECT_TRUE(search.places().empty());
  EXPECT_EQ(PlaceSearch::candidates(pyramid, {}, all_of(map)), 0.0);
}

}  // namespace
}  // namespace fleetloc

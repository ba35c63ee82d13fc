#include "cloud/localizer/session_database.hpp"

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using ::testing::ElementsAre;

constexpr int kWindow = 5;

Pose at(double x) {
  return {Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}};
}

SubmapKeyframe keyframe(unsigned id,
                        const std::vector<unsigned>& landmarks = {},
                        unsigned revision = 0) {
  SubmapKeyframe item;
  item.id = KeyframeId{id};
  item.revision = Revision{revision};
  item.T_odom_body = at(id);
  for (const unsigned landmark : landmarks) {
    item.observations.push_back({LandmarkId{landmark}, {0.0, 0.0}, 1.0});
  }
  return item;
}

VirtualEdge edge(unsigned from, unsigned to, double length = 1.0, unsigned revision = 0) {
  return {KeyframeId{from}, KeyframeId{to}, Revision{revision}, at(length), Matrix6d::Identity()};
}

// Keyframes in a row, each with an edge to the one before and a landmark of its own.
SessionDatabase row(unsigned first, unsigned last) {
  SessionDatabase database({.window = kWindow});
  for (unsigned id = first; id <= last; ++id) {
    Submap submap;
    submap.keyframes = {keyframe(id, {id})};
    if (id > first) submap.edges = {edge(id - 1, id)};
    database.add(submap);
  }
  return database;
}

TEST(SessionDatabase, ForgetsWhatIsBeforeAKeyframeForGood) {
  SessionDatabase database = row(1, 4);
  database.forget_before(KeyframeId{3});
  EXPECT_THAT(database.window(), ElementsAre(KeyframeId{3}, KeyframeId{4}));
  EXPECT_EQ(database.landmarks().size(), 2U);
  EXPECT_EQ(database.spanning_edges().size(), 1U);
  Submap again;
  again.keyframes = {keyframe(2, {2}, 7)};
  EXPECT_EQ(database.add(again), (SessionDatabase::Added{.stale = 1}));
}

TEST(SessionDatabase, TellsWhatKeyframesHaveSeen) {
  SessionDatabase database({.window = kWindow});
  Submap submap;
  submap.keyframes = {keyframe(1, {5, 9}), keyframe(2, {4, 9}), keyframe(3, {1})};
  database.add(submap);
  EXPECT_THAT(database.seen_by(std::vector{KeyframeId{1}, KeyframeId{2}}),
              ElementsAre(LandmarkId{4}, LandmarkId{5}, LandmarkId{9}, LandmarkId{9}));
}

TEST(SessionDatabase, KeepsTheNewestRevisionAndCountsNothingTwice) {
  SessionDatabase database = row(1, 3);
  Submap again;
  again.keyframes = {keyframe(2, {2}), keyframe(3, {7, 8}, 1)};
  again.edges = {edge(1, 2), edge(2, 3, 5.0, 1)};
  EXPECT_EQ(database.add(again), (SessionDatabase::Added{.stored = 2, .repeated = 2}));
  EXPECT_EQ(database.keyframes().size(), 3U);
  EXPECT_EQ(database.newest().item.observations.size(), 2U);
  EXPECT_EQ(database.spanning_edges().back()->T_from_to.p.x(), 5.0);
  EXPECT_FALSE(database.landmarks().contains(LandmarkId{3}));  // nobody observes it any more

  Submap older;
  older.keyframes = {keyframe(3, {3}, 0)};
  older.edges = {edge(2, 3, 1.0, 0)};
  EXPECT_EQ(database.add(older), (SessionDatabase::Added{.repeated = 2}));
  EXPECT_EQ(database.newest().item.revision, Revision{1});
}

TEST(SessionDatabase, TakesHalvesOfTheObservationsInAnyOrder) {
  const auto half = [](unsigned offset, const std::vector<unsigned>& landmarks, unsigned revision) {
    SubmapKeyframe item = keyframe(2, landmarks, revision);
    item.subset = {.stride = 2, .offset = offset};
    Submap submap;
    submap.keyframes = {item};
    return submap;
  };
  SessionDatabase database({.window = kWindow});
  database.add(half(1, {3, 5}, 2));
  EXPECT_EQ(database.add(half(0, {2, 4}, 1)), (SessionDatabase::Added{.stored = 1}));
  EXPECT_EQ(database.newest().item.observations.size(), 4U);
  EXPECT_EQ(database.newest().item.revision, Revision{2});
  EXPECT_EQ(database.add(half(1, {3}, 1)), (SessionDatabase::Added{.repeated = 1}));
  database.add(half(0, {4}, 3));
  EXPECT_EQ(database.newest().item.observations.size(), 3U);
}

TEST(SessionDatabase, KeepsSolutionsWhenItemsAreSentAgain) {
  SessionDatabase database = row(1, 2);
  database.store_solution(KeyframeId{2}, at(20.0));
  database.store_solution(LandmarkId{2}, Eigen::Vector3d(1.0, 2.0, 3.0));
  Submap again;
  again.keyframes = {keyframe(2, {2}, 1)};
  again.landmarks = {{LandmarkId{2}, Eigen::Vector3d(9.0, 9.0, 9.0)}};
  database.add(again);
  EXPECT_EQ(database.newest().T_map_body->p, at(20.0).p);
  EXPECT_EQ(*database.landmarks().at(LandmarkId{2}).p_map, Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST(SessionDatabase, KeepsEstimatesRelativeToTheNewestKeyframeThatSawTheLandmark) {
  SessionDatabase database({.window = kWindow});
  Submap submap;
  submap.keyframes = {keyframe(1, {5}), keyframe(2, {5}), keyframe(3)};
  submap.landmarks = {{LandmarkId{5}, Eigen::Vector3d(2.5, 0.0, 0.0)}};
  database.add(submap);
  const auto& estimate = database.landmarks().at(LandmarkId{5}).estimate;
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->keyframe, KeyframeId{2});
  EXPECT_EQ(estimate->p_body, Eigen::Vector3d(0.5, 0.0, 0.0));
}

TEST(SessionDatabase, LeavesUnconnectedPiecesOutUntilAnEdgeJoinsThem) {
  SessionDatabase database({.window = kWindow});
  Submap submap;
  submap.keyframes = {keyframe(1), keyframe(2), keyframe(4), keyframe(5)};
  submap.edges = {edge(1, 2), edge(3, 4), edge(4, 5)};  // 3 itself is lost
  database.add(submap);
  EXPECT_THAT(database.window(), ElementsAre(KeyframeId{4}, KeyframeId{5}));

  Submap late;
  late.keyframes = {keyframe(4)};
  late.edges = {edge(2, 4, 2.0)};
  database.add(late);
  EXPECT_THAT(database.window(),
              ElementsAre(KeyframeId{1}, KeyframeId{2}, KeyframeId{4}, KeyframeId{5}));
}

TEST(SessionDatabase, UsesTheShortestOfTheEdgesThatSpanTheSameTime) {
  SessionDatabase database = row(1, 4);
  Submap composed;
  composed.keyframes = {keyframe(4)};
  composed.edges = {edge(1, 4, 3.0), edge(2, 4, 2.0)};
  database.add(composed);
  const auto edges = database.spanning_edges();
  ASSERT_EQ(edges.size(), 3U);
  for (const VirtualEdge* one : edges) {
    EXPECT_EQ(static_cast<std::uint32_t>(one->to), static_cast<std::uint32_t>(one->from) + 1);
  }
}

// Sees `seen` before the gap between 2 and 3, and after it, and other landmarks everywhere.
SessionDatabase blind_between(double sigma_m,
                              const std::vector<unsigned>& seen,
                              double gap_s = 2.0) {
  SessionDatabase database({.window = kWindow, .blind_s = 1.0, .loose_edge_m = 0.1});
  const auto seen_and = [&seen](unsigned other) {
    std::vector<unsigned> all = seen;
    all.push_back(other);
    return all;
  };
  Submap submap;
  submap.keyframes = {keyframe(1, seen_and(100)),
                      keyframe(2, {101}),
                      keyframe(3, {102}),
                      keyframe(4, seen_and(103))};
  for (auto& one : submap.keyframes) {
    const auto id = static_cast<double>(static_cast<std::uint32_t>(one.id));
    one.stamp = Timestamp{from_seconds(0.5 * id + (id > 2.0 ? gap_s - 0.5 : 0.0))};
  }
  submap.edges = {edge(1, 2), edge(2, 3), edge(3, 4)};
  for (auto& one : submap.edges) one.information *= 1e4;
  submap.edges[1].information = Matrix6d::Identity() / (sigma_m * sigma_m);
  database.add(submap);
  return database;
}

TEST(SessionDatabase, BeginsTheWindowAnewWhereTheRobotWasBlind) {
  SessionDatabase blind = blind_between(0.11, {});
  EXPECT_THAT(blind.window(), ElementsAre(KeyframeId{3}, KeyframeId{4}));
  EXPECT_EQ(blind_between(0.09, {}).window().size(), 4U);
  EXPECT_EQ(blind_between(0.11, {}, 0.9).window().size(), 4U);

  // Solved once, it does not bring the others back.
  blind.store_solution(KeyframeId{3}, at(50.0));
  EXPECT_EQ(blind.placed(blind.window(), Pose{}).size(), 2U);
}

TEST(SessionDatabase, LandmarksSeenOnBothSidesHoldTheWindowTogether) {
  EXPECT_EQ(blind_between(0.11, {5, 6, 7}).window().size(), 4U);
  EXPECT_EQ(blind_between(0.11, {5, 6}).window().size(), 2U);
}

// The edge 2 to 7 is loose, since it spans much; what 3 and 5 see in common holds all together.
TEST(SessionDatabase, KeyframesWithinTheSpanOfALooseEdgeHoldTheWindowTogetherAsWell) {
  const auto pieces = [](const std::vector<unsigned>& seen_by_5) {
    SessionDatabase database({.window = 10, .blind_s = 1.0, .loose_edge_m = 0.1});
    Submap submap;
    for (const unsigned id : {1U, 2U, 3U, 5U, 6U, 7U}) {
      submap.keyframes.push_back(keyframe(id, {100 + id}));
      submap.keyframes.back().stamp = Timestamp{from_seconds(id)};
    }
    submap.keyframes[2] = keyframe(3, {10, 11, 12});
    submap.keyframes[2].stamp = Timestamp{from_seconds(3.0)};
    submap.keyframes[3] = keyframe(5, seen_by_5);
    submap.keyframes[3].stamp = Timestamp{from_seconds(5.0)};
    submap.edges = {edge(1, 2), edge(2, 3), edge(5, 6), edge(6, 7)};
    for (auto& one : submap.edges) one.information *= 1e4;
    submap.edges.push_back(edge(2, 7, 5.0));
    database.add(submap);
    return database.window().size();
  };
  EXPECT_EQ(pieces({10, 11, 12}), 6U);
  EXPECT_EQ(pieces({10, 11}), 3U);
}

// An edge over many keyframes that joins two pieces, though each of its ends has a shorter one.
TEST(SessionDatabase, ALongEdgeBridgesAGapBetweenOthers) {
  SessionDatabase database({.window = 10});
  Submap submap;
  for (const std::uint32_t id : {1U, 2U, 3U, 5U, 6U, 7U}) submap.keyframes.push_back(keyframe(id));
  submap.edges = {edge(1, 2), edge(2, 3), edge(5, 6), edge(6, 7), edge(2, 7, 5.0)};
  database.add(submap);
  EXPECT_EQ(database.window().size(), 6U);
  EXPECT_EQ(database.spanning_edges().size(), 5U);
}

TEST(SessionDatabase, MergesHalvesOfAKeyframesObservations) {
  SessionDatabase database({.window = kWindow});
  const auto half =
      [](std::uint32_t offset, std::vector<std::uint32_t> landmarks, std::uint32_t revision) {
        Submap submap;
        submap.keyframes = {keyframe(4, landmarks, revision)};
        submap.keyframes[0].subset = {.stride = 2, .offset = offset};
        return submap;
      };
  const auto observed = [&] {
    std::vector<std::uint32_t> ids;
    for (const auto& one : database.newest().item.observations) {
      ids.push_back(static_cast<std::uint32_t>(one.landmark));
    }
    return ids;
  };
  database.add(half(0, {2, 6, 8}, 1));
  database.add(half(1, {3, 5}, 2));
  EXPECT_EQ(observed(), (std::vector<std::uint32_t>{2, 3, 5, 6, 8}));
  database.add(half(0, {2, 10}, 3));  // the robot has rejected 6 and 8 meanwhile
  EXPECT_EQ(observed(), (std::vector<std::uint32_t>{2, 3, 5, 10}));
}

TEST(SessionDatabase, PlacesNewKeyframesAlongEdgesFromTheLastSolvedOne) {
  SessionDatabase database = row(1, 4);
  const std::vector<KeyframeId> window = database.window();
  EXPECT_EQ(database.placed(window, at(100.0)).at(KeyframeId{3}).p, at(103.0).p);

  database.store_solution(KeyframeId{2}, at(50.0));
  const auto poses = database.placed(window, at(100.0));
  EXPECT_EQ(poses.at(KeyframeId{1}).p, at(49.0).p);
  EXPECT_EQ(poses.at(KeyframeId{2}).p, at(50.0).p);
  EXPECT_EQ(poses.at(KeyframeId{4}).p, at(52.0).p);
}

TEST(SessionDatabase, ForgetsWhatLiesBehindTheWindow) {
  SessionDatabase database = row(1, 100);
  EXPECT_EQ(database.keyframes().size(), 5U);
  EXPECT_EQ(database.landmarks().size(), 5U);
  const std::size_t bytes = row(1, 1000).memory_bytes();
  EXPECT_LE(bytes, database.memory_bytes() + 100);

  Submap old;
  old.keyframes = {keyframe(7, {7})};
  old.edges = {edge(6, 7), edge(94, 95)};
  EXPECT_EQ(database.add(old), (SessionDatabase::Added{.stale = 3}));
  EXPECT_FALSE(database.landmarks().contains(LandmarkId{7}));
}

TEST(SessionDatabase, StaysBoundedWhenOneKeyframeIsRevisedForEver) {
  SessionDatabase database = row(1, 5);
  for (unsigned revision = 1; revision < 200; ++revision) {
    Submap submap;
    submap.keyframes = {keyframe(5, {100 + revision}, revision)};
    submap.edges = {edge(4, 5, 1.0, revision), edge(1000, 1000 + revision)};
    database.add(submap);
  }
  EXPECT_EQ(database.landmarks().size(), 5U);
  EXPECT_LE(database.memory_bytes(), row(1, 5).memory_bytes() + 100);
}

}  // namespace
}  // namespace fleetloc

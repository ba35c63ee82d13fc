#include "deploy/sim/world/scene.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "deploy/sim/world/season_scene.hpp"
#include "test/unit/world/campus.hpp"

namespace fleetloc {
namespace {

using testing::HasSubstr;

class Campus : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    world_ = new WorldConfig(campus());
    scene_ = new Scene(build_scene(world_->scene, eight(), 1));
  }
  static void TearDownTestSuite() {
    delete scene_;
    delete world_;
  }
  static std::vector<const SceneObject*> static_objects() {
    std::vector<const SceneObject*> objects;
    for (const auto* list : {&scene_->buildings, &scene_->furniture, &scene_->leaves}) {
      for (const SceneObject& object : *list) objects.push_back(&object);
    }
    for (const auto* slots : {&scene_->cars, &scene_->structures}) {
      for (const Slot& slot : *slots) {
        for (const SceneObject& object : slot.variants) objects.push_back(&object);
      }
    }
    return objects;
  }
  static WorldConfig* world_;
  static Scene* scene_;
};
WorldConfig* Campus::world_ = nullptr;
Scene* Campus::scene_ = nullptr;

TEST_F(Campus, NothingStandsNearARouteThatCrossesItself) {
  const float clearance = world_->scene.clearance_m;
  float nearest = 100.0F;
  for (const SceneObject* object : static_objects()) {
    for (const auto& vertex : object->mesh.vertices) {
      nearest = std::min(nearest, scene_->route->distance(vertex.head<2>(), 20.0F));
    }
  }
  EXPECT_GE(nearest, clearance);
  EXPECT_LE(nearest, clearance + 1.0F);  // but objects do come near
}

TEST_F(Campus, TheGroundPassesBelowTheRoute) {
  Mesh mesh;
  std::vector<Surface> surfaces;
  append(scene_->ground, mesh, surfaces);
  const RayCaster ground(mesh);
  for (const Eigen::Vector3f& p : scene_->route->points()) {
    const auto hit = ground.first_hit({p, {0.0F, 0.0F, -1.0F}}, 10.0F);
    ASSERT_TRUE(hit) << p.transpose();
    EXPECT_NEAR(hit->distance_m, world_->scene.body_height_m, 0.1F) << p.transpose();
  }
}

TEST_F(Campus, HasBuildingsTreesAndPlacesOnBothSides) {
  EXPECT_GE(scene_->buildings.size(), 8U);
  EXPECT_GE(scene_->leaves.size(), 20U);
  EXPECT_GE(scene_->cars.size(), 10U);
  EXPECT_GE(scene_->structures.size(), 15U);
}

TEST_F(Campus, IsTheSameForOneSeedAndAnotherForAnother) {
  const Scene again = build_scene(world_->scene, eight(), 1);
  const Scene other = build_scene(world_->scene, eight(), 2);
  ASSERT_EQ(again.buildings.size(), scene_->buildings.size());
  EXPECT_EQ(again.buildings[3].mesh.vertices, scene_->buildings[3].mesh.vertices);
  EXPECT_EQ(again.ground.mesh.vertices, scene_->ground.mesh.vertices);
  EXPECT_NE(other.buildings[3].mesh.vertices, scene_->buildings[3].mesh.vertices);
}

TEST_F(Campus, BuildingsAndWoodStandInEverySession) {
  const SeasonScene winter = season_of(*world_, *scene_, "winter");
  for (const auto* list : {&scene_->buildings, &scene_->furniture}) {
    for (const SceneObject& object : *list) {
      const Eigen::Vector3f& vertex = object.mesh.vertices[object.mesh.vertices.size() / 2];
      EXPECT_TRUE(winter.fixed().has_surface_within(vertex, 1e-3F));
    }
  }
}

TEST_F(Campus, ASessionTakesLeavesAndMovesCarsAndStructures) {
  const SeasonScene summer = season_of(*world_, *scene_, "summer");
  const SeasonScene winter = season_of(*world_, *scene_, "winter");
  const auto missing = [](const std::vector<const SceneObject*>& objects, const SeasonScene& from) {
    int count = 0;
    for (const SceneObject* object : objects) {
      const Eigen::Vector3f& vertex = object->mesh.vertices.front();
      count += from.fixed().has_surface_within(vertex, 1e-3F) ? 0 : 1;
    }
    return count;
  };
  std::vector<const SceneObject*> leaves;
  for (const SceneObject& object : scene_->leaves) leaves.push_back(&object);
  EXPECT_EQ(missing(leaves, summer), 0);
  EXPECT_GT(missing(leaves, winter), static_cast<int>(0.8 * static_cast<double>(leaves.size())));
  std::vector<const SceneObject*> structures;
  for (const Slot& slot : scene_->structures) structures.push_back(slot.variants.data());
  EXPECT_NE(missing(structures, summer), missing(structures, winter));
}

TEST_F(Campus, SnowLiesDeepBesideALaneThatIsCleared) {
  constexpr float kLane_m = 1.0F;
  SceneObject snow = scene_->ground;
  cover_with_snow(snow, *scene_->route, 0.4F, 7);
  const auto& before = scene_->ground.mesh.vertices;
  const auto& after = snow.mesh.vertices;
  ASSERT_EQ(after.size(), before.size());
  int deep = 0;
  int beside = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const float depth = after[i].z() - before[i].z();
    const float distance = scene_->route->distance(before[i].head<2>(), 20.0F);
    EXPECT_EQ(after[i].head<2>(), before[i].head<2>());
    if (distance < kLane_m) {
      EXPECT_EQ(depth, 0.0F);
    } else {
      EXPECT_GE(depth, 0.0F);
      EXPECT_LT(depth, 0.8F);
    }
    if (distance > 3.0F) {
      ++beside;
      deep += depth > 0.3F ? 1 : 0;
    }
  }
  EXPECT_GT(deep, beside * 8 / 10);
  const auto surveyed = season_of(*world_, *scene_, "summer");
  EXPECT_TRUE(surveyed.fixed().has_surface_within(before[before.size() / 2], 1e-3F));
}

TEST_F(Campus, PeopleMoveWithTime) {
  const SeasonScene winter = season_of(*world_, *scene_, "winter");
  const SceneView now = winter.at(10.0);
  const SceneView same = winter.at(10.0);
  const SceneView later = winter.at(12.0);
  int moved = 0;
  for (int i = 0; i < 400; ++i) {
    const Pose T = T_map_body_on_eight(i / 400.0);
    const Ray ray{.origin_map = T.p.cast<float>(),
                  .direction_map = (T.R * Eigen::Vector3d::UnitZ()).cast<float>()};
    const auto first = now.caster.first_hit(ray, 100.0F);
    const auto again = same.caster.first_hit(ray, 100.0F);
    const auto second = later.caster.first_hit(ray, 100.0F);
    EXPECT_EQ(first.has_value(), again.has_value());
    if (first && again) {
      EXPECT_EQ(first->distance_m, again->distance_m);
    }
    moved += first && second && first->distance_m != second->distance_m ? 1 : 0;
  }
  EXPECT_GT(moved, 5);
}

TEST(SceneConfig, RefusesWhatItDoesNotKnow) {
  const std::string file = std::string(FLEETLOC_SOURCE_DIR) + "/deploy/worlds/campus.yaml";
  const std::string text = ConfigReader::from_file(file).text();
  const auto message = [](const std::string& yaml) -> std::string {
    try {
      read_world_config(ConfigReader::from_string(yaml, "world.yaml"));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string copy = text;
    copy.replace(copy.find(from), from.size(), to);
    return message(copy);
  };
  EXPECT_EQ(message(text), "");
  EXPECT_THAT(changed("clearance_m", "clearance"), HasSubstr("scene.clearance_m: missing"));
  EXPECT_THAT(changed("survey: summer", "survey: monsoon"), HasSubstr("monsoon"));
  EXPECT_THAT(changed("survey: summer", "survey: summer\nrain: 1"), HasSubstr("rain: unknown key"));
  EXPECT_THAT(changed("snow: 0", "snow: 7"), HasSubstr("snow: must be in 0..1"));
}

TEST(RouteField, RefusesARouteThatIsNone) {
  EXPECT_THROW(RouteField(std::vector<Eigen::Vector3d>{}), std::invalid_argument);
  EXPECT_THROW(RouteField(std::vector<Eigen::Vector3d>(5, {1, 2, 3})), std::invalid_argument);
}

}  // namespace
}  // namespace fleetloc

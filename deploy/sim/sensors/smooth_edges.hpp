#pragma once

#include "deploy/sim/sensors/light.hpp"
#include "deploy/sim/sensors/shaded_image.hpp"
#include "deploy/sim/sensors/view_rays.hpp"
#include "deploy/sim/world/season_scene.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// What an image was seen by.
struct Viewpoint {
  const ViewRays& rays;
  const SceneView& scene;
  const Light& light;
  Pose T_map_cam;
};

/// One more ray between neighbours that show visibly different objects, for both pixels. After
/// add_sun. Where that ray meets what one of the two shows, nothing else is looked for; an object
/// thinner than half a pixel may be lost there.
void smooth_edges(ShadedImage& image, const Viewpoint& from, int threads);

}  // namespace fleetloc

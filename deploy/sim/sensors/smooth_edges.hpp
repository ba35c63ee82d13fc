#pragma once

#include "deploy/sim/sensors/light.hpp"
#include "deploy/sim/sensors/seen_image.hpp"
#include "deploy/sim/sensors/view_rays.hpp"
#include "deploy/sim/world/session_scene.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// What an image was seen by.
struct Viewpoint {
  const ViewRays& rays;
  const SceneView& scene;
  const Light& light;
  Pose T_map_cam;
};

/// One more ray between neighbours that show visibly different things, for both pixels. After
/// add_sun. Where that ray meets what one of the two shows, nothing else is looked for; a thing
/// thinner than half a pixel may be lost there.
void smooth_edges(SeenImage& image, const Viewpoint& from, int threads);

}  // namespace fleetloc

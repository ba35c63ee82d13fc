#pragma once

#include "deploy/sim/sensors/light.hpp"
#include "deploy/sim/sensors/shaded_image.hpp"
#include "deploy/sim/sensors/view_rays.hpp"
#include "deploy/sim/world/season_scene.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// What an image was rendered with.
struct Viewpoint {
  const ViewRays& rays;
  const SceneView& scene;
  const Light& light;
  Pose T_map_cam;
};

/// Antialiasing, after add_sun(): one more ray between neighbouring pixels whose objects and
/// radiance differ. Where that ray hits the triangle of one of the two, no other is tested; an
/// object thinner than half a pixel may be lost there.
void smooth_edges(ShadedImage& image, const Viewpoint& from, int threads);

}  // namespace fleetloc

#include "shared/world/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

#include <embree3/rtcore.h>

#include "shared/world/packet_triangle.hpp"
#include "shared/world/point_triangle.hpp"

namespace fleetloc {
namespace {

constexpr float kSurfaceSkin_m = 0.002F;
constexpr std::uint32_t kMoving = 0x80000000U;  // marks the numbers of triangles that move

/// One for the program. A single thread builds: in parallel the trees would differ from run to run,
/// and with them which of two triangles is hit on their common edge.
RTCDevice device() {
  static const std::unique_ptr<RTCDeviceTy, void (*)(RTCDevice)> only(
      rtcNewDevice("threads=1,set_affinity=0"), rtcReleaseDevice);
  if (!only) throw std::runtime_error("Embree: no device");
  return only.get();
}

void expect_well_formed(const Mesh& mesh) {
  if (mesh.surfaces.size() != mesh.triangles.size()) {
    throw std::invalid_argument("mesh: one surface per triangle is needed");
  }
  for (const auto& triangle : mesh.triangles) {
    if (*std::max_element(triangle.begin(), triangle.end()) >= mesh.vertices.size()) {
      throw std::invalid_argument("mesh: a triangle names a vertex that is not there");
    }
  }
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    if (!vertex.allFinite()) throw std::invalid_argument("mesh: a vertex is not finite");
  }
}

RTCIntersectContext coherent_context() {
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

RTCRay single(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.mask = ~0U;
  return ray;
}

/// As Embree wants it: -1 for lanes in which there is a ray.
struct alignas(64) ValidLanes : RayPacket::Lanes<int> {};

ValidLanes valid_lanes(const RayPacket& rays) {
  ValidLanes valid{};
  for (std::size_t i = 0; i < valid.size(); ++i) valid[i] = rays.most_m[i] >= 0.0F ? -1 : 0;
  return valid;
}

bool is_empty(const ValidLanes& valid) {
  return std::all_of(valid.begin(), valid.end(), [](int lane) { return lane == 0; });
}

template <typename T>
void copy(const RayPacket::Lanes<T>& from, T* to) {
  std::memcpy(to, from.data(), sizeof(from));
}

RTCRay16 packet(const RayPacket& rays) {
  RTCRay16 packet{};
  copy(rays.origin_x, packet.org_x);
  copy(rays.origin_y, packet.org_y);
  copy(rays.origin_z, packet.org_z);
  copy(rays.direction_x, packet.dir_x);
  copy(rays.direction_y, packet.dir_y);
  copy(rays.direction_z, packet.dir_z);
  copy(rays.least_m, packet.tnear);
  copy(rays.most_m, packet.tfar);
  std::fill_n(packet.time, RayPacket::kSize, 0.0F);
  std::fill_n(packet.mask, RayPacket::kSize, ~0U);
  std::fill_n(packet.id, RayPacket::kSize, 0U);
  std::fill_n(packet.flags, RayPacket::kSize, 0U);
  return packet;
}

}  // namespace

/// Embree's tree over one mesh, and what Embree does not keep.
struct RayCaster::Triangles {
  explicit Triangles(const Mesh& mesh);
  ~Triangles() { rtcReleaseScene(scene); }
  Triangles(const Triangles&) = delete;
  Triangles& operator=(const Triangles&) = delete;

  [[nodiscard]] std::array<Eigen::Vector3f, 3> corners(std::uint32_t triangle) const;

  RTCScene scene = nullptr;
  std::vector<std::uint32_t> surfaces;
  const float* vertices = nullptr;           // in Embree's memory
  const std::uint32_t* triangles = nullptr;  // the same
};

RayCaster::Triangles::Triangles(const Mesh& mesh) : surfaces(mesh.surfaces) {
  expect_well_formed(mesh);
  scene = rtcNewScene(device());
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!mesh.triangles.empty()) {
    auto* to_vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry,
                                                                    RTC_BUFFER_TYPE_VERTEX,
                                                                    0,
                                                                    RTC_FORMAT_FLOAT3,
                                                                    3 * sizeof(float),
                                                                    mesh.vertices.size()));
    auto* to_triangles =
        static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry,
                                                            RTC_BUFFER_TYPE_INDEX,
                                                            0,
                                                            RTC_FORMAT_UINT3,
                                                            3 * sizeof(unsigned),
                                                            mesh.triangles.size()));
    if (to_vertices == nullptr || to_triangles == nullptr) {
      rtcReleaseGeometry(geometry);
      rtcReleaseScene(scene);
      throw std::runtime_error("Embree: no memory for the mesh");
    }
    for (const Eigen::Vector3f& v : mesh.vertices) {
      to_vertices = std::copy_n(v.data(), 3, to_vertices);
    }
    for (const auto& t : mesh.triangles) to_triangles = std::copy_n(t.data(), 3, to_triangles);
    vertices = to_vertices - 3 * mesh.vertices.size();
    triangles = to_triangles - 3 * mesh.triangles.size();
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  if (const RTCError error = rtcGetDeviceError(device()); error != RTC_ERROR_NONE) {
    rtcReleaseScene(scene);
    throw std::runtime_error("Embree: error " + std::to_string(error) + " while building");
  }
}

std::array<Eigen::Vector3f, 3> RayCaster::Triangles::corners(std::uint32_t triangle) const {
  std::array<Eigen::Vector3f, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t vertex = triangles[3 * std::size_t{triangle} + i];
    corners.at(i) = Eigen::Map<const Eigen::Vector3f>(vertices + 3 * vertex);
  }
  return corners;
}

RayCaster::RayCaster(const Mesh& fixed) : fixed_(std::make_shared<const Triangles>(fixed)) {}

RayCaster RayCaster::with(const Mesh& moving) const {
  RayCaster result;
  result.fixed_ = fixed_;
  result.moving_ = std::make_shared<const Triangles>(moving);
  return result;
}

std::optional<Hit> RayCaster::first_hit(const Ray& ray, float most_m) const {
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  std::optional<Hit> first;
  for (const Triangles* triangles : {fixed_.get(), moving_.get()}) {
    if (triangles == nullptr) continue;
    RTCRayHit hit{};
    hit.ray = single(ray.origin_map, ray.direction_map);
    hit.ray.tfar = first ? first->distance_m : most_m;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(triangles->scene, &context, &hit);
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    const Eigen::Vector3f normal =
        Eigen::Vector3f(hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z).normalized();
    first = Hit{.distance_m = hit.ray.tfar,
                .normal_map = normal.dot(ray.direction_map) > 0.0F ? -normal : normal,
                .surface = triangles->surfaces[hit.hit.primID]};
  }
  return first;
}

HitPacket RayCaster::first_hits(const RayPacket& rays) const {
  HitPacket hits{};
  hits.distance_m.fill(HitPacket::kNone);
  trace(rays, hits);
  return hits;
}

HitPacket RayCaster::first_hits_on(std::span<const std::uint32_t> triangles,
                                   const RayPacket& rays) const {
  HitPacket hits{};
  hits.distance_m.fill(HitPacket::kNone);
  for (const std::uint32_t triangle : triangles) {
    const Triangles& mesh = (triangle & kMoving) != 0U ? *moving_ : *fixed_;
    const std::uint32_t index = triangle & ~kMoving;
    meet_triangle(
        mesh.corners(index), {.triangle = triangle, .surface = mesh.surfaces[index]}, rays, hits);
  }
  RayPacket others = rays;
  for (std::size_t i = 0; i < hits.distance_m.size(); ++i) {
    if (hits.distance_m[i] != HitPacket::kNone) others.most_m[i] = -1.0F;
  }
  trace(others, hits);
  return hits;
}

void RayCaster::trace(const RayPacket& rays, HitPacket& hits) const {
  const ValidLanes valid = valid_lanes(rays);
  if (is_empty(valid)) return;
  RTCIntersectContext context = coherent_context();
  RTCRayHit16 query{};
  query.ray = packet(rays);
  for (const Triangles* triangles : {fixed_.get(), moving_.get()}) {
    if (triangles == nullptr) continue;
    const std::uint32_t mark = triangles == moving_.get() ? kMoving : 0U;
    std::fill_n(query.hit.geomID, RayPacket::kSize, RTC_INVALID_GEOMETRY_ID);
    rtcIntersect16(valid.data(), triangles->scene, &context, &query);
    for (std::size_t i = 0; i < valid.size(); ++i) {
      if (valid[i] == 0 || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      const Eigen::Vector3f n(query.hit.Ng_x[i], query.hit.Ng_y[i], query.hit.Ng_z[i]);
      const float along =
          n.x() * rays.direction_x[i] + n.y() * rays.direction_y[i] + n.z() * rays.direction_z[i];
      const float scale = (along > 0.0F ? -1.0F : 1.0F) / n.norm();
      hits.distance_m[i] = query.ray.tfar[i];
      hits.normal_x[i] = scale * n.x();
      hits.normal_y[i] = scale * n.y();
      hits.normal_z[i] = scale * n.z();
      hits.surface[i] = triangles->surfaces[query.hit.primID[i]];
      hits.triangle[i] = query.hit.primID[i] | mark;
    }
  }
}

bool RayCaster::occluded(const Eigen::Vector3f& from_map, const Eigen::Vector3f& to_map) const {
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  const Eigen::Vector3f way = to_map - from_map;
  const float distance = way.norm();
  if (distance <= 2.0F * kSurfaceSkin_m) return false;
  for (const Triangles* triangles : {fixed_.get(), moving_.get()}) {
    if (triangles == nullptr) continue;
    RTCRay ray = single(from_map, way / distance);
    ray.tnear = kSurfaceSkin_m;
    ray.tfar = distance - kSurfaceSkin_m;
    rtcOccluded1(triangles->scene, &context, &ray);
    if (ray.tfar < 0.0F) return true;
  }
  return false;
}

std::uint32_t RayCaster::occluded(const RayPacket& rays) const {
  RTCIntersectContext context = coherent_context();
  const auto valid = valid_lanes(rays);
  if (is_empty(valid)) return 0;
  std::uint32_t bits = 0;
  for (const Triangles* triangles : {fixed_.get(), moving_.get()}) {
    if (triangles == nullptr) continue;
    RTCRay16 query = packet(rays);
    rtcOccluded16(valid.data(), triangles->scene, &context, &query);
    for (std::size_t i = 0; i < valid.size(); ++i) {
      if (valid[i] != 0 && query.tfar[i] < 0.0F) bits |= 1U << i;
    }
  }
  return bits;
}

bool RayCaster::has_surface_within(const Eigen::Vector3f& p_map, float radius_m) const {
  struct Query {
    const Triangles* triangles;
    Eigen::Vector3f p;
    float radius;
    bool found = false;
  };
  const auto check = [](RTCPointQueryFunctionArguments* arguments) {
    auto& query = *static_cast<Query*>(arguments->userPtr);
    if (query.found) return false;
    const auto corners = query.triangles->corners(arguments->primID);
    const Eigen::Vector3f nearest = nearest_point_of_triangle(query.p, corners);
    query.found = (nearest - query.p).norm() <= query.radius;
    if (!query.found) return false;
    arguments->query->radius = 0.0F;  // ends the search
    return true;
  };
  for (const Triangles* triangles : {fixed_.get(), moving_.get()}) {
    if (triangles == nullptr || triangles->surfaces.empty()) continue;
    Query query{.triangles = triangles, .p = p_map, .radius = radius_m};
    RTCPointQuery sphere{p_map.x(), p_map.y(), p_map.z(), 0.0F, radius_m};
    RTCPointQueryContext context{};
    rtcInitPointQueryContext(&context);
    rtcPointQuery(triangles->scene, &sphere, &context, check, &query);
    if (query.found) return true;
  }
  return false;
}

}  // namespace fleetloc

#include "deploy/sim/world/triangle_tree.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

#include <embree3/rtcore.h>

#include "deploy/sim/world/float4.hpp"
#include "deploy/sim/world/point_triangle.hpp"

namespace fleetloc {
namespace {

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

RTCIntersectContext context_for(RTCIntersectContextFlags flags) {
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

RTCRay single(const Ray& ray, float min_m, float max_m) {
  RTCRay result{};
  result.org_x = ray.origin_map.x();
  result.org_y = ray.origin_map.y();
  result.org_z = ray.origin_map.z();
  result.dir_x = ray.direction_map.x();
  result.dir_y = ray.direction_map.y();
  result.dir_z = ray.direction_map.z();
  result.tnear = min_m;
  result.tfar = max_m;
  result.mask = ~0U;
  return result;
}

/// As Embree wants it: -1 for lanes in which there is a ray.
struct alignas(64) ValidLanes : RayPacket::Lanes<int> {};

ValidLanes valid_lanes(const RayPacket& rays) {
  ValidLanes valid{};
  for (std::size_t i = 0; i < valid.size(); ++i) valid[i] = rays.max_m[i] >= 0.0F ? -1 : 0;
  return valid;
}

template <typename T>
void copy(const RayPacket::Lanes<T>& from, T* to) {
  std::memcpy(to, from.data(), sizeof(from));
}

/// Sets all that Embree reads.
void fill_packet(const RayPacket& rays, RTCRay16& packet) {
  copy(rays.origin_x, packet.org_x);
  copy(rays.origin_y, packet.org_y);
  copy(rays.origin_z, packet.org_z);
  copy(rays.direction_x, packet.dir_x);
  copy(rays.direction_y, packet.dir_y);
  copy(rays.direction_z, packet.dir_z);
  copy(rays.min_m, packet.tnear);
  copy(rays.max_m, packet.tfar);
  std::fill_n(packet.time, RayPacket::kSize, 0.0F);
  std::fill_n(packet.mask, RayPacket::kSize, ~0U);
  std::fill_n(packet.id, RayPacket::kSize, 0U);
  std::fill_n(packet.flags, RayPacket::kSize, 0U);
}

/// Unit normals of four lanes, towards the rays' origins.
void store_normals(const RTCRayHit16& query, std::size_t i, const Int4& is_hit, HitPacket& hits) {
  const Float4 x = load4(&query.hit.Ng_x[i]);
  const Float4 y = load4(&query.hit.Ng_y[i]);
  const Float4 z = load4(&query.hit.Ng_z[i]);
  const Float4 along = x * load4(&query.ray.dir_x[i]) + y * load4(&query.ray.dir_y[i]) +
                       z * load4(&query.ray.dir_z[i]);
  const Float4 length = square_root(x * x + y * y + z * z);
  const Float4 scale = (along > 0.0F ? all4(-1.0F) : all4(1.0F)) / length;
  const auto keep = [&](const Float4& value, float* to) { store4(is_hit ? value : load4(to), to); };
  keep(scale * x, &hits.normal_x[i]);
  keep(scale * y, &hits.normal_y[i]);
  keep(scale * z, &hits.normal_z[i]);
}

}  // namespace

TriangleTree::TriangleTree(const Mesh& mesh, std::uint32_t mark)
    : mark_(mark), surfaces_(mesh.surfaces) {
  expect_well_formed(mesh);
  scene_ = rtcNewScene(device());
  try {
    fill(mesh);
  } catch (...) {
    rtcReleaseScene(scene_);
    throw;
  }
}

TriangleTree::~TriangleTree() {
  rtcReleaseScene(scene_);
}

void TriangleTree::fill(const Mesh& mesh) {
  const std::unique_ptr<RTCGeometryTy, void (*)(RTCGeometry)> geometry(
      rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE), rtcReleaseGeometry);
  if (!mesh.triangles.empty()) {
    auto* to_vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(),
                                                                    RTC_BUFFER_TYPE_VERTEX,
                                                                    0,
                                                                    RTC_FORMAT_FLOAT3,
                                                                    3 * sizeof(float),
                                                                    mesh.vertices.size()));
    auto* to_triangles =
        static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry.get(),
                                                            RTC_BUFFER_TYPE_INDEX,
                                                            0,
                                                            RTC_FORMAT_UINT3,
                                                            3 * sizeof(unsigned),
                                                            mesh.triangles.size()));
    if (to_vertices == nullptr || to_triangles == nullptr) {
      throw std::runtime_error("Embree: no memory for the mesh");
    }
    vertices_ = to_vertices;
    triangles_ = to_triangles;
    for (const Eigen::Vector3f& v : mesh.vertices) {
      to_vertices = std::copy_n(v.data(), 3, to_vertices);
    }
    for (const auto& t : mesh.triangles) to_triangles = std::copy_n(t.data(), 3, to_triangles);
  }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene_, geometry.get());
  rtcCommitScene(scene_);
  if (const RTCError error = rtcGetDeviceError(device()); error != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree: error " + std::to_string(error) + " while building");
  }
}

std::array<Eigen::Vector3f, 3> TriangleTree::corners(std::uint32_t triangle) const {
  std::array<Eigen::Vector3f, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t vertex = triangles_[3 * std::size_t{triangle} + i];
    corners.at(i) = Eigen::Map<const Eigen::Vector3f>(vertices_ + 3 * vertex);
  }
  return corners;
}

std::optional<Hit> TriangleTree::first_hit(const Ray& ray, float max_m) const {
  RTCIntersectContext context = context_for(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  RTCRayHit hit{};
  hit.ray = single(ray, 0.0F, max_m);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_, &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Eigen::Vector3f normal =
      Eigen::Vector3f(hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z).normalized();
  return Hit{.distance_m = hit.ray.tfar,
             .normal_map = normal.dot(ray.direction_map) > 0.0F ? -normal : normal,
             .surface = surfaces_[hit.hit.primID]};
}

void TriangleTree::first_hits(const RayPacket& rays, HitPacket& hits) const {
  const ValidLanes valid = valid_lanes(rays);
  RTCIntersectContext context = context_for(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  RTCRayHit16 query{};
  fill_packet(rays, query.ray);
  for (std::size_t i = 0; i < RayPacket::kSize; i += 4) {
    store4(min4(load4(&rays.max_m[i]), load4(&hits.distance_m[i])), &query.ray.tfar[i]);
  }
  std::fill_n(query.hit.geomID, RayPacket::kSize, RTC_INVALID_GEOMETRY_ID);
  rtcIntersect16(valid.data(), scene_, &context, &query);
  for (std::size_t i = 0; i < RayPacket::kSize; i += 4) {
    const Int4 is_hit = load4(&query.hit.geomID[i]) != RTC_INVALID_GEOMETRY_ID;
    if (!any(is_hit)) continue;
    store_normals(query, i, is_hit, hits);
    store4(is_hit ? load4(&query.ray.tfar[i]) : load4(&hits.distance_m[i]), &hits.distance_m[i]);
    for (std::size_t lane = 0; lane < 4; ++lane) {
      if (is_hit[lane] == 0) continue;
      const std::uint32_t triangle = query.hit.primID[i + lane];
      hits.surface[i + lane] = surfaces_[triangle];
      hits.triangle[i + lane] = triangle | mark_;
    }
  }
}

bool TriangleTree::occluded(const Ray& ray, float min_m, float max_m) const {
  RTCIntersectContext context = context_for(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  RTCRay query = single(ray, min_m, max_m);
  rtcOccluded1(scene_, &context, &query);
  return query.tfar < 0.0F;
}

std::uint32_t TriangleTree::occluded(const RayPacket& rays) const {
  const ValidLanes valid = valid_lanes(rays);
  RTCIntersectContext context = context_for(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  RTCRay16 query{};
  fill_packet(rays, query);
  rtcOccluded16(valid.data(), scene_, &context, &query);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < valid.size(); ++i) {
    if (valid[i] != 0 && query.tfar[i] < 0.0F) bits |= 1U << i;
  }
  return bits;
}

bool TriangleTree::has_surface_within(const Eigen::Vector3f& p_map, float radius_m) const {
  struct Query {
    const TriangleTree* tree;
    Eigen::Vector3f p;
    float radius;
    bool found = false;
  };
  const auto check = [](RTCPointQueryFunctionArguments* arguments) {
    auto& query = *static_cast<Query*>(arguments->userPtr);
    if (query.found) return false;
    const auto corners = query.tree->corners(arguments->primID);
    const Eigen::Vector3f nearest = nearest_point_of_triangle(query.p, corners);
    query.found = (nearest - query.p).norm() <= query.radius;
    if (!query.found) return false;
    arguments->query->radius = 0.0F;  // ends the search
    return true;
  };
  if (surfaces_.empty()) return false;
  Query query{.tree = this, .p = p_map, .radius = radius_m};
  RTCPointQuery sphere{p_map.x(), p_map.y(), p_map.z(), 0.0F, radius_m};
  RTCPointQueryContext context{};
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_, &sphere, &context, check, &query);
  return query.found;
}

}  // namespace fleetloc

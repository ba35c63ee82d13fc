#include "deploy/sim/sensors/smooth_edges.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "deploy/sim/sensors/camera_packet.hpp"
#include "shared/concurrency/parallel_rows.hpp"

namespace fleetloc {
namespace {

constexpr float kMinContrast = 0.04F;  // that an edge must have to be smoothed
constexpr int kRowsAtOnce = 8;

/// An edge between two neighbouring pixels of different objects.
struct Edge {
  std::size_t pixel;
  std::size_t next;         // to the right or below
  std::uint8_t sun_sample;  // of the ray halfway between them
  bool is_found = false;    // that ray hit the triangle of one of them; then:
  float radiance = 0.0F;
};

bool differs(const ShadedImage& image, std::size_t pixel, std::size_t next) {
  if (image.keys[pixel] == image.keys[next]) return false;
  if (image.keys[pixel] == 0U || image.keys[next] == 0U) return false;
  const float contrast = std::abs(image.radiance[pixel] - image.radiance[next]);
  return contrast >= kMinContrast * (image.radiance[pixel] + image.radiance[next]);
}

/// The edges of some rows, not traced yet; neighbours are close to each other in the result.
std::vector<Edge> edges_in(const ShadedImage& image, int first_row) {
  constexpr int kColumnsAtOnce = 10;
  const int end_row = std::min(first_row + kRowsAtOnce, image.height_px);
  std::vector<Edge> edges;
  for (int first_u = 0; first_u < image.width_px; first_u += kColumnsAtOnce) {
    const int end_u = std::min(first_u + kColumnsAtOnce, image.width_px);
    for (int v = first_row; v < end_row; ++v) {
      for (int u = first_u; u < end_u; ++u) {
        const std::size_t pixel = image.index(u, v);
        const auto compare = [&](std::size_t next) {
          if (!differs(image, pixel, next)) return;
          edges.push_back({.pixel = pixel, .next = next, .sun_sample = sun_sample(u, v + 2)});
        };
        if (u + 1 < image.width_px) compare(pixel + 1);
        if (v + 1 < image.height_px) compare(pixel + static_cast<std::size_t>(image.width_px));
      }
    }
  }
  return edges;
}

ViewPacket rays_of(std::span<const Edge> edges, const Viewpoint& from) {
  CameraPacket packet{};
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& edge = edges[i];
    packet.set(i, from.rays.direction_between(edge.pixel, edge.next), edge.sun_sample);
  }
  return in_map(packet, CameraView(from.T_map_cam), from.rays.pixel_rad());
}

/// For at most as many edges as fit a packet: a ray that hits the triangle of one of its pixels
/// takes over that pixel's radiance.
void take_from_pixels(std::span<Edge> edges, const ShadedImage& image, const Viewpoint& from) {
  RayCaster::TrianglePairs triangles{};
  for (std::size_t i = 0; i < edges.size(); ++i) {
    triangles[0].at(i) = image.triangles[edges[i].pixel];
    triangles[1].at(i) = image.triangles[edges[i].next];
  }
  const HitPacket hits =
      from.scene.caster.first_hits_on_pairs(triangles, rays_of(edges, from).rays);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    Edge& edge = edges[i];
    edge.is_found = hits.distance_m[i] != HitPacket::kNone;
    const bool is_next = hits.triangle[i] == triangles[1].at(i);
    edge.radiance = image.radiance[is_next ? edge.next : edge.pixel];
  }
}

/// Traces the rays of at most as many edges as fit a packet.
void trace_edges(std::span<Edge> edges, const Viewpoint& from) {
  const ViewPacket packet = rays_of(edges, from);
  const HitPacket hits = from.scene.caster.first_hits(packet.rays);
  const ShadedPacket seen = shade(from.scene, from.light, packet, hits);
  const std::uint32_t lit = sunlit(from.scene, from.light, packet, hits);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const float sun = ((lit >> i) & 1U) != 0U ? seen.sun[i] : 0.0F;
    edges[i].radiance = seen.radiance[i] + sun;
  }
}

/// Calls `act(some)` for as many edges at a time as fit a packet.
template <typename Act>
void for_each_packet(std::span<Edge> edges, const Act& act) {
  for (std::size_t first = 0; first < edges.size(); first += RayPacket::kSize) {
    act(edges.subspan(first, std::min<std::size_t>(RayPacket::kSize, edges.size() - first)));
  }
}

}  // namespace

void smooth_edges(ShadedImage& image, const Viewpoint& from, int threads) {
  const int parts = (image.height_px + kRowsAtOnce - 1) / kRowsAtOnce;
  std::vector<std::vector<Edge>> edges(static_cast<std::size_t>(parts));
  for_each_row(parts, threads, [&](int part) {
    std::vector<Edge>& found = edges[static_cast<std::size_t>(part)];
    found = edges_in(image, part * kRowsAtOnce);
    for_each_packet(found, [&](std::span<Edge> some) { take_from_pixels(some, image, from); });
    const auto open = std::ranges::stable_partition(found, &Edge::is_found);
    for_each_packet(open, [&](std::span<Edge> some) { trace_edges(some, from); });
  });
  // A pixel is the mean over its square, by the trapezoidal rule along both of its axes.
  std::vector<float> smoothed = image.radiance;
  for (const std::vector<Edge>& in_part : edges) {
    for (const Edge& edge : in_part) {
      for (const std::size_t pixel : {edge.pixel, edge.next}) {
        smoothed[pixel] += 0.25F * (edge.radiance - image.radiance[pixel]);
      }
    }
  }
  image.radiance = std::move(smoothed);
}

}  // namespace fleetloc

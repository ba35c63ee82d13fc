#include "shared/world/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fleetloc {
namespace {

constexpr float kEdgeWidth = 1.5F;  // of the edge between two cells, in pixels
constexpr std::uint32_t kSnowSeed = 0x5eed;

/// A layer of a pattern: cells of random gray.
struct Layer {
  float width_m;
  float height_m;
  float amplitude;  ///< of the albedo, relative; zero ends the list
  bool is_smooth;   ///< blends from cell to cell
  bool is_bond;     ///< every other row is shifted by half a cell
};
using Layers = std::array<Layer, 4>;

constexpr std::array<Layers, 16> kPatterns = {{
    /* kGravel  */ {{{1.7F, 1.7F, 0.35F, true, false},
                     {0.42F, 0.42F, 0.40F, false, false},
                     {0.11F, 0.11F, 0.45F, false, false},
                     {0.03F, 0.03F, 0.35F, false, false}}},
    /* kSlabs   */
    {{{2.4F, 2.4F, 0.25F, true, false},
      {0.60F, 0.60F, 0.40F, false, true},
      {0.15F, 0.15F, 0.30F, false, false},
      {0.04F, 0.04F, 0.25F, false, false}}},
    /* kGrass   */
    {{{3.1F, 3.1F, 0.40F, true, false},
      {0.55F, 0.55F, 0.45F, true, false},
      {0.16F, 0.16F, 0.50F, false, false},
      {0.05F, 0.05F, 0.45F, false, false}}},
    /* kPlaster */
    {{{2.3F, 1.7F, 0.17F, false, false},
      {0.53F, 0.47F, 0.17F, false, false},
      {0.13F, 0.12F, 0.17F, false, false},
      {0.04F, 0.04F, 0.20F, false, false}}},
    /* kBrick   */
    {{{1.9F, 1.3F, 0.18F, true, false},
      {0.75F, 0.30F, 0.22F, false, true},
      {0.25F, 0.08F, 0.40F, false, true},
      {0.04F, 0.04F, 0.20F, false, false}}},
    /* kPanels  */
    {{{1.2F, 0.60F, 0.24F, false, true},
      {0.31F, 0.27F, 0.20F, false, false},
      {0.10F, 0.10F, 0.22F, false, false},
      {0.03F, 0.03F, 0.15F, false, false}}},
    /* kRoof    */
    {{{2.0F, 2.0F, 0.20F, true, false},
      {0.40F, 0.35F, 0.40F, false, true},
      {0.12F, 0.12F, 0.20F, false, false},
      {0, 0, 0, false, false}}},
    /* kGlass   */
    {{{0.9F, 1.1F, 0.70F, true, false},
      {0.37F, 0.41F, 0.55F, false, false},
      {0, 0, 0, false, false},
      {0, 0, 0, false, false}}},
    /* kTrim    */
    {{{0.8F, 0.8F, 0.15F, false, false},
      {0.17F, 0.17F, 0.20F, false, false},
      {0.05F, 0.05F, 0.18F, false, false},
      {0, 0, 0, false, false}}},
    /* kBark    */
    {{{0.21F, 0.55F, 0.40F, false, false},
      {0.07F, 0.19F, 0.50F, false, false},
      {0.025F, 0.06F, 0.45F, false, false},
      {0, 0, 0, false, false}}},
    /* kLeaves  */
    {{{0.60F, 0.60F, 0.40F, true, false},
      {0.17F, 0.17F, 0.65F, false, false},
      {0.06F, 0.06F, 0.55F, false, false},
      {0, 0, 0, false, false}}},
    /* kPaint   */
    {{{1.4F, 0.7F, 0.15F, true, false},
      {0.45F, 0.33F, 0.14F, false, false},
      {0.09F, 0.09F, 0.12F, false, false},
      {0, 0, 0, false, false}}},
    /* kPoster  */
    {{{0.9F, 1.2F, 0.60F, false, false},
      {0.33F, 0.29F, 0.55F, false, false},
      {0.11F, 0.07F, 0.50F, false, false},
      {0.03F, 0.03F, 0.30F, false, false}}},
    /* kTarp    */
    {{{2.6F, 2.0F, 0.30F, true, false},
      {0.50F, 0.50F, 0.35F, false, false},
      {0.14F, 0.16F, 0.40F, false, false},
      {0.04F, 0.04F, 0.25F, false, false}}},
    /* kSnow    */
    {{{1.3F, 1.3F, 0.06F, true, false},
      {0.37F, 0.37F, 0.06F, true, false},
      {0.12F, 0.12F, 0.06F, false, false},
      {0.04F, 0.04F, 0.04F, false, false}}},
    /* kCloth   */
    {{{0.35F, 0.6F, 0.65F, false, false},
      {0.12F, 0.12F, 0.45F, false, false},
      {0.04F, 0.04F, 0.30F, false, false},
      {0, 0, 0, false, false}}},
}};

/// Uniform in [0, 1) by the place of a cell.
float hashed(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343U ^
                    static_cast<std::uint32_t>(y) * 0xd8163841U ^ seed;
  h ^= h >> 15U;
  h *= 0x2c1b3c6dU;
  h ^= h >> 12U;
  h *= 0x297a2d39U;
  h ^= h >> 15U;
  return static_cast<float>(h >> 8U) * 0x1.0p-24F;
}

std::int32_t floored(float value) {
  const auto truncated = static_cast<std::int32_t>(value);
  return truncated - (value < static_cast<float>(truncated) ? 1 : 0);
}

/// Between the middle of one cell and the next: 0 in the first, 1 in the second, with an edge of
/// `width` cells in between.
float edge(float share, float width) {
  return std::clamp((share - 0.5F) / width + 0.5F, 0.0F, 1.0F);
}

float smoothed(float share) {
  return share * share * (3.0F - 2.0F * share);
}

/// Blend of four neighbouring cells; (i, k) is the first and weights are those of the next ones.
float blended(std::int32_t i, std::int32_t k, const Eigen::Array2f& weight, std::uint32_t seed) {
  const auto row = [&](std::int32_t y) {
    if (weight.x() <= 0.0F) return hashed(i, y, seed);
    if (weight.x() >= 1.0F) return hashed(i + 1, y, seed);
    return (1.0F - weight.x()) * hashed(i, y, seed) + weight.x() * hashed(i + 1, y, seed);
  };
  if (weight.y() <= 0.0F) return row(k);
  if (weight.y() >= 1.0F) return row(k + 1);
  return (1.0F - weight.y()) * row(k) + weight.y() * row(k + 1);
}

/// One layer at (u, v), all in units of its cells, in [-1, 1].
float layer_value(
    const Layer& layer, float u, float v, const Eigen::Array2f& footprint, std::uint32_t seed) {
  const float y = v - 0.5F;
  const std::int32_t k = floored(y);
  float weight_y = y - static_cast<float>(k);
  weight_y = layer.is_smooth ? smoothed(weight_y) : edge(weight_y, kEdgeWidth * footprint.y());
  // A row's shift holds for one row: take that of the row which is seen.
  const bool shifted = layer.is_bond && ((weight_y < 0.5F ? k : k + 1) & 1) != 0;
  const float x = (shifted ? u + 0.5F : u) - 0.5F;
  const std::int32_t i = floored(x);
  float weight_x = x - static_cast<float>(i);
  weight_x = layer.is_smooth ? smoothed(weight_x) : edge(weight_x, kEdgeWidth * footprint.x());
  return 2.0F * blended(i, k, {weight_x, weight_y}, seed) - 1.0F;
}

/// Of two axes on the surface: 1 for cells of two pixels, 0 for those of one.
float visible_share(const Eigen::Array2f& footprint) {
  const Eigen::Array2f share = (2.0F - 2.0F * footprint).max(0.0F).min(1.0F);
  return share.x() * share.y();
}

/// Where a point lies on its surface, and how large its pixel is there.
struct OnSurface {
  float u;
  float v;
  Eigen::Array2f footprint_m;
};

/// The plane of the frame's axes that the surface is nearest to.
OnSurface on_surface(const Surface& surface, const SeenPoint& seen) {
  const auto turned = [&](const Eigen::Vector3f& x) {
    return Eigen::Vector3f(surface.cos_yaw * x.x() + surface.sin_yaw * x.y(),
                           surface.cos_yaw * x.y() - surface.sin_yaw * x.x(),
                           x.z());
  };
  const Eigen::Vector3f p = turned(seen.p_map - surface.frame.p_map);
  const Eigen::Vector3f normal = turned(seen.normal_map);
  const Eigen::Vector3f direction = turned(seen.direction_map);
  // Along an axis of the surface the pixel is longer the more the ray goes along it.
  const float across = std::max(std::abs(normal.dot(direction)), 0.05F);
  const auto footprint = [&](int axis) {
    const float slope = direction[axis] / across;
    return seen.pixel_m * std::sqrt(1.0F + slope * slope);
  };
  if (std::abs(normal.z()) > 0.7F) return {p.x(), p.y(), {footprint(0), footprint(1)}};
  if (std::abs(normal.x()) > std::abs(normal.y())) {
    return {p.y() + 0.37F * p.x(), p.z(), {footprint(1), footprint(2)}};
  }
  return {p.x() + 0.37F * p.y(), p.z(), {footprint(0), footprint(2)}};
}

}  // namespace

Eigen::Vector3f Placement::to_map(const Eigen::Vector3f& p_local) const {
  const float c = std::cos(yaw_rad);
  const float s = std::sin(yaw_rad);
  return p_map + Eigen::Vector3f(c * p_local.x() - s * p_local.y(),
                                 s * p_local.x() + c * p_local.y(),
                                 p_local.z());
}

Surface make_surface(Pattern pattern, float albedo, std::uint32_t seed, const Placement& frame) {
  Surface surface;
  surface.pattern = pattern;
  surface.albedo = albedo;
  surface.seed = seed;
  surface.is_thin = pattern == Pattern::kLeaves;
  surface.takes_snow = pattern != Pattern::kCloth;
  surface.frame = frame;
  surface.cos_yaw = std::cos(frame.yaw_rad);
  surface.sin_yaw = std::sin(frame.yaw_rad);
  return surface;
}

float albedo(const Surface& surface, const SeenPoint& seen) {
  const OnSurface place = on_surface(surface, seen);
  float value = 1.0F;
  std::uint32_t seed = surface.seed;
  for (const Layer& layer : kPatterns[static_cast<std::size_t>(surface.pattern)]) {
    if (layer.amplitude <= 0.0F) break;
    seed = seed * 747796405U + 2891336453U;
    const Eigen::Array2f footprint =
        place.footprint_m / Eigen::Array2f(layer.width_m, layer.height_m);
    const float visible = visible_share(footprint);
    if (visible <= 0.0F) continue;
    value += layer.amplitude * visible *
             layer_value(layer, place.u / layer.width_m, place.v / layer.height_m, footprint, seed);
  }
  return std::clamp(surface.albedo * value, 0.02F, 0.98F);
}

float snow_share(const SeenPoint& seen, float cover) {
  const float up = std::clamp((seen.normal_map.z() - 0.35F) / 0.3F, 0.0F, 1.0F);
  if (up <= 0.0F || cover <= 0.0F) return 0.0F;
  const float x = seen.p_map.x();
  const float y = seen.p_map.y();
  const float noise = 0.6F * smooth_noise(0.45F * x, 0.45F * y, kSnowSeed) +
                      0.4F * smooth_noise(2.3F * x, 2.3F * y, kSnowSeed + 1U);
  return up * std::clamp((cover - noise) / 0.06F + 0.5F, 0.0F, 1.0F);
}

float smooth_noise(float x, float y, std::uint32_t seed) {
  const std::int32_t i = floored(x);
  const std::int32_t k = floored(y);
  const Eigen::Array2f weight(smoothed(x - static_cast<float>(i)),
                              smoothed(y - static_cast<float>(k)));
  return blended(i, k, weight, seed);
}

}  // namespace fleetloc

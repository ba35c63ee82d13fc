#include "deploy/sim/world/surface.hpp"

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

/// Where a cell is, on its way to being hashed: that of the next one is a sum.
struct CellKey {
  static constexpr std::uint32_t kNextX = 0x8da6b343U;
  static constexpr std::uint32_t kNextY = 0xd8163841U;
  Uint4 x;
  Uint4 y;
};

CellKey key_of(const Int4& x, const Int4& y) {
  return {.x = to_unsigned(x) * CellKey::kNextX, .y = to_unsigned(y) * CellKey::kNextY};
}

/// Uniform in [0, 1) by the place of a cell; neighbours up to eight cells apart do not correlate.
Float4 hashed(const CellKey& cell, std::uint32_t seed) {
  Uint4 h = cell.x ^ cell.y ^ seed;
  h ^= h >> 15U;
  h *= 0x2c1b3c6dU;
  h ^= h >> 12U;
  h >>= 8U;
  return to_float(to_signed(h)) * 0x1.0p-24F;
}

/// Between the middle of one cell and the next: 0 in the first, 1 in the second, with an edge of
/// `width` cells in between.
Float4 edge(const Float4& share, const Float4& width) {
  return clamped((share - 0.5F) / width + 0.5F, 0.0F, 1.0F);
}

Float4 smoothed(const Float4& share) {
  return share * share * (3.0F - 2.0F * share);
}

struct Weights {
  Float4 x;
  Float4 y;
};

/// Blend of four neighbouring cells; (i, k) is the first and weights are those of the next ones.
Float4 blended(const Int4& i, const Int4& k, const Weights& weights, std::uint32_t seed) {
  const Int4 is_between = ((weights.x > 0.0F) & (weights.x < 1.0F)) |  //
                          ((weights.y > 0.0F) & (weights.y < 1.0F));
  if (!any(is_between)) return hashed(key_of(i - (weights.x > 0.0F), k - (weights.y > 0.0F)), seed);
  const CellKey cell = key_of(i, k);
  const Uint4 next_x = cell.x + CellKey::kNextX;
  const auto row = [&](const Uint4& y) {
    return (1.0F - weights.x) * hashed({.x = cell.x, .y = y}, seed) +
           weights.x * hashed({.x = next_x, .y = y}, seed);
  };
  return (1.0F - weights.y) * row(cell.y) + weights.y * row(cell.y + CellKey::kNextY);
}

/// Where points lie on their surface, and how large their pixels are there.
struct OnSurface {
  Float4 u;
  Float4 v;
  Float4 footprint_u;
  Float4 footprint_v;
};

/// The same, in units of the layer's cells.
OnSurface in_cells(const OnSurface& place_m, const Layer& layer) {
  const float per_width = 1.0F / layer.width_m;
  const float per_height = 1.0F / layer.height_m;
  return {.u = place_m.u * per_width,
          .v = place_m.v * per_height,
          .footprint_u = place_m.footprint_u * per_width,
          .footprint_v = place_m.footprint_v * per_height};
}

/// One layer, in [-1, 1].
Float4 layer_value(const Layer& layer, const OnSurface& cells, std::uint32_t seed) {
  const Float4 y = cells.v - 0.5F;
  const Int4 k = floored(y);
  Float4 weight_y = y - to_float(k);
  weight_y = layer.is_smooth ? smoothed(weight_y) : edge(weight_y, kEdgeWidth * cells.footprint_v);
  Float4 x = cells.u - 0.5F;
  if (layer
          .is_bond) {  // A row's shift holds for that row alone: take that of the row at the point.
    const Int4 row = k - (weight_y >= 0.5F);
    x += 0.5F * to_float(row & 1);
  }
  const Int4 i = floored(x);
  Float4 weight_x = x - to_float(i);
  weight_x = layer.is_smooth ? smoothed(weight_x) : edge(weight_x, kEdgeWidth * cells.footprint_u);
  return 2.0F * blended(i, k, {.x = weight_x, .y = weight_y}, seed) - 1.0F;
}

/// 1 for cells of two pixels, 0 for those of one.
Float4 visible_share(const OnSurface& cells) {
  return clamped(2.0F - 2.0F * cells.footprint_u, 0.0F, 1.0F) *
         clamped(2.0F - 2.0F * cells.footprint_v, 0.0F, 1.0F);
}

/// The plane of the frame's axes that the surface is nearest to.
OnSurface on_surface(const Surface& surface, const ShadingPoints& seen) {
  const float c = surface.cos_yaw;
  const float s = surface.sin_yaw;
  const auto turned_x = [&](const Float4& x, const Float4& y) { return c * x + s * y; };
  const auto turned_y = [&](const Float4& x, const Float4& y) { return c * y - s * x; };
  const Eigen::Vector3f& origin = surface.frame.p_map;
  const Float4 from_x = seen.p_map[0] - origin.x();
  const Float4 from_y = seen.p_map[1] - origin.y();
  const Float4 x = turned_x(from_x, from_y);
  const Float4 y = turned_y(from_x, from_y);
  const Float4 z = seen.p_map[2] - origin.z();
  const auto& n = seen.normal_map;
  const auto& d = seen.direction_map;
  // Along an axis of the surface the pixel is longer the more the ray goes along it.
  const Float4 across = max4(magnitude(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]), all4(0.05F));
  const auto footprint = [&](const Float4& along) {
    const Float4 slope = along / across;
    return seen.pixel_m * square_root(1.0F + slope * slope);
  };
  const Float4 along_x = turned_x(d[0], d[1]);
  const Float4 along_y = turned_y(d[0], d[1]);
  const Int4 is_level = magnitude(n[2]) > 0.7F;
  const Int4 faces_x = magnitude(turned_x(n[0], n[1])) > magnitude(turned_y(n[0], n[1]));
  const Float4 level_u = x;
  const Float4 upright_u = faces_x ? y + 0.37F * x : x + 0.37F * y;
  return {.u = is_level ? level_u : upright_u,
          .v = is_level ? y : z,
          .footprint_u = footprint((faces_x & ~is_level) ? along_y : along_x),
          .footprint_v = footprint(is_level ? along_y : d[2])};
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

Float4 albedo(const Surface& surface, const ShadingPoints& seen) {
  const OnSurface place_m = on_surface(surface, seen);
  Float4 value = all4(1.0F);
  std::uint32_t seed = surface.seed;
  for (const Layer& layer : kPatterns[static_cast<std::size_t>(surface.pattern)]) {
    if (layer.amplitude <= 0.0F) break;
    seed = seed * 747796405U + 2891336453U;
    const OnSurface cells = in_cells(place_m, layer);
    const Float4 visible = visible_share(cells);
    if (!any(visible > 0.0F)) continue;
    value += layer.amplitude * visible * layer_value(layer, cells, seed);
  }
  return clamped(surface.albedo * value, 0.02F, 0.98F);
}

Float4 snow_share(const ShadingPoints& seen, float cover) {
  const Float4 up = clamped((seen.normal_map[2] - 0.35F) / 0.3F, 0.0F, 1.0F);
  if (cover <= 0.0F || !any(up > 0.0F)) return all4(0.0F);
  const Float4& x = seen.p_map[0];
  const Float4& y = seen.p_map[1];
  const Float4 noise = 0.6F * smooth_noise(0.45F * x, 0.45F * y, kSnowSeed) +
                       0.4F * smooth_noise(2.3F * x, 2.3F * y, kSnowSeed + 1U);
  return up * clamped((cover - noise) / 0.06F + 0.5F, 0.0F, 1.0F);
}

Float4 smooth_noise(const Float4& x, const Float4& y, std::uint32_t seed) {
  const Int4 i = floored(x);
  const Int4 k = floored(y);
  return blended(i, k, {.x = smoothed(x - to_float(i)), .y = smoothed(y - to_float(k))}, seed);
}

float smooth_noise(float x, float y, std::uint32_t seed) {
  return smooth_noise(all4(x), all4(y), seed)[0];
}

}  // namespace fleetloc

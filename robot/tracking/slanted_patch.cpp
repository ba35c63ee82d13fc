#include "robot/tracking/slanted_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "robot/tracking/image_sampling.hpp"

namespace fleetloc {
namespace {

constexpr int kMaxRadius = 10;
constexpr float kMinPatchTexture =
    100.0F;  // sum of squared gradients along the line [gray^2 / px^2]
constexpr std::size_t kMaxPixels = (2 * kMaxRadius + 1) * (2 * kMaxRadius + 1);

/// Shift along the line at the patch's middle, its slopes along columns and rows, and a difference
/// of brightness.
using Unknowns = Eigen::Vector4f;

/// A patch of the first image, with the Jacobians of its pixels.
struct Template {
  std::array<float, kMaxPixels> gray{};
  std::array<Unknowns, kMaxPixels> J;
  Eigen::Matrix4f H = Eigen::Matrix4f::Zero();

  Template(const cv::Mat& image,
           const cv::Point2f& point,
           const Eigen::Vector2f& direction,
           int radius) {
    std::size_t i = 0;
    for (int y = -radius; y <= radius; ++y) {
      for (int x = -radius; x <= radius; ++x, ++i) {
        const auto dx = static_cast<float>(x);
        const auto dy = static_cast<float>(y);
        const float u = point.x + dx;
        const float v = point.y + dy;
        gray[i] = sampled(image, u, v);
        const Eigen::Vector2f gradient(
            0.5F * (sampled(image, u + 1.0F, v) - sampled(image, u - 1.0F, v)),
            0.5F * (sampled(image, u, v + 1.0F) - sampled(image, u, v - 1.0F)));
        const float along = gradient.dot(direction);
        J[i] = Unknowns(along, along * dx, along * dy, 1.0F);
        H += J[i] * J[i].transpose();
      }
    }
  }
};

/// Where a pixel of the patch, (dx, dy) beside its center, is in the second image.
cv::Point2f moved(
    const cv::Point2f& center, const Eigen::Vector2f& direction, float shift, float dx, float dy) {
  return {center.x + dx + shift * direction.x(), center.y + dy + shift * direction.y()};
}

/// J' (second image - first image), where the second is seen with the unknowns as they are.
std::optional<Unknowns> gradient_at(const Template& patch,
                                    const cv::Mat& to,
                                    const cv::Point2f& start,
                                    const Eigen::Vector2f& direction,
                                    const Unknowns& now,
                                    int radius) {
  Unknowns sum = Unknowns::Zero();
  std::size_t i = 0;
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x, ++i) {
      const auto dx = static_cast<float>(x);
      const auto dy = static_cast<float>(y);
      const float shift = now[0] + now[1] * dx + now[2] * dy;
      const cv::Point2f at = moved(start, direction, shift, dx, dy);
      if (!is_inside(to, at, 0.0F)) return std::nullopt;
      sum += (sampled(to, at.x, at.y) + now[3] - patch.gray[i]) * patch.J[i];
    }
  }
  return sum;
}

}  // namespace

SlantedPatchConfig read_slanted_patch_config(ConfigReader section) {
  return {.radius_px = section.integer("radius_px", 2, kMaxRadius),
          .iterations = section.integer("iterations", 1, 100),
          .converged_px = section.positive("converged_px"),
          .max_px = section.positive("max_px"),
          .gray_sigma = section.positive("gray_sigma")};
}

std::optional<SlantedMatch> match_slanted(const cv::Mat& from,
                                          const cv::Mat& to,
                                          const cv::Point2f& point,
                                          const SearchLine& line,
                                          const SlantedPatchConfig& config) {
  const auto& [start, direction, slope_sigma] = line;
  const int radius = config.radius_px;
  if (!is_inside(from, point, static_cast<float>(radius + 1))) return std::nullopt;
  const Template patch(from, point, direction, radius);
  if (patch.H(0, 0) < kMinPatchTexture) return std::nullopt;
  const auto slope_weight = static_cast<float>(std::pow(config.gray_sigma / slope_sigma, 2));
  Eigen::Matrix4f H = patch.H;
  H(1, 1) += slope_weight;
  H(2, 2) += slope_weight;
  const Eigen::LDLT<Eigen::Matrix4f> solver(H);
  Unknowns now = Unknowns::Zero();
  for (int i = 0; i < config.iterations; ++i) {
    auto g = gradient_at(patch, to, start, direction, now, radius);
    if (!g) return std::nullopt;
    g->segment<2>(1) += slope_weight * now.segment<2>(1);
    const Unknowns step = solver.solve(*g);
    now -= step;
    if (!(std::abs(now[0]) <= static_cast<float>(config.max_px))) return std::nullopt;
    if (std::abs(step[0]) >= static_cast<float>(config.converged_px)) continue;
    return SlantedMatch{moved(start, direction, now[0], 0.0F, 0.0F), now.segment<2>(1)};
  }
  return std::nullopt;
}

float correlation(const cv::Mat& from,
                  const cv::Mat& to,
                  const cv::Point2f& point,
                  const Eigen::Vector2f& direction,
                  const SlantedMatch& match,
                  int radius_px) {
  constexpr float kNone = -1.0F;
  const auto reach_px = static_cast<float>(radius_px);
  if (!is_inside(from, point, reach_px)) return kNone;
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  Eigen::Matrix2f sum_of_squares = Eigen::Matrix2f::Zero();
  for (int y = -radius_px; y <= radius_px; ++y) {
    for (int x = -radius_px; x <= radius_px; ++x) {
      const auto dx = static_cast<float>(x);
      const auto dy = static_cast<float>(y);
      const float shift = match.slopes.x() * dx + match.slopes.y() * dy;
      const cv::Point2f at = moved(match.pixel, direction, shift, dx, dy);
      if (!is_inside(to, at, 0.0F)) return kNone;
      const Eigen::Vector2f grays(sampled(from, point.x + dx, point.y + dy),
                                  sampled(to, at.x, at.y));
      sum += grays;
      sum_of_squares += grays * grays.transpose();
    }
  }
  const float side = 2.0F * reach_px + 1.0F;
  const Eigen::Matrix2f scatter = sum_of_squares - sum * sum.transpose() / (side * side);
  const float scale = std::sqrt(std::max(0.0F, scatter(0, 0) * scatter(1, 1)));
  return scale > 0.0F ? scatter(0, 1) / scale : 0.0F;
}

}  // namespace fleetloc

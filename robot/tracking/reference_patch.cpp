#include "robot/tracking/reference_patch.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "robot/tracking/image_sampling.hpp"

namespace fleetloc {
namespace {

constexpr int kLargestRadius = 10;
constexpr float kMinPatchInformation =
    1e4F;  // determinant of the sum of gradients' squares [gray^4 / px^4]

}  // namespace

ReferencePatchConfig read_reference_patch_config(ConfigReader section) {
  return {.radius_px = section.integer("radius_px", 2, kLargestRadius),
          .iterations = section.integer("iterations", 1, 100),
          .converged_px = section.positive("converged_px"),
          .max_px = section.positive("max_px"),
          .max_zoom = section.number("max_zoom", 1.0, 10.0),
          .slope_sigma = section.positive("slope_sigma"),
          .gray_sigma = section.positive("gray_sigma"),
          .max_gray_rms = section.positive("max_gray_rms")};
}

std::optional<ReferencePatch> ReferencePatch::cut(const cv::Mat& image,
                                                  const cv::Point2f& center,
                                                  int radius_px) {
  if (!is_inside(image, center, static_cast<float>(radius_px + 1))) return std::nullopt;
  ReferencePatch patch;
  patch.radius_px_ = radius_px;
  for (int y = -radius_px; y <= radius_px; ++y) {
    for (int x = -radius_px; x <= radius_px; ++x) {
      const Eigen::Vector2f offset(static_cast<float>(x), static_cast<float>(y));
      const float u = center.x + offset.x();
      const float v = center.y + offset.y();
      const Eigen::Vector2f gradient(
          0.5F * (sampled(image, u + 1.0F, v) - sampled(image, u - 1.0F, v)),
          0.5F * (sampled(image, u, v + 1.0F) - sampled(image, u, v - 1.0F)));
      Unknowns J;
      J << gradient, gradient * offset.x(), gradient * offset.y(), 1.0F;
      patch.pixels_.push_back({offset, sampled(image, u, v), J});
      patch.H_ += J * J.transpose();
    }
  }
  return patch;
}

std::optional<cv::Point2f> ReferencePatch::match(const cv::Mat& image,
                                                 const cv::Point2f& start,
                                                 const Eigen::Matrix2f& warp,
                                                 const ReferencePatchConfig& config) const {
  const auto zoom = static_cast<double>(std::sqrt(std::abs(warp.determinant())));
  if (!(zoom <= config.max_zoom && zoom * config.max_zoom >= 1.0)) return std::nullopt;
  if (H_.topLeftCorner<2, 2>().determinant() < kMinPatchInformation) return std::nullopt;
  Information to_image = Information::Identity();  // of J: gradients turn with the patch
  const Eigen::Matrix2f gradient_to_image = warp.inverse().transpose();
  for (int i = 0; i < 6; i += 2) to_image.block<2, 2>(i, i) = gradient_to_image;
  Information H = to_image * H_ * to_image.transpose();
  const auto weight = static_cast<float>(std::pow(config.gray_sigma / config.slope_sigma, 2));
  H.diagonal().segment<4>(2).array() += weight;
  const Eigen::LDLT<Information> solver(H);

  const Eigen::Vector2f at(start.x, start.y);
  Unknowns now = Unknowns::Zero();
  for (int i = 0; i < config.iterations; ++i) {
    const Eigen::Matrix2f A = warp + Eigen::Map<const Eigen::Matrix2f>(now.data() + 2);
    const auto now_off = difference(image, at + now.head<2>(), A, now[6]);
    if (!now_off) return std::nullopt;
    Unknowns g = to_image * now_off->gradient;
    g.segment<4>(2) += weight * now.segment<4>(2);
    const Unknowns step = solver.solve(g);
    now -= step;
    if (!(now.head<2>().norm() <= static_cast<float>(config.max_px))) return std::nullopt;
    if (step.head<2>().norm() >= static_cast<float>(config.converged_px)) continue;
    if (now_off->gray_rms > config.max_gray_rms) return std::nullopt;
    return cv::Point2f(start.x + now[0], start.y + now[1]);
  }
  return std::nullopt;
}

std::optional<ReferencePatch::Difference> ReferencePatch::difference(const cv::Mat& image,
                                                                     const Eigen::Vector2f& center,
                                                                     const Eigen::Matrix2f& warp,
                                                                     float brightness) const {
  // How far the warped square reaches along columns and rows.
  const Eigen::Vector2f reach = static_cast<float>(radius_px_) * warp.cwiseAbs().rowwise().sum();
  if (!is_inside(image, {center.x(), center.y()}, reach.maxCoeff())) return std::nullopt;
  Unknowns gradient = Unknowns::Zero();
  float sum_of_squares = 0.0F;
  for (const Pixel& pixel : pixels_) {
    const Eigen::Vector2f at = center + warp * pixel.offset_px;
    const float off = sampled(image, at.x(), at.y()) + brightness - pixel.gray;
    gradient += off * pixel.J;
    sum_of_squares += off * off;
  }
  return Difference{
      gradient,
      static_cast<double>(std::sqrt(sum_of_squares / static_cast<float>(pixels_.size())))};
}

}  // namespace fleetloc

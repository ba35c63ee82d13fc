#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "shared/config/config_reader.hpp"

namespace fleetloc {

struct ReferencePatchConfig {
  int radius_px;        ///< of the square that is matched
  int iterations;       ///< at most
  double converged_px;  ///< step below which they end
  double max_px;        ///< largest distance from the start
  double max_zoom;      ///< beyond this, or its inverse, the patch looks too different
  double slope_sigma;   ///< of the warp's entries, about the predicted ones [px per px]
  double gray_sigma;    ///< of what remains between two images
  double max_gray_rms;  ///< with more the patch shows something else
};

ReferencePatchConfig read_reference_patch_config(ConfigReader section);

/// What a feature looked like in one image. Matched with it, and not with the image before, a track
/// does not drift: the errors of single steps do not add up (Shi and Tomasi, Good features to
/// track, 1994: translation from frame to frame, an affine warp from the first one).
class ReferencePatch {
 public:
  /// Nothing at the image's border.
  static std::optional<ReferencePatch> cut(const cv::Mat& image,
                                           const cv::Point2f& center,
                                           int radius_px);

  /// Where the patch's center is in another image: Gauss-Newton over shift, warp and brightness,
  /// with the patch's own gradients.
  ///
  /// @param start  initial guess of the center
  /// @param warp   predicted change of the image's pixels with the patch's [px per px]
  /// @return       nothing at the border, without texture or convergence, and where the patch looks
  ///               different or is zoomed too much
  [[nodiscard]] std::optional<cv::Point2f> match(const cv::Mat& image,
                                                 const cv::Point2f& start,
                                                 const Eigen::Matrix2f& warp,
                                                 const ReferencePatchConfig& config) const;

 private:
  /// Shift of the center, columns of the warp's change (by the patch's x and y), brightness.
  using Unknowns = Eigen::Matrix<float, 7, 1>;
  using Information = Eigen::Matrix<float, 7, 7>;

  struct Pixel {
    Eigen::Vector2f offset_px;  // from the center
    float gray;
    Unknowns J;  // of the gray value where nothing is warped
  };

  /// J' (image - patch).
  struct Difference {
    Unknowns gradient;
    double gray_rms;
  };
  [[nodiscard]] std::optional<Difference> difference(const cv::Mat& image,
                                                     const Eigen::Vector2f& center,
                                                     const Eigen::Matrix2f& warp,
                                                     float brightness) const;

  int radius_px_ = 0;
  std::vector<Pixel> pixels_;
  Information H_ = Information::Zero();
};

}  // namespace fleetloc

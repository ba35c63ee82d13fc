#pragma once

#include <filesystem>

#include <opencv2/core/mat.hpp>

namespace fleetloc {

/// Decodes a PNG or JPEG file to 8 bit gray. Throws DatasetError for a file that is missing,
/// damaged or cut off.
cv::Mat read_image(const std::filesystem::path& file);

/// Encodes by the extension: .png, or .jpg of `jpeg_quality` (0..100). Throws DatasetError.
void write_image(const std::filesystem::path& file, const cv::Mat& gray, int jpeg_quality);

}  // namespace fleetloc

#include "test/unit/ros2/samples.hpp"

namespace fleetloc {
namespace {

struct Color {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

constexpr Color kRed{.red = 200, .green = 10, .blue = 30};
constexpr Color kBlue{.red = 30, .green = 10, .blue = 200};

/// Rec. 601
int gray_of(Color color) {
  return static_cast<int>(0.299 * color.red + 0.587 * color.green + 0.114 * color.blue + 0.5);
}

std::uint8_t channel(Color color, char filter) {
  return filter == 'r' ? color.red : filter == 'g' ? color.green : color.blue;
}

constexpr int kSize = 16;

/// What a sensor behind `pattern` sees, whose letters are those of the two first rows; `left` up to
/// the middle, then `right`.
cv::Mat seen(const std::string& pattern, Color left, Color right) {
  std::vector<std::uint8_t> data;
  for (std::size_t y = 0; y < kSize; ++y) {
    for (std::size_t x = 0; x < kSize; ++x) {
      data.push_back(channel(x < kSize / 2 ? left : right, pattern[2 * (y % 2) + x % 2]));
    }
  }
  return decode_image(to_cdr(raw_image(kSize, kSize, "bayer_" + pattern + "8", data))).value().gray;
}

void expect_gray(const cv::Mat& gray, int first_column, int end_column, Color color) {
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = first_column; x < end_column; ++x) {
      ASSERT_NEAR(gray.at<std::uint8_t>(y, x), gray_of(color), 1) << y << " " << x;
    }
  }
}

class Bayer : public testing::TestWithParam<std::string> {};

TEST_P(Bayer, AUniformImageHasTheGrayOfItsColor) {
  for (const Color color : {kRed, kBlue}) {
    expect_gray(seen(GetParam(), color, color), 0, kSize, color);
  }
}

TEST_P(Bayer, ARedLeftHalfHasTheGrayOfRed) {
  const cv::Mat gray = seen(GetParam(), kRed, kBlue);
  ASSERT_EQ(gray.size(), cv::Size(kSize, kSize));
  expect_gray(gray, 0, kSize / 2 - 2, kRed);
  expect_gray(gray, kSize / 2 + 2, kSize, kBlue);
}

INSTANTIATE_TEST_SUITE_P(Patterns,
                         Bayer,
                         testing::Values("rggb", "bggr", "gbrg", "grbg"),
                         [](const auto& instance) { return instance.param; });

TEST(SmallBayer, AnImageOfOnePixelDoesNotThrow) {
  for (const std::uint32_t size : {1U, 2U, 3U}) {
    const std::vector<std::uint8_t> data(std::size_t{size} * size, 50);
    const auto bytes = to_cdr(raw_image(size, size, "bayer_rggb8", data));
    EXPECT_NO_THROW((void)decode_image(bytes)) << size;
  }
}

}  // namespace
}  // namespace fleetloc

#include "robot/dataset/stereo_index.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "shared/config/delimited_file.hpp"
#include "shared/dataset/dataset_error.hpp"

namespace fleetloc {
namespace {

constexpr Duration kPairTolerance = std::chrono::milliseconds(2);

/// Least distance in time of an image from one of the other camera; neither list is empty.
Duration nearest(const std::vector<ImageEntry>& left, const std::vector<ImageEntry>& right) {
  Duration least = Duration::max();
  auto r = right.begin();
  for (const ImageEntry& one : left) {
    while (r + 1 != right.end() && r->stamp < one.stamp) ++r;
    least = std::min(least, std::chrono::abs(one.stamp - r->stamp));
    if (r != right.begin()) least = std::min(least, std::chrono::abs(one.stamp - (r - 1)->stamp));
  }
  return least;
}

std::string ms_text(Duration duration) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f ms", 1e3 * to_seconds(duration));
  return text.data();
}

}  // namespace

std::vector<ImageEntry> read_image_list(const std::filesystem::path& camera_folder) {
  std::vector<ImageEntry> images;
  try {
    DelimitedFile csv(camera_folder / "data.csv", ',');
    while (csv.next()) {
      csv.expect_columns(2);
      const Timestamp stamp = csv.nanoseconds(0);
      if (!images.empty() && stamp <= images.back().stamp) {
        csv.fail("the stamp is not later than the one before");
      }
      auto file = camera_folder / "data" / csv.text(1);
      if (!std::filesystem::is_regular_file(file)) csv.fail(file.string() + ": no such image");
      images.push_back({.stamp = stamp,
                        .file = std::move(file),
                        .where = csv.file().string() + ":" + std::to_string(csv.line())});
    }
  } catch (const TextFileError& error) {
    throw DatasetError(error.what());
  }
  if (images.empty()) {
    throw DatasetError((camera_folder / "data.csv").string() + ": lists no image");
  }
  return images;
}

std::vector<StereoEntry> pair_images(const std::vector<ImageEntry>& left,
                                     const std::vector<ImageEntry>& right) {
  std::vector<StereoEntry> pairs;
  auto l = left.begin();
  auto r = right.begin();
  while (l != left.end() || r != right.end()) {
    StereoEntry pair;
    const bool take_left =
        r == right.end() || (l != left.end() && l->stamp <= r->stamp + kPairTolerance);
    const bool take_right =
        l == left.end() || (r != right.end() && r->stamp <= l->stamp + kPairTolerance);
    if (take_left) pair.left = *l++;
    if (take_right) pair.right = *r++;
    pair.stamp = pair.left ? pair.left->stamp : pair.right->stamp;
    pairs.push_back(std::move(pair));
  }
  const bool has_pair =
      std::ranges::any_of(pairs, [](const StereoEntry& pair) { return pair.left && pair.right; });
  if (!has_pair && !left.empty() && !right.empty()) {
    throw DatasetError(
        left.front().where + ": no image of this camera has one of the other within " +
        ms_text(kPairTolerance) + ", the nearest are " + ms_text(nearest(left, right)) + " apart");
  }
  return pairs;
}

}  // namespace fleetloc

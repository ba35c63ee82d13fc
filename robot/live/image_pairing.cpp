#include "robot/live/image_pairing.hpp"

#include <algorithm>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxWaiting = 16;  // of each side

Duration distance(const LiveImage& a, const LiveImage& b) {
  return std::chrono::abs(a.stamp - b.stamp);
}

// Whether the second image of `side` is nearer to `partner` than the first one.
bool has_nearer(const std::deque<LiveImage>& side, const LiveImage& partner) {
  return side.size() > 1 && distance(side[1], partner) < distance(side[0], partner);
}

LiveImage take_front(std::deque<LiveImage>& images) {
  LiveImage image = std::move(images.front());
  images.pop_front();
  return image;
}

}  // namespace

bool ImagePairing::add(Side side, LiveImage image) {
  if (given_ && image.stamp <= *given_ + tolerance_) return false;
  std::deque<LiveImage>& waiting = of(side);
  if (waiting.size() == kMaxWaiting) {
    waiting.pop_front();
    ++dropped_;
  }
  waiting.push_back(std::move(image));
  return true;
}

std::vector<StereoFrame> ImagePairing::take(ArrivalTime now) {
  std::vector<StereoFrame> frames;
  while (auto frame = next(now)) frames.push_back(std::move(*frame));
  return frames;
}

std::optional<StereoFrame> ImagePairing::next(ArrivalTime now) {
  const auto& left = of(Side::kLeft);
  const auto& right = of(Side::kRight);
  if (!left.empty() && !right.empty()) return next_of_both();
  if (left.empty() && right.empty()) return std::nullopt;
  const Side side = right.empty() ? Side::kLeft : Side::kRight;
  if (now - of(side).front().arrival < max_wait_) return std::nullopt;
  return take_alone(side);
}

std::optional<StereoFrame> ImagePairing::next_of_both() {
  const auto& left = of(Side::kLeft);
  const auto& right = of(Side::kRight);
  const Side earlier = left[0].stamp <= right[0].stamp ? Side::kLeft : Side::kRight;
  if (distance(left[0], right[0]) > tolerance_) return take_alone(earlier);
  const bool taken =
      earlier == Side::kLeft ? has_nearer(left, right[0]) : has_nearer(right, left[0]);
  return taken ? take_alone(earlier) : take_pair();
}

StereoFrame ImagePairing::take_alone(Side side) {
  LiveImage image = take_front(of(side));
  given_ = image.stamp;
  StereoFrame frame;
  frame.stamp = image.stamp;
  frame.decoding_cpu = image.decoding_cpu;
  (side == Side::kLeft ? frame.left : frame.right) = std::move(image.gray);
  return frame;
}

StereoFrame ImagePairing::take_pair() {
  LiveImage left = take_front(of(Side::kLeft));
  LiveImage right = take_front(of(Side::kRight));
  given_ = std::max(left.stamp, right.stamp);
  return {.stamp = left.stamp,
          .left = std::move(left.gray),
          .right = std::move(right.gray),
          .decoding_cpu = left.decoding_cpu + right.decoding_cpu};
}

std::uint64_t ImagePairing::clear() {
  const std::uint64_t lost = waiting();
  for (auto& images : waiting_) images.clear();
  given_.reset();
  return lost;
}

}  // namespace fleetloc

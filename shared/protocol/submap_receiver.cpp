#include "shared/protocol/submap_receiver.hpp"

#include <bit>

namespace fleetloc {
namespace {

std::uint32_t distance(std::uint32_t a, std::uint32_t b) {
  return a > b ? a - b : b - a;
}

}  // namespace

bool SubmapReceiver::is_new(SampleNumber number) {
  const auto n = static_cast<std::uint32_t>(number);
  if (bitmap_ != 0 && distance(n, base_) > kFar) {
    const bool is_confirmed = far_ && n != *far_ && distance(n, *far_) < kFar;
    far_ = n;
    return is_confirmed;
  }
  if (n < base_) return false;
  return n - base_ >= 64 || ((bitmap_ >> (n - base_)) & 1U) == 0;
}

// The window of 64 numbers follows the newest one; leading stored ones stay in it, so that the
// share of gaps can be read from it.
void SubmapReceiver::store(SampleNumber number, Timestamp now) {
  const auto n = static_cast<std::uint32_t>(number);
  const bool is_far_behind = n < base_ && base_ - n > kFar;
  if (n < base_ && !is_far_behind) return;
  if (bitmap_ == 0 || is_far_behind) {
    base_ = n;  // the first one
    bitmap_ = 0;
  }
  if (n - base_ >= 64) {
    const std::uint32_t shift = n - base_ - 63;
    bitmap_ = shift < 64 ? bitmap_ >> shift : 0;
    base_ += shift;
  }
  const std::uint64_t bit = std::uint64_t{1} << (n - base_);
  if (bit > bitmap_) newest_stored_ = now;
  bitmap_ |= bit;
}

Acknowledgements SubmapReceiver::acknowledgements() const {
  return {SampleNumber{base_}, bitmap_};
}

double SubmapReceiver::expected_loss() const {
  constexpr double kPriorLoss = 0.25;
  constexpr double kPriorSamples = 2.0;
  const int span = bitmap_ == 0 ? 0 : 64 - std::countl_zero(bitmap_);
  return (span * loss() + kPriorSamples * kPriorLoss) / (span + kPriorSamples);
}

double SubmapReceiver::loss() const {
  if (bitmap_ == 0) return 0.0;
  const int span = 64 - std::countl_zero(bitmap_);
  return static_cast<double>(span - std::popcount(bitmap_)) / span;
}

}  // namespace fleetloc

#pragma once

#include <compare>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "shared/model/submap.hpp"

namespace fleetloc {

/// Identifies a virtual edge; ordered by the keyframe that it ends at.
struct EdgeKey {
  KeyframeId to{};
  KeyframeId from{};
  friend auto operator<=>(const EdgeKey&, const EdgeKey&) = default;
};

/// The robot's latest keyframes with the edges between them, as many as the cloud's window has:
/// what it may still have to be told of.
class KeyframeHistory {
 public:
  explicit KeyframeHistory(std::size_t max_keyframes) : max_keyframes_(max_keyframes) {}

  /// The newest window of one session: its items replace earlier ones.
  void add(const Submap& window);
  void clear();

  [[nodiscard]] bool empty() const { return keyframes_.empty(); }
  /// Oldest first.
  [[nodiscard]] const std::vector<SubmapKeyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] const SubmapKeyframe* find(KeyframeId id) const;
  /// How many keyframes came after it.
  [[nodiscard]] std::size_t newer_than(KeyframeId id) const;

  /// The edge from the keyframe before; null if there is none.
  [[nodiscard]] const VirtualEdge* edge_into(KeyframeId to) const;

  /// Of two keyframes, all steps between them together: their relative poses multiplied, their
  /// covariances added up. Nothing if a step is missing, or the keyframes are.
  [[nodiscard]] std::optional<VirtualEdge> composed(const EdgeKey& key) const;

  /// The keyframes with their observations, the edges, and as references the other keyframes of
  /// those edges. What is not known is left out.
  [[nodiscard]] Submap submap(std::span<const KeyframeId> keyframes,
                              std::span<const EdgeKey> edges) const;

 private:
  std::size_t max_keyframes_;
  std::vector<SubmapKeyframe> keyframes_;
  std::map<KeyframeId, VirtualEdge> edges_;  // from the keyframe before, by `to`
};

}  // namespace fleetloc

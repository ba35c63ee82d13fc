#include "robot/cloud_client/known_localizers.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <ranges>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxLocalizers = 256;
constexpr double kEqualLoad = 0.1;       // differences below it do not matter
constexpr double kEqualSessions = 1.25;  // as a factor

}  // namespace

std::string_view name(StatusRefusal refusal) {
  switch (refusal) {
    case StatusRefusal::kOutdated:
      return "outdated_localizer";
    case StatusRefusal::kConflict:
      return "conflicting_localizer";
  }
  return "unknown";
}

// FNV-1a, then mixed.
std::uint64_t rendezvous_hash(std::string_view robot, std::string_view localizer) {
  std::uint64_t value = 0xcbf29ce484222325U;
  const auto add = [&](unsigned char c) { value = (value ^ c) * 0x100000001b3U; };
  for (const char c : robot) add(static_cast<unsigned char>(c));
  add('/');
  for (const char c : localizer) add(static_cast<unsigned char>(c));
  value ^= value >> 33U;
  value *= 0xff51afd7ed558ccdU;
  value ^= value >> 33U;
  value *= 0xc4ceb9fe1a85ec53U;
  return value ^ (value >> 33U);
}

KnownLocalizers::KnownLocalizers(std::string_view robot, const Config& config)
    : robot_(robot), config_(config) {}

expected<void, StatusRefusal> KnownLocalizers::update(const LocalizerStatus& status,
                                                      Names kept,
                                                      Timestamp now) {
  const auto known = known_.find(status.localizer);
  if (known == known_.end()) {
    if (known_.size() >= kMaxLocalizers) {
      known_.erase(std::ranges::min_element(known_, {}, [&](const auto& item) {
        const bool is_kept = std::ranges::find(kept, item.first) != kept.end();
        return is_kept ? Timestamp::max() : item.second.heard;
      }));
    }
    known_[status.localizer] = {.status = status, .heard = now, .older_heard = {}};
    return {};
  }
  Localizer& localizer = known->second;
  if (status.incarnation < localizer.status.incarnation && is_alive(localizer, now)) {
    const bool alternate = localizer.older_heard && localizer.heard > *localizer.older_heard;
    localizer.older_heard = now;
    return unexpected(alternate ? StatusRefusal::kConflict : StatusRefusal::kOutdated);
  }
  if (status.incarnation != localizer.status.incarnation)
    localizer.excluded_until = Timestamp::min();
  localizer.status = status;
  localizer.heard = now;
  return {};
}

void KnownLocalizers::exclude(const std::string& name, Timestamp now) {
  Localizer& localizer = known_.at(name);
  const double doubled_s =
      std::ldexp(config_.exclusion_s, std::min(localizer.timeouts, kMaxDoublings));
  localizer.excluded_until = now + from_seconds(std::min(doubled_s, config_.max_exclusion_s));
  ++localizer.timeouts;
}

bool KnownLocalizers::is_alive(const Localizer& localizer, Timestamp now) const {
  return to_seconds(now - localizer.heard) <= config_.status_timeout_s;
}

bool KnownLocalizers::is_candidate(const Localizer& localizer,
                                   Names but,
                                   Timestamp now,
                                   Range range) const {
  const LocalizerStatus& status = localizer.status;
  return std::ranges::find(but, status.localizer) == but.end() && !status.draining &&
         (status.accepting || range == Range::kFull) && is_alive(localizer, now) &&
         accepts_map(status.map_hash) &&
         (range == Range::kExcluded || localizer.excluded_until <= now);
}

const KnownLocalizers::Localizer* KnownLocalizers::best(Names but,
                                                        Timestamp now,
                                                        Range range) const {
  std::vector<const Localizer*> candidates;
  for (const auto& [name, localizer] : known_) {
    if (is_candidate(localizer, but, now, range)) candidates.push_back(&localizer);
  }
  if (candidates.empty()) return nullptr;
  const auto load = [](const Localizer* one) { return one->status.load; };
  const auto sessions = [](const Localizer* one) { return one->status.sessions; };
  const double min_load = load(*std::ranges::min_element(candidates, {}, load));
  std::erase_if(candidates,
                [&](const Localizer* one) { return load(one) > min_load + kEqualLoad; });
  const int fewest = sessions(*std::ranges::min_element(candidates, {}, sessions));
  std::erase_if(candidates,
                [&](const Localizer* one) { return sessions(one) > kEqualSessions * fewest; });
  return *std::ranges::max_element(candidates, {}, [&](const Localizer* one) {
    return rendezvous_hash(robot_, one->status.localizer);
  });
}

std::vector<std::string> KnownLocalizers::standbys(std::size_t count,
                                                   std::string_view but,
                                                   Timestamp now) const {
  std::vector<std::pair<std::uint64_t, std::string>> candidates;
  for (const auto& [name, localizer] : known_) {
    if (is_candidate(localizer, {but}, now, Range::kFit))
      candidates.emplace_back(rendezvous_hash(robot_, name), name);
  }
  std::ranges::sort(candidates, std::greater());
  std::vector<std::string> names;
  for (const auto& [preference, name] : candidates | std::views::take(count)) names.push_back(name);
  return names;
}

std::string KnownLocalizers::with_other_map(Timestamp now) const {
  for (const auto& [name, localizer] : known_) {
    if (localizer.status.accepting && is_alive(localizer, now) &&
        !accepts_map(localizer.status.map_hash)) {
      return name;
    }
  }
  return "";
}

}  // namespace fleetloc

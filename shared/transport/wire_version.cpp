#include "shared/transport/wire_version.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "shared/core/ids.hpp"

namespace fleetloc {
namespace {

constexpr std::string_view kFamily = "fleetloc";
constexpr std::string_view kRobot = "/robot";
constexpr std::size_t kPrefixBytes = GuidPrefix{}.size();
constexpr std::size_t kMaxSeen = 16;
// Parameters (DDS Interoperability Wire Protocol 2.2, chapter 9.6.2.2.2).
constexpr std::uint16_t kSentinel = 0x0001;
constexpr std::uint16_t kUserData = 0x002c;
constexpr std::uint16_t kParticipantGuid = 0x0050;
constexpr std::uint16_t kEntityName = 0x0062;

// Octets or characters behind their length; a string's terminating zero is left out.
std::string_view counted(RtpsBytes value, bool is_little_endian) {
  RtpsFields fields(value, is_little_endian);
  const RtpsBytes octets = fields.skip(fields.u32());
  const std::string_view text(reinterpret_cast<const char*>(octets.data()), octets.size());
  return text.substr(0, text.find('\0'));
}

// Nothing for a text that is no version.
std::optional<int> version_in(std::string_view text) {
  if (!text.starts_with(kFamily)) return std::nullopt;
  text.remove_prefix(std::min(text.size(), kFamily.size() + 1));
  int version = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), version);
  return error == std::errc() ? std::optional(version) : std::nullopt;
}

struct Announcement {
  RtpsBytes participant;  // its prefix
  std::string_view name;
  std::string_view user_data;
};

Announcement read_announcement(RtpsBytes parameters, bool is_little_endian) {
  RtpsFields fields(parameters, is_little_endian);
  Announcement announced;
  while (fields.is_complete()) {
    const std::uint16_t id = fields.u16();
    const RtpsBytes value = fields.skip(fields.u16());
    if (id == kSentinel) break;
    if (id == kParticipantGuid)
      announced.participant = value.first(std::min(value.size(), kPrefixBytes));
    if (id == kEntityName) announced.name = counted(value, is_little_endian);
    if (id == kUserData) announced.user_data = counted(value, is_little_endian);
  }
  return announced;
}

std::vector<Announcement> announcements_in(RtpsBytes datagram) {
  std::vector<Announcement> announcements;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind != RtpsKind::kData || (submessage->flags & kHasData) == 0) continue;
    RtpsFields fields = submessage->fields();
    fields.u16();  // extra flags
    fields.u16();  // offset of the inline QoS: the four fields that follow
    fields.entity();
    if (fields.entity() != kParticipantWriter) continue;
    fields.sequence_number();
    if ((submessage->flags & kInlineQos) != 0) skip_parameters(fields);
    const RtpsBytes payload = fields.rest();
    if (payload.size() <= 4) continue;
    announcements.push_back(read_announcement(payload.subspan(4), payload[1] == 3));
  }
  return announcements;
}

}  // namespace

std::string wire_version_text(int version) {
  return std::string(kFamily) + "/" + std::to_string(version);
}

std::string wire_version_text(ChannelRole role) {
  return wire_version_text() + (role == ChannelRole::kRobot ? std::string(kRobot) : "");
}

bool announces_robot(RtpsBytes datagram) {
  return std::ranges::any_of(announcements_in(datagram), [&](const Announcement& announced) {
    return announced.user_data.starts_with(kFamily) && announced.user_data.ends_with(kRobot) &&
           std::ranges::equal(announced.participant, sender_of(datagram));
  });
}

void WireVersionWatch::observe(RtpsBytes datagram) {
  for (const Announcement& announced : announcements_in(datagram)) {
    observe(announced.name, announced.user_data);
  }
}

void WireVersionWatch::observe(std::string_view name, std::string_view user_data) {
  const auto version = version_in(user_data);
  if (!version && !name.starts_with(kFamily)) return;  // a stranger
  const Program program{is_valid_id(name) ? name : "of an odd name", version.value_or(0)};
  if (program.second == own_) return;
  const std::lock_guard lock(mutex_);
  if (seen_.size() >= kMaxSeen || !seen_.insert(program).second) return;
  events_.push_back("a program (" + program.first + ") has version " +
                    std::to_string(program.second) + " of the wire, this one " +
                    std::to_string(own_) + ": they do not hear each other");
}

std::vector<std::string> WireVersionWatch::take_events() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

}  // namespace fleetloc

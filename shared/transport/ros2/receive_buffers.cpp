#include "shared/transport/ros2/receive_buffers.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include <sys/socket.h>

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

// RTPS: ports of a domain are PB + DG * domain on.
constexpr std::uint32_t kPortBase = 7400;
constexpr std::uint32_t kPortsOfADomain = 250;

std::string content_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

template <typename Number>
std::optional<Number> parsed(std::string_view text, int base = 10) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<std::uint64_t> socket_inode(std::string_view link) {
  constexpr std::string_view kBegin = "socket:[";
  if (!link.starts_with(kBegin) || !link.ends_with(']')) return std::nullopt;
  link.remove_prefix(kBegin.size());
  link.remove_suffix(1);
  return parsed<std::uint64_t>(link);
}

std::optional<int> receive_buffer(int descriptor) {
  int bytes = 0;
  socklen_t size = sizeof bytes;
  if (getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &bytes, &size) != 0) return std::nullopt;
  return bytes / 2;  // the kernel doubles what was asked for
}

// Descriptors come and go while this looks.
SocketBuffers own_sockets() {
  SocketBuffers sockets;
  std::error_code error;
  for (fs::directory_iterator it("/proc/self/fd", error), end; !error && it != end;
       it.increment(error)) {
    std::error_code gone;
    const auto inode = socket_inode(fs::read_symlink(it->path(), gone).string());
    const auto descriptor = parsed<int>(it->path().filename().string());
    if (gone || !inode || !descriptor) continue;
    if (const auto bytes = receive_buffer(*descriptor)) sockets[*inode] = *bytes;
  }
  return sockets;
}

std::string kilobytes(int bytes) {
  constexpr int kKilobyte = 1024;
  return std::to_string(bytes / kKilobyte) + " KB";
}

}  // namespace

BufferLoss buffer_loss(std::uint32_t domain) {
  return buffer_loss(content_of("/proc/self/net/udp"), own_sockets(), domain);
}

BufferLoss buffer_loss(const std::string& proc_net_udp,
                       const SocketBuffers& sockets,
                       std::uint32_t domain) {
  constexpr std::size_t kAddress = 1;  // columns
  constexpr std::size_t kInode = 9;
  constexpr std::size_t kDrops = 12;
  constexpr int kHexadecimal = 16;
  const std::uint32_t first_port = kPortBase + kPortsOfADomain * domain;
  BufferLoss loss;
  std::istringstream lines(proc_net_udp);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    const std::vector<std::string> columns{std::istream_iterator<std::string>(words), {}};
    if (columns.size() <= kDrops) continue;
    const std::string& address = columns[kAddress];
    const auto port = parsed<std::uint32_t>(
        address.substr(std::min(address.find(':') + 1, address.size())), kHexadecimal);
    const auto inode = parsed<std::uint64_t>(columns[kInode]);
    const auto drops = parsed<std::uint64_t>(columns[kDrops]);
    if (!port || !inode || !drops || *drops == 0) continue;
    const auto own = sockets.find(*inode);
    if (own == sockets.end() || *port - first_port >= kPortsOfADomain) continue;
    loss.datagrams += *drops;
    loss.buffer_bytes =
        loss.buffer_bytes == 0 ? own->second : std::min(loss.buffer_bytes, own->second);
  }
  return loss;
}

std::string buffer_advice(const BufferLoss& loss, int rmem_max_bytes) {
  constexpr int kAskedFor = 4194304;  // receiveBufferSize in ros2.xml
  constexpr int kLargest = std::numeric_limits<int>::max() / 2;
  const int wanted = std::max(kAskedFor, 2 * std::min(loss.buffer_bytes, kLargest / 2));
  const std::string number = std::to_string(wanted);
  std::vector<std::string> settings;
  if (rmem_max_bytes < wanted)
    settings.push_back("net.core.rmem_max (sysctl -w net.core.rmem_max=" + number + ")");
  const bool is_asked_for_less = loss.buffer_bytes < rmem_max_bytes || wanted > kAskedFor;
  if (is_asked_for_less)
    settings.push_back("receiveBufferSize in the QoS profiles of ROS 2, to " + number);
  std::string raise;
  for (const std::string& setting : settings) raise += (raise.empty() ? "" : " and ") + setting;
  return std::to_string(loss.datagrams) +
         " datagrams of ROS 2 were lost because their receive buffer (" +
         kilobytes(loss.buffer_bytes) + ") was full, and what they were part of: raise " + raise +
         ", then start again";
}

int rmem_max_bytes() {
  std::ifstream stream("/proc/sys/net/core/rmem_max");
  int bytes = 0;
  stream >> bytes;
  return bytes;
}

}  // namespace fleetloc

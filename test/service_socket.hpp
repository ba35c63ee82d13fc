#pragma once

#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace fleetloc {

/// Where a service manager listens (NOTIFY_SOCKET).
class ServiceSocket {
 public:
  explicit ServiceSocket(std::filesystem::path path)
      : path_(std::move(path)), socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    std::filesystem::remove(path_);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::system_error(errno, std::generic_category(), path_.string());
    }
  }
  ~ServiceSocket() { close(socket_); }
  ServiceSocket(const ServiceSocket&) = delete;
  ServiceSocket& operator=(const ServiceSocket&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// The next message, if it comes within `patience`.
  std::optional<std::string> next(std::chrono::milliseconds patience = {}) {
    pollfd readable{.fd = socket_, .events = POLLIN, .revents = 0};
    if (poll(&readable, 1, static_cast<int>(patience.count())) != 1) return std::nullopt;
    std::array<char, 4096> text{};
    const ssize_t size = recv(socket_, text.data(), text.size(), 0);
    if (size < 0) return std::nullopt;
    return std::string(text.data(), static_cast<std::size_t>(size));
  }

  /// Whether it comes within `patience`; what comes before it is skipped.
  bool hears(const std::string& message, std::chrono::seconds patience) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < deadline) {
      if (next(std::chrono::milliseconds(100)) == message) return true;
    }
    return false;
  }

 private:
  std::filesystem::path path_;
  int socket_;
};

}  // namespace fleetloc

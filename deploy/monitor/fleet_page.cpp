#include "deploy/monitor/fleet_page.hpp"

#include <chrono>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <httplib.h>

#include "deploy/monitor/page.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxWatchers = 64;  // each keeps a thread

std::string bytes_of(const std::vector<Eigen::Vector3f>& points) {
  std::string bytes(points.size() * sizeof(Eigen::Vector3f), '\0');
  if (!points.empty()) std::memcpy(bytes.data(), points.data(), bytes.size());
  return bytes;
}

}  // namespace

FleetPage::FleetPage(const std::string& address, int port, const std::vector<Eigen::Vector3f>& map)
    : map_(bytes_of(map)), server_(std::make_unique<httplib::Server>()) {
  server_->new_task_queue = [] { return new httplib::ThreadPool(kMaxWatchers); };
  server_->set_tcp_nodelay(true);
  server_->set_socket_options([](socket_t socket) {  // its own would share the port with others
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server_->Get("/", [](const httplib::Request&, httplib::Response& response) {
    response.set_content(kPage.data(), kPage.size(), "text/html; charset=utf-8");
  });
  server_->Get("/map", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(map_, "application/octet-stream");
  });
  server_->Get("/events", [this](const httplib::Request&, httplib::Response& response) {
    send_events(response);
  });
  port_ = port == 0 ? server_->bind_to_any_port(address)
                    : (server_->bind_to_port(address, port) ? port : -1);
  if (port_ < 0) {
    throw std::runtime_error("cannot listen on " + address + ":" + std::to_string(port) +
                             ": it is in use, or not an address of this computer");
  }
  thread_ = std::jthread([this] { server_->listen_after_bind(); });
  while (!server_->is_running()) std::this_thread::yield();  // before, it cannot be stopped
}

FleetPage::~FleetPage() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  server_->stop();
}

void FleetPage::show(std::string json) {
  {
    const std::lock_guard lock(mutex_);
    json_ = std::move(json);
    ++number_;
  }
  changed_.notify_all();
}

std::string FleetPage::next(std::uint64_t& number) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return ends_ || number_ > number; });
  number = number_;
  return ends_ ? std::string() : json_;
}

void FleetPage::send_events(httplib::Response& response) {
  response.set_header("Cache-Control", "no-cache");
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, sent = std::uint64_t{0}](std::size_t, httplib::DataSink& sink) mutable {
        const std::string json = next(sent);
        if (json.empty()) return false;
        const std::string event = "data: " + json + "\n\n";
        return sink.write(event.data(), event.size());
      });
}

}  // namespace fleetloc

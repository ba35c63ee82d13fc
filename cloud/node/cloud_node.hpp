#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/node/map_publisher.hpp"
#include "cloud/node/status_log.hpp"
#include "cloud/node/worker_pool.hpp"
#include "cloud/pool/localizer_pool.hpp"
#include "cloud/pool/worker_load.hpp"
#include "shared/concurrency/reload_request.hpp"
#include "shared/config/output_folder.hpp"
#include "shared/link/link_config.hpp"
#include "shared/service/service_manager.hpp"
#include "shared/transport/dds_channel.hpp"
#include "shared/transport/monitoring/fleet_writer.hpp"

namespace fleetloc {

struct CloudNodeOptions {
  std::filesystem::path map;  ///< .pcd, see load_map()
  std::filesystem::path qos;  ///< profiles of the network
  std::filesystem::path out;  ///< folder for status.csv and sessions.json; empty: neither
  std::string name;           ///< of the localizer, unique in the fleet
  std::uint32_t domain = 0;
  int workers = 1;                 ///< localizations at a time
  std::optional<LinkConfig> link;  ///< emulated; none: the network as it is
  std::optional<std::filesystem::path> monitor_qos = std::nullopt;  ///< none: the built-in one
  std::optional<FleetKeys> keys = std::nullopt;                     ///< none: no DDS Security
  std::optional<double> publish_map_voxel_m;                        ///< to ROS 2; none: it is not
};

struct CloudNodeConfig {
  LocalizerPool::Config pool;
  MapPublisher::Config map_publisher;
};

/// A localizer on the network: everything that can fail before it starts fails in the constructor
/// (TransportError, std::runtime_error).
class CloudNode {
 public:
  /// @param reload  begins status.csv anew; outlives the node
  CloudNode(const CloudNodeOptions& options, const CloudNodeConfig& config, ReloadRequest& reload);

  /// Serves robots until a stop is requested and its robots have gone elsewhere, or for a while; or
  /// until an urgent stop is. Writes status.csv meanwhile, sessions.json then.
  void run(const std::stop_token& stop, const std::stop_token& urgent);

 private:
  bool is_over(const std::stop_token& stop, const std::stop_token& urgent);
  void serve(WorkerPool& workers, WorkerLoad& load);
  void report(double load, Timestamp now);
  void log_status(double load, Timestamp now);
  void tell_watchers(Timestamp now);
  void finish_jobs(WorkerPool& workers, WorkerLoad& load);
  void start_jobs(WorkerPool& workers);

  CloudNodeOptions options_;
  ReloadRequest& reload_;
  ServiceManager service_;
  std::unique_ptr<const OutputFolder> out_;
  std::optional<StatusLog> log_;
  std::shared_ptr<const LaserMap> map_;
  DdsChannel channel_;
  LocalizerPool pool_;
  std::optional<MapPublisher> map_publisher_;
  FleetWriter fleet_;
  std::optional<Timestamp> told_;  // to those who watch the fleet
  std::optional<Timestamp> draining_since_;
};

}  // namespace fleetloc

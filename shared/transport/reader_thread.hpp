#pragma once

#include <functional>
#include <thread>
#include <vector>

#include <fastdds/dds/subscriber/DataReader.hpp>

namespace fleetloc {

/// Calls `take` with a reader that may hold samples, until it returns false: nothing was left.
/// Always from one thread of its own, so that no user code runs on DDS threads; no call is made
/// after the destructor has returned. The readers must outlive this object.
class ReaderThread {
 public:
  using Take = std::function<bool(eprosima::fastdds::dds::DataReader&)>;

  ReaderThread(std::vector<eprosima::fastdds::dds::DataReader*> readers, Take take);

 private:
  std::jthread thread_;
};

}  // namespace fleetloc

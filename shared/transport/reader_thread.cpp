#include "shared/transport/reader_thread.hpp"

#include <stop_token>
#include <utility>

#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/StatusCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>

namespace fleetloc {

namespace dds = eprosima::fastdds::dds;

namespace {

void take_on_arrival(const std::stop_token& stop,
                     const std::vector<dds::DataReader*>& readers,
                     const ReaderThread::Take& take) {
  dds::GuardCondition stop_requested;
  dds::WaitSet wait_set;
  wait_set.attach_condition(stop_requested);
  for (dds::DataReader* reader : readers) {
    reader->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
    wait_set.attach_condition(reader->get_statuscondition());
  }
  // Declared last: its destructor waits for a callback that still uses the condition.
  const std::stop_callback wake(stop, [&] { stop_requested.set_trigger_value(true); });

  dds::ConditionSeq triggered;
  while (!stop.stop_requested()) {
    for (dds::DataReader* reader : readers) {
      while (!stop.stop_requested() && take(*reader)) continue;
    }
    wait_set.wait(triggered, eprosima::fastrtps::c_TimeInfinite);
  }
  for (dds::DataReader* reader : readers) wait_set.detach_condition(reader->get_statuscondition());
  wait_set.detach_condition(stop_requested);
}

}  // namespace

ReaderThread::ReaderThread(std::vector<dds::DataReader*> readers, Take take)
    : thread_([readers = std::move(readers), take = std::move(take)](const std::stop_token& stop) {
        take_on_arrival(stop, readers, take);
      }) {}

}  // namespace fleetloc

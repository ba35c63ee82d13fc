# The architecture: rooms whose arrows point one way, idl, shared <- robot, cloud <- deploy <- test;
# in them layers, lowest first. A library is a folder; it may use only lower layers, and robot/ and
# cloud/ never use each other. Checked twice: where a target declares what it USES, and over every
# #include by the test `layers`.
set(FLEETLOC_LAYERS
    "shared/core idl idl/ros2"
    "shared/geometry shared/concurrency shared/config shared/coding shared/cdr shared/service"
    "shared/model shared/link shared/transport/workarounds"
    "shared/factors shared/wire shared/ros2 shared/transport shared/trajectory shared/dataset"
    "shared/compact shared/transport/ros2 shared/transport/monitoring"
    "shared/protocol"
    "robot/sensors robot/calibration"
    "robot/dataset robot/live robot/tracking robot/inertial cloud/point_cloud"
    "robot/vio robot/submap robot/fusion robot/uplink cloud/laser_map cloud/mapping"
    "robot/odometry robot/cloud_client cloud/locate"
    "robot/pipeline cloud/localizer"
    "robot/runtime cloud/pool"
    "robot/run_folder"
    "robot/node cloud/node"
    "deploy/config deploy/faults deploy/process deploy/monitor deploy/topic deploy/sim/world deploy/sim/motion deploy/sim/room deploy/evaluation/errors"
    "deploy/play deploy/replay deploy/sim/sensors deploy/evaluation/report"
    "deploy/sim/recording deploy/evaluation/experiment"
    "deploy/tools")

# In the order in which CMake has to see them.
string(REPLACE " " ";" FLEETLOC_FOLDERS "${FLEETLOC_LAYERS}")

# Third-party headers that only these may include.
set(FLEETLOC_OWNERS "(fastdds|fastrtps)/=shared/transport(/workarounds|/ros2|/monitoring)?"
    "fastcdr/=shared/cdr" "pcl/=cloud/point_cloud|deploy/replay" "embree3/=deploy/sim/world" "systemd/=shared/service" "httplib=deploy/monitor" "tl/=shared/core"
    "openssl/=shared/transport")

function(fleetloc_layer_of folder out)
  set(index 0)
  foreach(layer IN LISTS FLEETLOC_LAYERS)
    if(" ${layer} " MATCHES " ${folder} ")
      set(${out} ${index} PARENT_SCOPE)
      return()
    endif()
    math(EXPR index "${index} + 1")
  endforeach()
  message(FATAL_ERROR "fleetloc: '${folder}' is in no layer; see FLEETLOC_LAYERS")
endfunction()

# Sets `out` to the reason why folder `own` may not use folder `used`; empty if it may.
function(fleetloc_why_not own used out)
  set(${out} "" PARENT_SCOPE)
  fleetloc_layer_of(${own} own_layer)
  fleetloc_layer_of(${used} used_layer)
  if("${own} ${used}" MATCHES "^(shared|robot|cloud)/[^ ]* deploy/")
    set(${out} "'${own}' may not use '${used}': nothing below deploy/ needs it" PARENT_SCOPE)
  elseif(NOT used_layer LESS own_layer)
    set(${out} "'${own}' (layer ${own_layer}) may not use '${used}' (layer ${used_layer})"
        PARENT_SCOPE)
  elseif("${own} ${used}" MATCHES "^(robot/.* cloud|cloud/.* robot)/")
    set(${out} "'${own}' may not use '${used}'; what both need belongs in shared/" PARENT_SCOPE)
  endif()
endfunction()

# The architecture, lowest layer first. A library is a folder; it may use only lower layers, and
# robot/ and cloud/ never use each other. Checked twice: where a target declares what it USES,
# and over every #include by the test `layers`.
set(FLEETLOC_LAYERS
    "shared/core idl"
    "shared/geometry shared/concurrency shared/config shared/process"
    "shared/model shared/link"
    "shared/factors shared/wire shared/transport shared/trajectory shared/dataset shared/pointcloud"
    "shared/protocol shared/run_folder robot/tracking robot/inertial cloud/laser_map shared/simulation shared/motion shared/world"
    "robot/vio robot/submap robot/fusion cloud/baseline cloud/localizer cloud/mapping shared/sensors deploy/report"
    "robot/pipeline robot/cloud_client cloud/pool deploy/monitor deploy/experiment"
    "robot/node cloud/node deploy/tools")

# Third-party headers that only one library may include.
set(FLEETLOC_OWNERS "(fastdds|fastrtps)/=shared/transport" "fastcdr/=shared/wire" "pcl/=shared/pointcloud"
    "embree3/=shared/world")

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
  if(NOT used_layer LESS own_layer)
    set(${out} "'${own}' (layer ${own_layer}) may not use '${used}' (layer ${used_layer})"
        PARENT_SCOPE)
  elseif("${own} ${used}" MATCHES "^(robot/.* cloud|cloud/.* robot)/")
    set(${out} "'${own}' may not use '${used}'; what both need belongs in shared/" PARENT_SCOPE)
  endif()
endfunction()

# fleetloc_types(<folder> <type>...)
# The target of idl/ or a folder in it: <type>.idl as C++, for #include <idl/.../type.h>. Types are
# generated at build time; generated code is never committed.
find_program(FASTDDSGEN fastddsgen REQUIRED)

function(fleetloc_types folder)
  set(idl_folder ${PROJECT_SOURCE_DIR}/${folder})
  set(include ${CMAKE_CURRENT_BINARY_DIR}/include)
  set(generated ${include}/${folder})
  set(scratch ${CMAKE_CURRENT_BINARY_DIR}/scratch)  # the default is shared by all builds
  file(MAKE_DIRECTORY ${generated})
  list(TRANSFORM ARGN APPEND .idl OUTPUT_VARIABLE idl_files)
  list(TRANSFORM idl_files PREPEND ${idl_folder}/)
  set(sources "")
  foreach(type IN LISTS ARGN)
    file(MAKE_DIRECTORY ${scratch}/${type})
    set(outputs ${generated}/${type}.cxx ${generated}/${type}PubSubTypes.cxx)
    add_custom_command(
      OUTPUT ${outputs} ${generated}/${type}.h ${generated}/${type}PubSubTypes.h
      COMMAND ${FASTDDSGEN} -cs -replace -d ${generated} -t ${scratch}/${type}
              -I ${idl_folder} ${idl_folder}/${type}.idl
      DEPENDS ${idl_files}  # all of them, because they include each other
      COMMENT "Generating DDS types from ${folder}/${type}.idl" VERBATIM)
    list(APPEND sources ${outputs})
  endforeach()
  string(REPLACE "/" "_" name ${folder})
  add_library(fleetloc_${name} STATIC ${sources})
  add_library(fleetloc::${name} ALIAS fleetloc_${name})
  set_target_properties(fleetloc_${name} PROPERTIES UNITY_BUILD OFF)  # not written for it
  target_include_directories(fleetloc_${name} SYSTEM PUBLIC ${include} ${generated})
  target_compile_features(fleetloc_${name} PUBLIC cxx_std_20)
  target_link_libraries(fleetloc_${name} PUBLIC fastrtps fastcdr)
endfunction()

# SPDX-License-Identifier: Apache-2.0
# fourdvt_quick_build_folder(FOLDER) halves the compiler's work on the libraries and programs of a folder: headers of the
# standard library and GLM are parsed once for all targets, and sources of a target are compiled together. A source still
# includes whatever it uses, and its names are its target's only ones: with both options off, every source is compiled
# on its own. For wasm, sources of the player's two parts (wasm/more.txt) are compiled apart.
#
# FOURDVT_PRECOMPILE is off by default where ccache compiles: it keeps objects between builds, and keeps none that used a
# precompiled header.
set(precompile_by_default ON)
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
  set(precompile_by_default OFF)
endif()
option(FOURDVT_PRECOMPILE "Parse the common headers once for all targets" ${precompile_by_default})
set(CMAKE_PCH_WARN_INVALID OFF)  # a source with its own options reads the headers as they are

set(FOURDVT_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <cstdio> <cstring> <filesystem> <functional> <map>
  <memory> <optional> <set> <span> <sstream> <string> <string_view> <utility> <vector>
  <glm/glm.hpp> <glm/gtc/matrix_transform.hpp> <glm/gtc/quaternion.hpp>)

if(FOURDVT_PRECOMPILE)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled.cpp CONTENT "// Holds the precompiled header.\n")
  add_library(fourdvt_precompiled OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(fourdvt_precompiled PRIVATE fourdvt_flags fourdvt_glm)
  target_precompile_headers(fourdvt_precompiled PRIVATE ${FOURDVT_COMMON_HEADERS})
endif()

set(unity_by_default OFF)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  set(unity_by_default ON)
endif()
option(FOURDVT_UNITY "Compile sources of a target together" ${unity_by_default})
set(FOURDVT_UNITY_FILES 16 CACHE STRING "Most sources that are compiled together")
# Every command's file has its own help() and readOptions().
set(FOURDVT_UNITY_LEAVE_OUT fourdvt_tools fourdvt_more_tools fourdvt-lab)

function(fourdvt_quick_build target)
  if(FOURDVT_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM fourdvt_precompiled)
  endif()
  if(FOURDVT_UNITY AND NOT target IN_LIST FOURDVT_UNITY_LEAVE_OUT)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${FOURDVT_UNITY_FILES})
    if(EMSCRIPTEN)
      fourdvt_group_by_part(${target})
    endif()
  endif()
endfunction()

# Puts the target's sources of the second part, and the others, into a unity source each.
function(fourdvt_group_by_part target)
  file(STRINGS ${PROJECT_SOURCE_DIR}/wasm/more.txt more REGEX "^[a-z].*/")
  get_target_property(folder ${target} SOURCE_DIR)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder} NORMALIZE OUTPUT_VARIABLE path)
    set(part first)
    foreach(name ${more})
      set(name ${PROJECT_SOURCE_DIR}/${name})
      if(path STREQUAL "${name}.cpp" OR (name MATCHES "/$" AND path MATCHES "^${name}"))
        set(part more)
      endif()
    endforeach()
    set_source_files_properties(${path} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${part})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()

# The same for every library and program that the folder and the folders below it have defined.
function(fourdvt_quick_build_folder folder)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    if(type MATCHES "^(STATIC_LIBRARY|EXECUTABLE)$")
      fourdvt_quick_build(${target})
    endif()
  endforeach()
  get_property(folders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(below ${folders})
    fourdvt_quick_build_folder(${below})
  endforeach()
endfunction()

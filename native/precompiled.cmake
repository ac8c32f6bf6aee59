# SPDX-License-Identifier: Apache-2.0
# fourdvt_precompile(TARGET...) and fourdvt_precompile_folder(FOLDER) compile the sources of targets with the standard
# library's and GLM's headers parsed beforehand, once for all targets. A source still includes whatever it uses: with the option off, and in the wasm
# build, nothing is precompiled.
#
# Off by default where ccache compiles: it keeps objects between builds, and keeps none that used a precompiled header.
set(precompile_by_default ON)
if(EMSCRIPTEN OR CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
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

function(fourdvt_precompile)
  if(FOURDVT_PRECOMPILE)
    foreach(target ${ARGN})
      target_precompile_headers(${target} REUSE_FROM fourdvt_precompiled)
    endforeach()
  endif()
endfunction()

# The same for every library and program that the folder and the folders below it have defined.
function(fourdvt_precompile_folder folder)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    if(type MATCHES "^(STATIC_LIBRARY|EXECUTABLE)$")
      fourdvt_precompile(${target})
    endif()
  endforeach()
  get_property(folders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(below ${folders})
    fourdvt_precompile_folder(${below})
  endforeach()
endfunction()

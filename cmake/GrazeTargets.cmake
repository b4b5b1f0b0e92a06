# The few CMake functions of graze: how a library, a solver, a surface and the registry are declared.

# Public headers are <graze/solvers/x.hpp> and <graze/surfaces/x.hpp>, in the tree as when installed:
# the build tree holds a folder graze/ of links to the sources.
set(GRAZE_INCLUDE_DIR ${PROJECT_BINARY_DIR}/include)
file(MAKE_DIRECTORY ${GRAZE_INCLUDE_DIR}/graze)
foreach(folder solvers surfaces experiments)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${GRAZE_INCLUDE_DIR}/graze/${folder} SYMBOLIC)
endforeach()

# Warnings and floating-point rules that hold for every target of graze. -ffp-contract=off: a fused
# multiply-add happens where the source says std::fma and nowhere else, so results do not depend on flags.
add_library(graze_flags INTERFACE)
target_compile_options(graze_flags INTERFACE
  -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
  $<$<BOOL:${GRAZE_WERROR}>:-Werror>)
# g++ 12 warns of an overlap inside std::string's own operator+ ("text" + std::string&&; GCC bug 105651).
target_compile_options(graze_flags INTERFACE
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)

set_property(GLOBAL PROPERTY GRAZE_COMPONENTS "")
set_property(GLOBAL PROPERTY GRAZE_SOLVER_LIST "")
set_property(GLOBAL PROPERTY GRAZE_SURFACE_LIST "")
set_property(GLOBAL PROPERTY GRAZE_REGISTRY_LIBRARIES "")

# graze_library(NAME [SOURCES ...]): static library graze_NAME, alias and installed target graze::NAME.
function(graze_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES" ${ARGN})
  # A component whose methods are all left out is still a library.
  if(NOT ARG_SOURCES)
    set(ARG_SOURCES ${PROJECT_BINARY_DIR}/generated/${name}.cpp)
    file(WRITE ${ARG_SOURCES}.in "// Generated: the methods of graze::${name} are in their own files.\n")
    configure_file(${ARG_SOURCES}.in ${ARG_SOURCES} COPYONLY)
  endif()
  add_library(graze_${name} STATIC ${ARG_SOURCES})
  add_library(graze::${name} ALIAS graze_${name})
  set_target_properties(graze_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(graze_${name} PUBLIC cxx_std_20)
  target_include_directories(graze_${name} PUBLIC
    $<BUILD_INTERFACE:${GRAZE_INCLUDE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(graze_${name} PRIVATE $<BUILD_INTERFACE:graze_flags>)
  set_property(GLOBAL APPEND PROPERTY GRAZE_COMPONENTS ${name})
endfunction()

# True in OUT when NAME is wanted by the cache list CHOICE ("all" or names).
function(graze_wanted name choice out)
  if("${choice}" STREQUAL "all" OR "${name}" IN_LIST choice)
    set(${out} TRUE PARENT_SCOPE)
  else()
    set(${out} FALSE PARENT_SCOPE)
  endif()
endfunction()

# graze_solver(STEM [LIBRARY lib] [NEEDS sources]): the one list line of a method: solvers/STEM.{hpp,cpp}
# defines the struct whose registry name is STEM; lib is the component it is compiled into (default: solvers);
# NEEDS are sources that only some methods use.
function(graze_solver stem)
  cmake_parse_arguments(ARG "" "LIBRARY" "NEEDS" ${ARGN})
  if(NOT ARG_LIBRARY)
    set(ARG_LIBRARY solvers)
  endif()
  graze_wanted(${stem} "${GRAZE_SOLVERS}" wanted)
  if(wanted AND TARGET graze_${ARG_LIBRARY})
    target_sources(graze_${ARG_LIBRARY} PRIVATE ${stem}.cpp ${ARG_NEEDS})
    set_property(GLOBAL APPEND PROPERTY GRAZE_SOLVER_LIST ${stem})
    set_property(GLOBAL APPEND PROPERTY GRAZE_REGISTRY_LIBRARIES graze_${ARG_LIBRARY})
  endif()
endfunction()

# graze_surface(STEM [WITH sources] [NEEDS sources]): the one list line of a surface, as graze_solver; WITH are
# further sources of its own, NEEDS are sources of solvers/ that only some surfaces use.
function(graze_surface stem)
  cmake_parse_arguments(ARG "" "" "NEEDS;WITH" ${ARGN})
  graze_wanted(${stem} "${GRAZE_SURFACES}" wanted)
  if(wanted)
    target_sources(graze_surfaces PRIVATE ${stem}.cpp ${ARG_WITH})
    list(TRANSFORM ARG_NEEDS PREPEND ${PROJECT_SOURCE_DIR}/solvers/)
    target_sources(graze_solvers PRIVATE ${ARG_NEEDS})
    set_property(GLOBAL APPEND PROPERTY GRAZE_SURFACE_LIST ${stem})
    set_property(GLOBAL APPEND PROPERTY GRAZE_REGISTRY_LIBRARIES graze_surfaces)
  endif()
endfunction()

# graze_kernel(SURFACE SOLVER [AFTER solver] [LANES sources] [NEEDS sources]): the one list line of a surface's
# batch kernel for a solver, in the build if both are, and with AFTER if the surface's kernel for that solver is
# in it, which this one builds on: surfaces/SURFACE_SOLVER.{hpp,cpp} defines it, LANES is compiled once for each
# instruction set (solvers/math/lanes.hpp), also where several kernels share it.
function(graze_kernel surface solver)
  cmake_parse_arguments(ARG "" "AFTER" "LANES;NEEDS" ${ARGN})
  get_property(solvers GLOBAL PROPERTY GRAZE_SOLVER_LIST)
  get_property(surfaces GLOBAL PROPERTY GRAZE_SURFACE_LIST)
  get_property(kernels GLOBAL PROPERTY GRAZE_KERNELS_OF_${surface})
  if(NOT surface IN_LIST surfaces OR NOT solver IN_LIST solvers)
    return()
  endif()
  if(ARG_AFTER AND NOT ${surface}_${ARG_AFTER} IN_LIST kernels)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY GRAZE_KERNELS_OF_${surface} ${surface}_${solver})
  target_sources(graze_surfaces PRIVATE ${surface}_${solver}.cpp ${ARG_NEEDS})
  set(flags_avx512 -mavx512f -mavx512dq -mavx2 -mfma)
  set(flags_avx2 -mavx2 -mfma)
  set(flags_baseline "")
  set(sets baseline)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND sets avx2 avx512)
  endif()
  if(NOT ARG_LANES)
    return()
  endif()
  list(GET ARG_LANES 0 first)
  get_filename_component(stem ${first} NAME_WE)
  foreach(set ${sets})
    # An object library of its own: the same sources, other flags.
    set(object graze_${stem}_${set})
    if(TARGET ${object})
      continue()
    endif()
    add_library(${object} OBJECT ${ARG_LANES})
    target_compile_features(${object} PRIVATE cxx_std_20)
    # g++ 12 warns about the deliberately undefined vectors of its own intrinsics (GCC bug 105593).
    target_compile_options(${object} PRIVATE ${flags_${set}}
      $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-uninitialized$<SEMICOLON>-Wno-maybe-uninitialized>)
    target_include_directories(${object} PRIVATE ${GRAZE_INCLUDE_DIR})
    target_link_libraries(${object} PRIVATE graze_flags)
    set_target_properties(${object} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_sources(graze_surfaces PRIVATE $<TARGET_OBJECTS:${object}>)
  endforeach()
endfunction()

# bezier_revolution -> BezierRevolution: a registry name's C++ type.
function(graze_camel_case stem out)
  string(REPLACE "_" ";" words ${stem})
  set(camel "")
  foreach(word ${words})
    string(SUBSTRING ${word} 0 1 first)
    string(SUBSTRING ${word} 1 -1 rest)
    string(TOUPPER ${first} first)
    string(APPEND camel ${first}${rest})
  endforeach()
  set(${out} ${camel} PARENT_SCOPE)
endfunction()

# Registry lines of one kind: the include and the factory entry of every listed stem.
function(graze_registry_lines kind folder list out_includes out_entries)
  set(includes "")
  set(entries "")
  foreach(stem ${list})
    graze_camel_case(${stem} type)
    string(APPEND includes "#include <graze/${folder}/${stem}.hpp>\n")
    get_property(kernels GLOBAL PROPERTY GRAZE_KERNELS_OF_${stem})
    set(kernel_list "")
    foreach(kernel ${kernels})
      graze_camel_case(${kernel} kernel_type)
      string(APPEND includes "#include <graze/${folder}/${kernel}.hpp>\n")
      string(APPEND kernel_list "kernel_entry<${kernel_type}>(), ")
    endforeach()
    if(kernel_list)
      set(kernel_list ", {${kernel_list}}")
    endif()
    string(APPEND entries "      ${kind}_entry<${type}>(\"${stem}\"${kernel_list}),\n")
  endforeach()
  set(${out_includes} "${includes}" PARENT_SCOPE)
  set(${out_entries} "${entries}" PARENT_SCOPE)
endfunction()

# Refuses a name in the cache list VARIABLE ("all" or names) that LIST does not have.
function(graze_check_names variable list)
  foreach(name ${${variable}})
    if(NOT name STREQUAL "all" AND NOT name IN_LIST list)
      string(REPLACE ";" ", " listed "${list}")
      message(FATAL_ERROR "${variable}: '${name}' is not in this build (of the names given, it has: ${listed}). "
                          "The lists are in solvers/CMakeLists.txt and surfaces/CMakeLists.txt.")
    endif()
  endforeach()
endfunction()

# The registry: one generated source that names every method of the lists. No static initialisers.
function(graze_generate_registry)
  get_property(solvers GLOBAL PROPERTY GRAZE_SOLVER_LIST)
  get_property(surfaces GLOBAL PROPERTY GRAZE_SURFACE_LIST)
  get_property(libraries GLOBAL PROPERTY GRAZE_REGISTRY_LIBRARIES)
  graze_check_names(GRAZE_SOLVERS "${solvers}")
  graze_check_names(GRAZE_SURFACES "${surfaces}")
  list(REMOVE_DUPLICATES libraries)
  graze_registry_lines(solver solvers "${solvers}" SOLVER_INCLUDES SOLVER_ENTRIES)
  graze_registry_lines(surface surfaces "${surfaces}" SURFACE_INCLUDES SURFACE_ENTRIES)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/registry.cpp.in ${PROJECT_BINARY_DIR}/generated/registry.cpp @ONLY)
  graze_library(registry SOURCES ${PROJECT_BINARY_DIR}/generated/registry.cpp ${PROJECT_SOURCE_DIR}/surfaces/registry.cpp)
  target_link_libraries(graze_registry PUBLIC graze_surfaces graze_solvers ${libraries})
endfunction()

# Install every component that was built, its headers, and the package files for find_package(graze).
function(graze_install)
  get_property(components GLOBAL PROPERTY GRAZE_COMPONENTS)
  foreach(component ${components})
    install(TARGETS graze_${component} EXPORT graze-${component}
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component})
    install(EXPORT graze-${component} NAMESPACE graze:: FILE graze-${component}.cmake
            DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/graze COMPONENT ${component})
  endforeach()
  install(DIRECTORY solvers surfaces DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/graze FILES_MATCHING PATTERN "*.hpp")
  if(TARGET graze_truth)
    install(FILES experiments/truth.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/graze/experiments)
  endif()
  include(CMakePackageConfigHelpers)
  set(GRAZE_BUILT_COMPONENTS ${components})
  configure_package_config_file(cmake/grazeConfig.cmake.in ${PROJECT_BINARY_DIR}/grazeConfig.cmake
    INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/graze)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/grazeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/grazeConfig.cmake ${PROJECT_BINARY_DIR}/grazeConfigVersion.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/graze)
endfunction()

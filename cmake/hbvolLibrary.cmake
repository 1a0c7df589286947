# One library target a folder: hbvol_<folder>, known as hbvol::<folder>, inside the build and after installation alike.

set_property(GLOBAL PROPERTY HBVOL_LIBRARIES "")

# Settings every hbvol target shares: warnings, sanitizers, and arithmetic that does not depend on the optimiser
# (no contraction of x*y+z, never -ffast-math), so that targets and builds agree.
function(hbvol_settings target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wformat=2
    -ffp-contract=off)
  if(HBVOL_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(HBVOL_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${HBVOL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=${HBVOL_SANITIZE})
  endif()
endfunction()

# hbvol_library(<folder> SOURCES ... HEADERS ... [PUBLIC targets...] [PRIVATE targets...])
# HEADERS are the public ones, installed under include/hbvol/<folder>.
function(hbvol_library folder)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  set(target hbvol_${folder})
  add_library(${target})
  add_library(hbvol::${folder} ALIAS ${target})
  target_sources(${target}
    PRIVATE ${ARG_SOURCES}
    PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/hbvol>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${folder} VERSION ${PROJECT_VERSION} SOVERSION 0)
  hbvol_settings(${target})
  install(TARGETS ${target} EXPORT hbvol-${folder}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hbvol)
  install(EXPORT hbvol-${folder} NAMESPACE hbvol:: FILE hbvol-${folder}.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hbvol)
  set_property(GLOBAL APPEND PROPERTY HBVOL_LIBRARIES ${folder})
endfunction()

function(hbvol_install_package)
  include(CMakePackageConfigHelpers)
  get_property(HBVOL_LIBRARIES GLOBAL PROPERTY HBVOL_LIBRARIES)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/hbvolConfig.cmake.in hbvolConfig.cmake
    INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hbvol)
  write_basic_package_version_file(hbvolConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/hbvolConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/hbvolConfigVersion.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hbvol)
endfunction()

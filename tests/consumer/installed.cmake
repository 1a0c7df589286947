# cmake -D BUILD=... -D WORK=... -D GENERATOR=... -D COMPILER=... -D FLAGS=... -D LIBDIR=... -D INCLUDEDIR=...
#       -D BINDIR=... -D VERSION=... -P installed.cmake
# Installs the build tree BUILD below WORK and uses the installed package from a project of its own.

# A library needs none of those before it.
set(libraries report glcombine raycast scene fitting sparsegrid volume)
set(needs_report glcombine raycast scene fitting sparsegrid volume)
set(needs_glcombine raycast scene sparsegrid volume)
set(needs_raycast scene sparsegrid volume)
set(needs_scene volume)
set(needs_fitting sparsegrid volume)
set(needs_sparsegrid volume)
set(needs_volume "")
set(prints_volume 3.5)
set(prints_sparsegrid 27.8246)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "${command}\nended with ${status}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/first)
# Nothing in it may depend on where it was put.
set(prefix ${WORK}/moved)
file(RENAME ${WORK}/first ${prefix})
run(${prefix}/${BINDIR}/hbvol --version)
if(NOT output STREQUAL "hbvol ${VERSION}\n")
  message(FATAL_ERROR "the installed program says '${output}', expected 'hbvol ${VERSION}'")
endif()

set(configure ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${COMPILER}
  "-D CMAKE_CXX_FLAGS=${FLAGS}" -D CMAKE_PREFIX_PATH=${prefix} -D HEADERS=${prefix}/${INCLUDEDIR}/hbvol
  "-D LIBRARIES=${libraries}")

# No component: all of them.
run(${configure} -B ${WORK}/all)

# One that does not exist: refused by name.
execute_process(COMMAND ${configure} -B ${WORK}/unknown -D COMPONENT=nonsense
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(status EQUAL 0 OR NOT output MATCHES "no component 'nonsense'")
  message(FATAL_ERROR "an unknown component is not refused by name:\n${output}")
endif()

# Each component, and then it is taken away: the rest must do without.
foreach(library IN LISTS libraries)
  run(${configure} -B ${WORK}/${library} -D COMPONENT=${library} "-D NEEDS=${needs_${library}}")
  run(${CMAKE_COMMAND} --build ${WORK}/${library})
  if(DEFINED prints_${library})
    run(${WORK}/${library}/consumer)
    string(STRIP "${output}" output)
    if(NOT output STREQUAL prints_${library})
      message(FATAL_ERROR "the program that uses ${library} prints '${output}', expected '${prints_${library}}'")
    endif()
  endif()
  file(GLOB files ${prefix}/${LIBDIR}/libhbvol_${library}.* ${prefix}/${LIBDIR}/cmake/hbvol/hbvol-${library}*.cmake)
  file(REMOVE_RECURSE ${files} ${prefix}/${INCLUDEDIR}/hbvol/${library})
endforeach()
file(REMOVE_RECURSE ${WORK})

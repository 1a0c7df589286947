# hbvol_link_itk(<target> <module>...): links ITK modules privately, their headers as system headers.
function(hbvol_link_itk target)
  # GDCM's package file lists each program that Debian packages apart.
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
  find_package(ITK 5.2 REQUIRED COMPONENTS ${ARGN})
  target_link_libraries(${target} PRIVATE ${ITK_LIBRARIES})
  target_include_directories(${target} SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
  # ITK's header of compiler features knows only the compiler that built it, GCC here; these stand in for it.
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    target_compile_definitions(${target} PRIVATE
      ITK_COMPILER_DETECTION_H ITK_NOEXCEPT=noexcept ITK_NULLPTR=nullptr ITK_OVERRIDE=override ITK_FINAL=final
      ITK_CONSTEXPR=constexpr ITK_DELETED_FUNCTION==delete ITK_EXTERN_TEMPLATE=extern ITK_THREAD_LOCAL=thread_local)
  endif()
endfunction()

# What libglint is installed as: a shared library that shows glint_... alone, a static one that hides the rest too, headers, a CMake
# package and a pkg-config file. Components: library (to run what links it), development, program, python. Included by src/library.
#
# Sanitized objects need their runtime in the program, so a sanitized build has no libglint to install.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
install(TARGETS glint RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
if(GLINT_SANITIZE)
  return()
endif()

set(glint_library_parts converge import reference render gpu pack bvh trace scene core)
list(TRANSFORM glint_library_parts PREPEND glint_)
set(glint_version_script ${CMAKE_SOURCE_DIR}/cmake/libglint.map)

add_library(glint_shared SHARED $<TARGET_OBJECTS:glint_library>)
target_link_libraries(glint_shared PRIVATE ${glint_library_parts} Threads::Threads ${CMAKE_DL_LIBS})
target_link_options(glint_shared PRIVATE -Wl,--version-script=${glint_version_script} -Wl,--no-undefined -Wl,--exclude-libs,ALL)
target_include_directories(glint_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
set_target_properties(glint_shared PROPERTIES
  OUTPUT_NAME glint EXPORT_NAME glint VERSION ${PROJECT_VERSION} SOVERSION 0 LINK_DEPENDS ${glint_version_script}
  LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

# One relocatable object with everything in it, whose hidden symbols are made local, so that a program may have others of the same
# name: --force-group-allocation, or the linker would drop half of them as copies of the program's own inline functions.
set(glint_static ${CMAKE_BINARY_DIR}/lib/libglint.a)
set(glint_static_archives "")
foreach(part glint_library ${glint_library_parts})
  list(APPEND glint_static_archives $<TARGET_FILE:${part}>)
endforeach()
add_custom_command(OUTPUT ${glint_static}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/lib
  COMMAND ${CMAKE_LINKER} -r --force-group-allocation -o ${CMAKE_CURRENT_BINARY_DIR}/glint.o --whole-archive ${glint_static_archives}
  COMMAND ${CMAKE_OBJCOPY} --localize-hidden ${CMAKE_CURRENT_BINARY_DIR}/glint.o
  COMMAND ${CMAKE_COMMAND} -E rm -f ${glint_static}
  COMMAND ${CMAKE_AR} qcs ${glint_static} ${CMAKE_CURRENT_BINARY_DIR}/glint.o
  DEPENDS glint_library ${glint_library_parts} COMMENT "Linking libglint.a" VERBATIM)
add_custom_target(glint_static ALL DEPENDS ${glint_static})

set(glint_package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/glint)
install(TARGETS glint_shared EXPORT glint-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
install(FILES ${glint_static} DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/include/glint DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT glint-targets NAMESPACE glint:: DESTINATION ${glint_package_folder} COMPONENT development)

get_property(glint_decoders GLOBAL PROPERTY GLINT_DECODERS)
set(glint_pc_decoders ${glint_decoders})
list(TRANSFORM glint_pc_decoders PREPEND "-l")
list(JOIN glint_pc_decoders " " glint_pc_decoders)
set(glint_config ${CMAKE_CURRENT_BINARY_DIR}/glint-config.cmake)
configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/glint-config.cmake.in ${glint_config}
  INSTALL_DESTINATION ${glint_package_folder} PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
# 0.x: any minor version may break what links it.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/glint-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${glint_config} ${CMAKE_CURRENT_BINARY_DIR}/glint-config-version.cmake DESTINATION ${glint_package_folder}
  COMPONENT development)
# Relative, so that the installed tree may be moved.
file(RELATIVE_PATH glint_pc_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(${CMAKE_SOURCE_DIR}/cmake/glint.pc.in ${CMAKE_CURRENT_BINARY_DIR}/glint.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/glint.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

# ctypes: the same for all Pythons and machines.
install(DIRECTORY ${CMAKE_SOURCE_DIR}/python/glint DESTINATION lib/python3/dist-packages COMPONENT python PATTERN __pycache__ EXCLUDE)

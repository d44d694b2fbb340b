# One static library per module. A module names the modules to its left; tests/module_dependencies checks
# the #include lines against the same order (docs/design/architecture.md).
function(glint_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;MODULES;LIBRARIES" ${ARGN})
  add_library(glint_${name} STATIC ${ARG_SOURCES})
  target_include_directories(glint_${name} PUBLIC ${CMAKE_SOURCE_DIR}/src ${CMAKE_SOURCE_DIR}/shaders)
  list(TRANSFORM ARG_MODULES PREPEND glint_)
  target_link_libraries(glint_${name} PUBLIC ${ARG_MODULES} glm::glm PRIVATE ${ARG_LIBRARIES} Threads::Threads)
endfunction()

# A gtest program; LABEL is unit (no device), gpu (runs on lavapipe, GlintLavapipe.cmake), window (the same, on a screen of its own in
# memory) or slow (run by hand).
# ENVIRONMENT takes NAME=value pairs that its tests see besides.
include(GlintLavapipe)
function(glint_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;MODULES;LIBRARIES;ENVIRONMENT" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  list(TRANSFORM ARG_MODULES PREPEND glint_)
  target_link_libraries(${name} PRIVATE ${ARG_MODULES} ${ARG_LIBRARIES} GTest::gtest_main Threads::Threads)
  target_compile_definitions(${name} PRIVATE GLINT_SOURCE_DIR="${CMAKE_SOURCE_DIR}"
                                             GLINT_BINARY_DIR="${CMAKE_BINARY_DIR}")
  # What is tested is fast, the tests need not be: 4.2 instead of 5.6 s to compile one, sanitized 6.8 instead of 11.6 s (GCC 12).
  target_compile_options(${name} PRIVATE $<IF:$<BOOL:${GLINT_SANITIZE}>,-O0,-O1>)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  set(lock "")
  if(ARG_LABEL STREQUAL "window")
    find_program(GLINT_XVFB_RUN xvfb-run DOC "xvfb-run, from the Debian packages xvfb and xauth")
    if(NOT GLINT_XVFB_RUN)
      message(FATAL_ERROR "xvfb-run not found: the tests of the window need it. Install the Debian packages xvfb and xauth, or set "
                          "GLINT_WINDOW to OFF.")
    endif()
    # CTest starts the program by way of its emulator. Two xvfb-run at once may pick the same screen. Without -noreset the server
    # begins anew when its last client has gone, and refuses whoever comes meanwhile (3 of 300 windows, one after the other).
    set_target_properties(${name} PROPERTIES
      CROSSCOMPILING_EMULATOR "${GLINT_XVFB_RUN};-a;-s;-screen 0 1280x1024x24 -noreset")
    set(lock RESOURCE_LOCK screen)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES
                       PROPERTIES LABELS "${ARG_LABEL}" TIMEOUT ${ARG_TIMEOUT} ${lock})

  if(GLINT_SANITIZE)
    target_sources(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests/gpu/sanitizer_support.cpp)
  endif()
  if(ARG_LABEL STREQUAL "unit")
    add_dependencies(unit_tests ${name})
  elseif(ARG_LABEL STREQUAL "gpu" OR ARG_LABEL STREQUAL "window")
    glint_lavapipe_environment(lavapipe)
    list(PREPEND ARG_ENVIRONMENT ${lavapipe})
  endif()
  if(ARG_ENVIRONMENT)
    # PROPERTIES above cannot carry a list; CTest knows the discovered tests as ${name}_TESTS.
    set(script ${CMAKE_CURRENT_BINARY_DIR}/${name}_environment.cmake)
    file(CONFIGURE OUTPUT ${script} @ONLY
         CONTENT [=[
if(@name@_TESTS)
  set_tests_properties(${@name@_TESTS} PROPERTIES ENVIRONMENT [==[@ARG_ENVIRONMENT@]==])
endif()
]=])
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
  endif()
endfunction()

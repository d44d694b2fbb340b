# One static library per module. A module names the modules to its left; tests/module_dependencies checks
# the #include lines against the same order (docs/architecture.md).
function(glint_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;MODULES;LIBRARIES" ${ARGN})
  add_library(glint_${name} STATIC ${ARG_SOURCES})
  target_include_directories(glint_${name} PUBLIC ${CMAKE_SOURCE_DIR}/src ${CMAKE_SOURCE_DIR}/shaders)
  list(TRANSFORM ARG_MODULES PREPEND glint_)
  target_link_libraries(glint_${name} PUBLIC ${ARG_MODULES} glm::glm PRIVATE ${ARG_LIBRARIES} Threads::Threads)
endfunction()

# A gtest program; LABEL is unit (no device), gpu (needs a Vulkan device) or slow (run by hand).
function(glint_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;MODULES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  list(TRANSFORM ARG_MODULES PREPEND glint_)
  target_link_libraries(${name} PRIVATE ${ARG_MODULES} ${ARG_LIBRARIES} GTest::gtest_main Threads::Threads)
  target_compile_definitions(${name} PRIVATE GLINT_SOURCE_DIR="${CMAKE_SOURCE_DIR}"
                                             GLINT_BINARY_DIR="${CMAKE_BINARY_DIR}")
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS "${ARG_LABEL}" TIMEOUT ${ARG_TIMEOUT})
endfunction()

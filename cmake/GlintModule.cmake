# One static library per module. APART: sources with private names that others of the module have too; GLINT_UNITY compiles them on their
# own. A module names the modules to its left; tests/module_dependencies checks the #include lines against the same order (docs/design/architecture.md).
# The modules whose loops the sanitized tests spend their time in. The others are compiled without optimization there, in half the time.
set(GLINT_HOT_MODULES core scene import trace bvh pack reference view)
# The modules that never wait for their own code, only for that of others. -O1 compiles them in 0.7 of the time.
set(GLINT_COLD_MODULES app report bench farm)
function(glint_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;APART;MODULES;LIBRARIES" ${ARGN})
  if(NOT ARG_SOURCES)
    file(GLOB_RECURSE ARG_SOURCES CONFIGURE_DEPENDS *.cpp)
  endif()
  add_library(glint_${name} STATIC ${ARG_SOURCES})
  set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_include_directories(glint_${name} PUBLIC ${CMAKE_SOURCE_DIR}/src ${CMAKE_SOURCE_DIR}/shaders)
  list(TRANSFORM ARG_MODULES PREPEND glint_)
  target_link_libraries(glint_${name} PUBLIC ${ARG_MODULES} glm::glm PRIVATE ${ARG_LIBRARIES} Threads::Threads)
  if(GLINT_SANITIZE AND NOT name IN_LIST GLINT_HOT_MODULES)
    target_compile_options(glint_${name} PRIVATE -O0)
  elseif(name IN_LIST GLINT_COLD_MODULES)
    target_compile_options(glint_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()

# An option GLINT_<OPTION> for a decoder in a module, on where its library is found: a definition of that name, 1 or 0, and the library.
# GLINT_DECODERS collects the names by which programs link glint's static library with it.
function(glint_decoder module option name library text)
  if(library AND NOT library MATCHES "NOTFOUND")
    set(found ON)
  else()
    set(found OFF)
  endif()
  option(GLINT_${option} "Read ${text}" ${found})
  target_compile_definitions(glint_${module} PRIVATE GLINT_${option}=$<BOOL:${GLINT_${option}}>)
  if(GLINT_${option})
    if(NOT found)
      message(FATAL_ERROR "GLINT_${option}: the library for ${text} is not installed")
    endif()
    target_link_libraries(glint_${module} PRIVATE ${library})
    set_property(GLOBAL APPEND PROPERTY GLINT_DECODERS ${name})
  endif()
endfunction()

# The tests need not be fast: core_tests compiles in 8.1 s with -Og, in 12.3 s with -O1 and in 7.7 s with -O0 (GCC 12, processor time). -Og
# raises false alarms about uninitialized variables. Sanitized, undefined behaviour is looked for in what is tested: without its checks a
# test compiles in 7.8 instead of 13.3 s.
function(glint_test_options name)
  target_compile_options(${name} PRIVATE "$<IF:$<BOOL:${GLINT_SANITIZE}>,-O0;-fno-sanitize=undefined,-Og>" -Wno-maybe-uninitialized)
endfunction()

# A gtest program of SOURCES, by default of all sources in its folder. LABEL names what its tests need:
#   unit       no device; in tools/test-more with sanitizers
#   optimized  no device, but the optimized build: what it looks for is not in another
#   gpu        a device: lavapipe, GlintLavapipe.cmake
#   window     the same, on a screen of its own in memory
#   assets     the models beside the source tree (tests/assets); with sanitizers, tools/test-more
#   slow       minutes on a device; tools/test-more
# CTest knows each test by its name, `ctest -R Suite.Name`, and runs it in a process of its own. With `-C Programs` it knows the programs
# besides (label "program"), each in SHARDS processes that divide its tests among them: 40 processes instead of 2,900.
# tools/test runs the programs by these labels, .ci/run those with the label "ci" too:
#   QUICK      gtest's patterns of the tests that tools/test runs; the others have the label "ci"
#   SLOWER     gtest's patterns of the tests that have the label "ci"
#   CI         all tests have the label "ci", and tools/test does not build the program
# ENVIRONMENT takes NAME=value pairs that its tests see besides.
include(GlintLavapipe)
function(glint_test name)
  cmake_parse_arguments(ARG "CI" "LABEL;TIMEOUT;SHARDS" "SOURCES;MODULES;LIBRARIES;ENVIRONMENT;QUICK;SLOWER" ${ARGN})
  if(NOT ARG_SOURCES)
    file(GLOB ARG_SOURCES CONFIGURE_DEPENDS *.cpp)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  list(TRANSFORM ARG_MODULES PREPEND glint_)
  target_link_libraries(${name} PRIVATE ${ARG_MODULES} glint_test_support ${ARG_LIBRARIES} GTest::gtest_main Threads::Threads)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests)
  glint_test_options(${name})
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
  if(ARG_CI)
    add_dependencies(ci_tests ${name})
  else()
    add_dependencies(${ARG_LABEL}_tests ${name})
  endif()
  if(ARG_LABEL MATCHES "gpu|window|slow")
    glint_lavapipe_environment(lavapipe)
    list(PREPEND ARG_ENVIRONMENT ${lavapipe})
  endif()
  glint_test_programs()
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

# Part of glint_test: the tests of its program that match `filter` as CTest's tests <name><suffix>.1, .2 ...
macro(glint_test_shards suffix label filter)
  foreach(shard RANGE 1 ${ARG_SHARDS})
    math(EXPR index "${shard} - 1")
    set(shard_environment ${ARG_ENVIRONMENT} GTEST_TOTAL_SHARDS=${ARG_SHARDS} GTEST_SHARD_INDEX=${index})
    set(test ${name}${suffix}.${shard})
    add_test(NAME ${test} CONFIGURATIONS Programs COMMAND ${name} --gtest_brief=1 --gtest_filter=${filter})
    set_tests_properties(${test} PROPERTIES LABELS "program;${label}" TIMEOUT 1800 COST ${cost} ${lock} ENVIRONMENT "${shard_environment}")
  endforeach()
endmacro()

# Part of glint_test: its program as CTest's tests.
macro(glint_test_programs)
  if(NOT ARG_SHARDS)
    set(ARG_SHARDS 1)
  endif()
  # CTest starts the costliest first: the window's programs, which run one after the other, then those worth dividing.
  set(cost 1)
  if(ARG_LABEL STREQUAL "window")
    set(cost 100)
  elseif(ARG_SHARDS GREATER 1)
    set(cost 10)
  endif()
  if(ARG_QUICK OR ARG_SLOWER)
    list(JOIN ARG_QUICK ":" quick)
    list(JOIN ARG_SLOWER ":" slower)
    if(ARG_QUICK)
      glint_test_shards("" "${ARG_LABEL}" "${quick}")
      glint_test_shards(".ci" ci "-${quick}")
    else()
      glint_test_shards("" "${ARG_LABEL}" "-${slower}")
      glint_test_shards(".ci" ci "${slower}")
    endif()
    add_test(NAME ${name}.patterns COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${name}> "-DPATTERNS=${quick}${slower}"
                                           -P ${CMAKE_SOURCE_DIR}/cmake/check_patterns.cmake)
    set_tests_properties(${name}.patterns PROPERTIES LABELS "program;${ARG_LABEL}")
  elseif(ARG_CI)
    glint_test_shards("" ci "*")
  else()
    glint_test_shards("" "${ARG_LABEL}" "*")
  endif()
endmacro()

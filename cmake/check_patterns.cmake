# Fails unless each pattern names at least one test of a gtest program, which by itself takes a pattern that names none for success:
# cmake -DPROGRAM=<program> -DPATTERNS=<pattern>:<pattern>... -P check_patterns.cmake
string(REPLACE ":" ";" patterns "${PATTERNS}")
foreach(pattern IN LISTS patterns)
  execute_process(COMMAND ${PROGRAM} --gtest_list_tests --gtest_filter=${pattern} OUTPUT_VARIABLE tests COMMAND_ERROR_IS_FATAL ANY)
  if(NOT tests MATCHES "\n  ")
    message(SEND_ERROR "no test of ${PROGRAM} is called ${pattern}")
  endif()
endforeach()

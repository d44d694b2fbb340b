# glint_commit(<target> <output.cpp>): a source of <target> that says which commit is built, written anew only when that changes, so that
# a build without changes compiles nothing. Outside a repository: what git archive wrote into commit.txt; failing that, "unknown".
if(CMAKE_SCRIPT_MODE_FILE)
  cmake_minimum_required(VERSION 3.25)
  set(commit unknown)
  file(READ ${CMAKE_CURRENT_LIST_DIR}/commit.txt archived)
  if(archived MATCHES "^[0-9a-f]+")
    string(SUBSTRING "${archived}" 0 12 commit)
  endif()
  find_program(git git)
  if(git)
    execute_process(COMMAND ${git} -C ${SOURCE} rev-parse --show-toplevel OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE
                    ERROR_QUIET)
    # Not of a repository that a tarball happens to be unpacked in.
    if(top STREQUAL SOURCE)
      execute_process(COMMAND ${git} -C ${SOURCE} describe --always --dirty --abbrev=12 OUTPUT_VARIABLE found
                      OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
      if(found MATCHES "^[-._/A-Za-z0-9]+$")
        set(commit ${found})
      endif()
    endif()
  endif()
  file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT
"#include \"app/commands.h\"

const char* glint::app::builtCommit() {
    return \"@commit@\";
}
")
  return()
endif()

set(GLINT_COMMIT_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(glint_commit target output)
  add_custom_target(${target}_commit
    COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_SOURCE_DIR} -DOUTPUT=${output} -P ${GLINT_COMMIT_SCRIPT}
    BYPRODUCTS ${output} COMMENT "" VERBATIM)
  target_sources(${target} PRIVATE ${output})
  set_source_files_properties(${output} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # it changes with every commit
  add_dependencies(${target} ${target}_commit)
endfunction()

# glint_mutants(<target> <list file> [PROBES <shader>...]): compiles the kernels of each mutant in the list, suffixed
# with its name. The target's sources find what to include, and which name takes which code, in mutant_includes.inc and
# mutant_cases.inc; those of the probes in mutant_probe_includes.inc and mutant_probe_cases.inc. PROBES: shaders of the tests
# themselves that include those in shaders/, copied beside them.
function(glint_mutants target list)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "" "PROBES")
  include(${list})
  set(mutate ${CMAKE_SOURCE_DIR}/tests/render/mutate.cmake)
  set(shaders ${CMAKE_SOURCE_DIR}/shaders)
  file(GLOB_RECURSE shader_files RELATIVE ${shaders} CONFIGURE_DEPENDS ${shaders}/*)
  list(TRANSFORM shader_files PREPEND ${shaders}/ OUTPUT_VARIABLE originals)
  set(probe_names "")
  foreach(probe IN LISTS ARG_PROBES)
    cmake_path(GET probe FILENAME name)
    list(APPEND probe_names ${name})
  endforeach()
  foreach(part "" probe_)
    set(${part}includes "")
    set(${part}cases "")
  endforeach()
  foreach(mutant IN LISTS MUTANTS)
    set(folder ${CMAKE_CURRENT_BINARY_DIR}/mutants/${mutant})
    set(copied ${shader_files} ${probe_names})
    list(TRANSFORM copied PREPEND ${folder}/)
    list(JOIN ARG_PROBES "|" extra)
    add_custom_command(
      OUTPUT ${copied}
      COMMAND ${CMAKE_COMMAND} -DSOURCE=${shaders} -DTARGET=${folder} -DMUTANT=${mutant} -DLIST=${list} "-DEXTRA=${extra}"
              -P ${mutate}
      DEPENDS ${originals} ${ARG_PROBES} ${list} ${mutate}
      COMMENT "Breaking the shaders: ${mutant}"
      VERBATIM)
    set(kernels ${${mutant}_KERNELS})
    list(TRANSFORM kernels PREPEND ${folder}/)
    list(TRANSFORM kernels APPEND .comp)
    glint_shaders(${target} SOURCES ${kernels} SUFFIX ${mutant} UNCHECKED)
    string(APPEND cases "if (name == \"${mutant}\") {\n")
    foreach(kernel IN LISTS ${mutant}_KERNELS)
      if(kernel MATCHES "_probe$")
        string(APPEND probe_includes "#include \"${kernel}_${mutant}.spv.h\"\n")
        string(APPEND probe_cases "if (name == \"${mutant}\") return ${kernel}_${mutant}_spv;\n")
      else()
        string(APPEND includes "#include \"${kernel}_${mutant}.spv.h\"\n")
        # packet_intersect is KernelCode::packetIntersect.
        string(REPLACE "packet_intersect" "packetIntersect" field ${kernel})
        string(APPEND cases "    code.${field} = ${kernel}_${mutant}_spv;\n")
      endif()
    endforeach()
    string(APPEND cases "    return code;\n}\n")
  endforeach()
  foreach(part "" probe_)
    foreach(what includes cases)
      file(CONFIGURE OUTPUT mutant_${part}${what}.inc CONTENT "${${part}${what}}" @ONLY)
    endforeach()
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()

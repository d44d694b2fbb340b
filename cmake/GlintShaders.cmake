# GLSL to SPIR-V 1.3 (Vulkan 1.1), checked by spirv-val and embedded by the assembler.
#
#   glint_shaders(<target> SOURCES a.comp ... [DEFINES NAME=VALUE ...] [SUFFIX <suffix>] [UNCHECKED])
#
# makes `#include "a_<suffix>.spv.h"` declare `const uint32_t a_<suffix>_spv[<words>]` in the sources of <target> (plain `a.spv.h`
# and `a_spv` without SUFFIX). The header and the module itself, `a_<suffix>.spv`, lie in ${CMAKE_BINARY_DIR}/shaders.
# Shaders include each other relative to themselves or to shaders/; an edit of an included file recompiles its users.
# UNCHECKED leaves spirv-val out, most of the time: for copies of checked shaders that differ in an expression (the tests' mutants).
#
# Why by the assembler: C++ reads 4 million words of an array a second, which was 50 s of processor time for all modules and their headers.
enable_language(ASM)

function(glint_find_shader_tool variable program package)
  find_program(${variable} ${program} DOC "${program}, from the Debian package ${package}")
  if(NOT ${variable})
    message(FATAL_ERROR "${program} not found: it compiles or checks the shaders. Install the Debian package "
                        "${package}, or set ${variable} to its path.")
  endif()
endfunction()

glint_find_shader_tool(GLINT_GLSLANG_VALIDATOR glslangValidator glslang-tools)
glint_find_shader_tool(GLINT_SPIRV_VAL spirv-val spirv-tools)

function(glint_shaders target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "UNCHECKED" "SUFFIX" "SOURCES;DEFINES")
  if(ARG_UNPARSED_ARGUMENTS OR NOT ARG_SOURCES)
    message(FATAL_ERROR "glint_shaders(${target}): expected SOURCES, DEFINES or SUFFIX (got '${ARG_UNPARSED_ARGUMENTS}')")
  endif()
  set(directory ${CMAKE_BINARY_DIR}/shaders)
  file(MAKE_DIRECTORY ${directory})
  list(TRANSFORM ARG_DEFINES PREPEND -D)

  foreach(source IN LISTS ARG_SOURCES)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    cmake_path(GET source STEM name)
    if(ARG_SUFFIX)
      string(APPEND name _${ARG_SUFFIX})
    endif()
    # Two rules for one output would race under Make.
    get_property(taken GLOBAL PROPERTY GLINT_SHADER_${name})
    if(taken)
      message(FATAL_ERROR "glint_shaders(${target}): ${taken} already compiles to ${name}.spv; give a SUFFIX")
    endif()
    set_property(GLOBAL PROPERTY GLINT_SHADER_${name} ${source})

    set(module ${directory}/${name}.spv)
    set(compile ${GLINT_GLSLANG_VALIDATOR} --quiet -V --target-env vulkan1.1 -I${CMAKE_SOURCE_DIR}/shaders ${ARG_DEFINES})
    set(check COMMAND ${GLINT_SPIRV_VAL} --target-env vulkan1.1 ${module})
    if(ARG_UNCHECKED)
      set(check "")
    endif()
    # The file changes with the options, and so, as a dependency, makes Make compile again when they change; Ninja would by itself.
    list(JOIN ARG_DEFINES " " options)
    file(CONFIGURE OUTPUT ${module}.h
         CONTENT "// ${source} ${options}\n#pragma once\n#include <cstdint>\n#include \"${name}.spv.inc\"\n")
    file(CONFIGURE OUTPUT ${module}.S @ONLY
         CONTENT "    .section .rodata\n    .balign 4\n    .globl @name@_spv\n    .hidden @name@_spv\n@name@_spv:\n    .incbin \"@module@\"\n\
    .section .note.GNU-stack,\"\",%progbits\n")
    set_source_files_properties(${module}.S PROPERTIES OBJECT_DEPENDS ${module}
                                COMPILE_OPTIONS $<$<C_COMPILER_ID:Clang>:-Wno-unused-command-line-argument>)
    # The declaration comes last: while the module is invalid there is none, and nothing that includes it builds.
    add_custom_command(
      OUTPUT ${module} ${module}.inc
      COMMAND ${CMAKE_COMMAND} -E rm -f ${module}.inc
      COMMAND ${compile} --depfile ${module}.d -o ${module} ${source}
      ${check}
      COMMAND ${CMAKE_COMMAND} -DMODULE=${module} -DNAME=${name}_spv -DOUTPUT=${module}.inc
              -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/declare_words.cmake
      DEPENDS ${source} ${module}.h
      DEPFILE ${module}.d
      COMMENT "Compiling shader ${name}"
      VERBATIM)
    target_sources(${target} PRIVATE ${module}.h ${module}.inc ${module}.S)
  endforeach()
  target_include_directories(${target} PRIVATE ${directory})
endfunction()

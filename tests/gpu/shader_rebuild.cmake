# Builds a small project with glint_shaders, edits a file included by an included file, and expects the shader to be compiled again, once,
# and again when a macro changes; then expects an invalid shader to stop the build.
file(REMOVE_RECURSE ${BINARY})
file(WRITE ${BINARY}/CMakeLists.txt "
cmake_minimum_required(VERSION 3.25)
project(shader_rebuild LANGUAGES CXX)
list(APPEND CMAKE_MODULE_PATH ${SOURCE}/cmake)
include(GlintShaders)
add_executable(program main.cpp)
set(VALUE 7 CACHE STRING \"\")
glint_shaders(program SOURCES outer.comp DEFINES GLINT_VALUE=\${VALUE}u SUFFIX seven)
")
file(WRITE ${BINARY}/main.cpp "
#include \"outer_seven.spv.h\"
int main() { return outer_seven_spv[0] == 0x07230203u ? 0 : 1; }  // SPIR-V's magic number
")
file(WRITE ${BINARY}/outer.comp "#version 450
#extension GL_GOOGLE_include_directive : require
#include \"middle.glsl\"
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, std430) buffer Values { uint values[]; };
void main() { values[gl_GlobalInvocationID.x] = middle() + GLINT_VALUE; }
")
# Found next to the shader, and by its path under shaders/.
file(MAKE_DIRECTORY ${BINARY}/shaders/deep)
file(WRITE ${BINARY}/middle.glsl "#include \"deep/inner.glsl\"\nuint middle() { return inner(); }\n")

function(write_inner constant)
  execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 0.1)  # a later time of modification, whatever the clock's grain
  file(WRITE ${BINARY}/shaders/deep/inner.glsl "uint inner() { return ${constant}; }\n")
endfunction()

# `expected` is COMPILES, NOTHING (the shader is up to date) or FAILS.
function(build folder expected)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${folder} RESULT_VARIABLE result OUTPUT_VARIABLE log ERROR_VARIABLE log)
  if(NOT result EQUAL 0)
    set(outcome FAILS)
  elseif(log MATCHES "Compiling shader")
    set(outcome COMPILES)
  else()
    set(outcome NOTHING)
  endif()
  if(NOT outcome STREQUAL expected)
    message(FATAL_ERROR "${folder}: expected ${expected}, got ${outcome}:\n${log}")
  endif()
endfunction()

# The constant reached both the module, as a little-endian word, and the program that embeds it.
function(expect_constant folder hex)
  string(REGEX REPLACE "(..)(..)(..)(..)" "\\4\\3\\2\\1" word ${hex})
  file(READ ${folder}/shaders/outer_seven.spv module HEX)
  file(READ ${folder}/program program HEX)
  string(FIND "${program}" "${module}" embedded)
  if(NOT module MATCHES ${word} OR embedded EQUAL -1)
    message(FATAL_ERROR "${folder}: the edit of an included file did not reach the outputs")
  endif()
endfunction()

find_program(refuses false REQUIRED)
set(folder ${BINARY}/build)
write_inner(1000u)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${BINARY} -B ${folder} -G "${GENERATOR}" -DCMAKE_CXX_COMPILER=${CXX}
                RESULT_VARIABLE result OUTPUT_VARIABLE log ERROR_VARIABLE log)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "configure failed:\n${log}")
endif()
build(${folder} COMPILES)
expect_constant(${folder} 000003e8)
build(${folder} NOTHING)

write_inner(2000u)
build(${folder} COMPILES)
expect_constant(${folder} 000007d0)
build(${folder} NOTHING)

execute_process(COMMAND ${CMAKE_COMMAND} ${folder} -DVALUE=291 OUTPUT_QUIET)
build(${folder} COMPILES)
expect_constant(${folder} 00000123)
build(${folder} NOTHING)

write_inner(undeclared)
build(${folder} FAILS)
build(${folder} FAILS)  # not only the first time
write_inner(3000u)
# spirv-val's verdict counts. By its path, since the word alone is CMake's for a program that was not found.
execute_process(COMMAND ${CMAKE_COMMAND} ${folder} -DGLINT_SPIRV_VAL=${refuses} RESULT_VARIABLE result OUTPUT_QUIET)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "configure failed")
endif()
build(${folder} FAILS)
build(${folder} FAILS)

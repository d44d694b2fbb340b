# What a list of mutants includes first. A mutant is a copy of shaders/ with one replacement; the pattern must occur exactly once. The kernels
# named last are compiled from the copy, and the renderer takes all others as they are. Kernels named *_probe are copies of the probes.
set(MUTANTS "")

macro(mutant name file pattern replacement)
  list(APPEND MUTANTS ${name})
  set(${name}_FILE "${file}")
  set(${name}_PATTERN "${pattern}")
  set(${name}_REPLACEMENT "${replacement}")
  set(${name}_KERNELS ${ARGN})
endmacro()

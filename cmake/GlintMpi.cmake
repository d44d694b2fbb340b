# GLINT_MPI: whether `mpirun glint render` draws one picture with all its processes. On where MPI is found (Debian packages libopenmpi-dev
# and openmpi-bin, or libmpich-dev and mpich); the program is the same without it.
find_package(MPI QUIET COMPONENTS CXX)
if(NOT MPI_CXX_FOUND)
  option(GLINT_MPI "Build glint-mpi.so, for mpirun" OFF)
  if(GLINT_MPI)
    message(FATAL_ERROR "GLINT_MPI is ON, but MPI is missing (Debian package libopenmpi-dev): install it, or set GLINT_MPI to OFF")
  endif()
  message(STATUS "the module for mpirun is left out: MPI not found")
else()
  option(GLINT_MPI "Build glint-mpi.so, for mpirun" ON)
endif()

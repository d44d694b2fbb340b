#include <dlfcn.h>

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "core/error.h"
#include "farm/transport.h"

namespace glint::farm {

namespace {

namespace fs = std::filesystem;

std::optional<int> numberIn(const char* variable) {
    const char* const text = std::getenv(variable);
    int number = 0;
    if (!text || std::from_chars(text, text + std::strlen(text), number).ec != std::errc())
        return std::nullopt;
    return number;
}

[[noreturn]] void failed(const std::string& what) {
    throw Error(ErrorKind::Failed, "MPI: " + what);
}

// Beside the program, as it was built or installed; empty if it is not there.
fs::path moduleFile() {
    std::error_code code;
    const fs::path folder = fs::read_symlink("/proc/self/exe", code).parent_path();
    for (const char* const place : {"../lib/glint", GLINT_MPI_FOLDER}) {
        fs::path file = folder / place / "glint-mpi.so";
        if (fs::exists(file, code)) return file;
    }
    return {};
}

std::unique_ptr<Transport> loadModule() {
    const fs::path file = moduleFile();
    if (file.empty())
        failed(
            "started by mpirun, but this glint has no glint-mpi.so (Debian package glint-mpi; built where "
            "MPI is found); --part needs no MPI");
    // Global: Open MPI's own plugins look for its symbols there.
    void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
    if (!library) failed(::dlerror());
    // The number is the version of Transport.
    const auto entry = reinterpret_cast<Transport* (*)()>(::dlsym(library, "glint_mpi_transport_3"));
    if (!entry) failed(file.string() + " belongs to another version of glint");
    return std::unique_ptr<Transport>(entry());
}

// Skips Open MPI's search for networks if all ranks are on one machine: it is ready after 0.06 s instead of
// 0.26 s (4.1.4), and 5.0.7 prints no warnings about networks it cannot reach. The user's own settings win.
void skipNetworks() {
    const auto here = numberIn("OMPI_COMM_WORLD_LOCAL_SIZE");
    if (!here || here != numberIn("OMPI_COMM_WORLD_SIZE")) return;
    ::setenv("OMPI_MCA_pml", "ob1", 0);
    ::setenv("OMPI_MCA_btl", "^tcp", 0);
}

std::unique_ptr<Transport> running;  // from openMpi() on

}  // namespace

std::optional<int> launchedRank() {
    // Open MPI; MPICH, Intel MPI and others with Hydra, and srun --mpi=pmi2; srun --mpi=pmix.
    constexpr std::pair<const char*, const char*> kVariables[] = {
        {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
        {"PMI_RANK", "PMI_SIZE"},
        {"PMIX_RANK", "SLURM_STEP_NUM_TASKS"}};
    for (const auto& [rank, size] : kVariables) {
        const auto number = numberIn(rank), of = numberIn(size);
        if (number && of && *of > 1) return number;
    }
    return std::nullopt;
}

bool hasMpiModule() {
    return !moduleFile().empty();
}

Transport& openMpi() {
    skipNetworks();
    running = loadModule();
    return *running;
}

void finishMpi() {
    std::exchange(running, nullptr)->finish();
}

void abortMpi(int exitCode) {
    if (running) running->abort(exitCode);
}

}  // namespace glint::farm

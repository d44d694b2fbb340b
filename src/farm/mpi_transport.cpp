#include <dlfcn.h>

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

#include "core/error.h"
#include "farm/transport.h"
#include "mpi/module.h"

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

const mpi::Module& loadModule() {
    const fs::path file = moduleFile();
    if (file.empty())
        failed(
            "started by mpirun, but this glint has no glint-mpi.so (Debian package glint-mpi; built where "
            "MPI is "
            "found); --part needs no MPI");
    // Global: Open MPI's own plugins look for its symbols there.
    void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
    if (!library) failed(::dlerror());
    using Entry = const mpi::Module* (*)();
    const auto entry = reinterpret_cast<Entry>(::dlsym(library, mpi::kEntry));
    const mpi::Module* const module = entry ? entry() : nullptr;
    if (!module || module->interface != mpi::kInterface)
        failed(file.string() + " belongs to another version of glint");
    return *module;
}

// Skips Open MPI's search for networks if all ranks are on one machine: it is ready after 0.06 s instead of
// 0.26 s (4.1.4), and 5.0.7 prints no warnings about networks it cannot reach. The user's own settings win.
void skipNetworks() {
    const auto here = numberIn("OMPI_COMM_WORLD_LOCAL_SIZE");
    if (!here || here != numberIn("OMPI_COMM_WORLD_SIZE")) return;
    ::setenv("OMPI_MCA_pml", "ob1", 0);
    ::setenv("OMPI_MCA_btl", "^tcp", 0);
}

const mpi::Module* running = nullptr;  // between begin() and end()

class MpiTransport : public Transport {
  public:
    MpiTransport() : module_(loadModule()) {
        skipNetworks();
        if (const char* const fault = module_.begin(&rank_, &size_)) failed(fault);
        running = &module_;
    }
    int rank() const override { return rank_; }
    int size() const override { return size_; }
    void send(int to, const Bytes& bytes) override {
        if (const char* const fault = module_.send(to, bytes.data(), bytes.size())) failed(fault);
    }
    std::optional<Message> receive() override {
        Message message;
        const int64_t size = module_.next(&message.from);
        if (size < 0) return std::nullopt;
        message.bytes.resize(static_cast<size_t>(size));
        module_.take(message.bytes.data());
        return message;
    }
    bool sending() override { return module_.sending() != 0; }
    void finish() override {
        module_.end();
        running = nullptr;
    }

  private:
    const mpi::Module& module_;
    int rank_ = 0, size_ = 1;
};

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

std::unique_ptr<Transport> openMpi() {
    return std::make_unique<MpiTransport>();
}

void abortMpi(int exitCode) {
    if (running) running->abort(exitCode);
}

}  // namespace glint::farm

// Parts and checkpoints. No mutation hits on the right hash of a record, so each input is read once as it is
// and once with the hashes made right.
#include <cstring>
#include <optional>

#include "core/content_hash.h"
#include "farm/merge.h"
#include "farm/unit_file.h"
#include "target.h"

namespace {

using namespace glint;

constexpr size_t kSignature = 16, kHead = 8, kHash = 8;

std::vector<uint8_t> withHashes(fuzz::Input input) {
    std::vector<uint8_t> bytes(input.begin(), input.end());
    for (size_t at = kSignature; at + kHead + kHash <= bytes.size();) {
        uint64_t size = 0;
        std::memcpy(&size, &bytes[at], sizeof(size));
        if (size > bytes.size() - at - kHead - kHash) break;
        const uint64_t hash = contentHash(fuzz::Input(&bytes[at], kHead + size));
        std::memcpy(&bytes[at + kHead + size], &hash, kHash);
        at += kHead + size + kHash;
    }
    return bytes;
}

void read(fuzz::Input input) {
    const auto path = fuzz::write("input.part", input);
    fuzz::expectAnswer(ErrorKind::Failed, [&] {
        farm::forEachUnit(
            path, [](const auto&) {}, [](const auto&) {});
    });
    // What merge asks before it takes memory, with less to give.
    std::optional<farm::Assembly> assembly;
    const auto room = [&](const farm::UnitHeader& header, uint64_t) {
        const Region& r = header.region;
        if (static_cast<uint64_t>(r.width()) * static_cast<uint64_t>(r.height()) * (1 + header.aovs.size()) >
            (1u << 20))
            throw Error(ErrorKind::Failed, "too large");
        assembly.emplace(header.region, header.aovs);
    };
    const auto add = [&](const farm::UnitResult& result) {
        assembly->add(result);
        assembly->take();
    };
    fuzz::expectAnswer(ErrorKind::Failed, [&] { farm::mergeParts({path}, room, add); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    read({data, size});
    read(withHashes({data, size}));
    return 0;
}

// What ranks say to each other: a word in a byte, and what belongs to it. Internal to farm/ranks.
#pragma once

#include <memory>
#include <string>

#include "core/error.h"
#include "farm/bytes.h"
#include "farm/scene_stream.h"

namespace glint::farm {

enum class Word : uint8_t {
    // To rank 0.
    Here = 1,  // process, host
    Ready,     // the scene is read: header of the units
    Want,      // a unit
    Result,    // unit, its bytes
    Missing,   // pieces of the scene from this one on
    Failed,    // kind of error, text
    Bye,       // answers Finish
    // From rank 0.
    Work,    // unit
    Drop,    // unit
    Finish,  // the picture is done; who is still there?
    End,     // exit code, whether all leave together
    // Both ways, or down the tree.
    Beat,  // from rank 0: how many pieces of the scene there are
    Piece  // its index, bytes
};

inline Bytes sealed(ByteWriter& out) {
    return std::make_shared<const std::vector<uint8_t>>(out.take());
}

inline Bytes message(Word word) {
    ByteWriter out;
    out.put(static_cast<uint8_t>(word));
    return sealed(out);
}

inline Bytes message(Word word, int32_t number) {
    ByteWriter out;
    out.put(static_cast<uint8_t>(word));
    out.put(number);
    return sealed(out);
}

inline Bytes message(Word word, const std::vector<uint8_t>& bytes) {
    ByteWriter out;
    out.put(static_cast<uint8_t>(word));
    out.raw(bytes.data(), bytes.size());
    return sealed(out);
}

inline Bytes message(Word word, int32_t number, const std::vector<uint8_t>& bytes) {
    ByteWriter out;
    out.put(static_cast<uint8_t>(word));
    out.put(number);
    out.raw(bytes.data(), bytes.size());
    return sealed(out);
}

inline Bytes pieceMessage(uint32_t index, const std::vector<uint8_t>& bytes) {
    return message(Word::Piece, static_cast<int32_t>(index), bytes);
}

inline Bytes hereMessage(const std::string& process, const std::string& host) {
    ByteWriter out;
    out.put(static_cast<uint8_t>(Word::Here));
    out.put(process);
    out.put(host);
    return sealed(out);
}

inline Bytes failedMessage(const Error& error) {
    ByteWriter out;
    out.put(static_cast<uint8_t>(Word::Failed));
    out.put(static_cast<uint32_t>(error.kind()));
    out.put(std::string(error.what()));
    return sealed(out);
}

inline Bytes endMessage(int32_t exitCode, bool together) {
    ByteWriter out;
    out.put(static_cast<uint8_t>(Word::End));
    out.put(exitCode);
    out.put(static_cast<uint8_t>(together));
    return sealed(out);
}

}  // namespace glint::farm

#include "farm/ranks.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include "core/interrupt.h"
#include "core/stopwatch.h"
#include "farm/bytes.h"

namespace glint::farm {

namespace {

enum class Word : uint8_t {
    // From rank 0, or down the tree.
    Piece = 1,  // of the scene: bytes
    Work,       // unit
    End,
    // To rank 0.
    Ready,   // header; the rank has no unit
    Result,  // the unit's bytes; the rank has no unit
    Failed   // kind of error, text
};

Bytes message(Word word, const Bytes& bytes = {}) {
    Bytes message = {static_cast<uint8_t>(word)};
    message.insert(message.end(), bytes.begin(), bytes.end());
    return message;
}

Bytes workMessage(int unit) {
    ByteWriter out;
    out(unit);
    return message(Word::Work, out.take());
}

std::string nameOfRank(int rank) {
    std::array<char, 256> host{};
    const bool known = ::gethostname(host.data(), host.size() - 1) == 0;
    return "rank " + std::to_string(rank) + (known ? " (" + std::string(host.data()) + ")" : "");
}

void sendToChildren(Transport& transport, const Bytes& piece) {
    for (const int child : {2 * transport.rank() + 1, 2 * transport.rank() + 2})
        if (child < transport.size()) transport.send(child, piece);
}

// Sleeps between two looks for messages, up to 2 ms: they come in bursts, and polling takes processor time
// from the ranks that render.
class Pause {
  public:
    void restart() { time_ = kShortest; }
    void rest() {
        std::this_thread::sleep_for(time_);
        time_ = std::min(2 * time_, kLongest);
    }

  private:
    static constexpr std::chrono::microseconds kShortest{10}, kLongest{2000};
    std::chrono::microseconds time_ = kShortest;
};

}  // namespace

FirstRank::FirstRank(Transport& transport)
    : transport_(transport),
      files_(std::make_shared<RecordedFiles>(fileSystem(), [this](const Bytes& piece) { publish(piece); })) {}

FirstRank::~FirstRank() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
}

// MPI moves large messages only during calls, so this waits until the children have them.
void FirstRank::publish(const Bytes& piece) {
    sendToChildren(transport_, message(Word::Piece, piece));
    Pause pause;
    while (!failed_ && !interrupted() && transport_.sending())
        if (!receive()) pause.rest();
}

void FirstRank::begin(const UnitHeader& header, int window, Take take) {
    header_ = header;
    window_ = std::max(1, window);
    take_ = std::move(take);
    there_.assign(static_cast<size_t>(header.parts) + 1, false);
    for (const auto& [from, theirs] : early_) judge(from, theirs);
    handOut();
    thread_ = std::thread([this] { serve(); });
}

void FirstRank::serve() {
    for (Pause pause; !stopping_;) {
        bool received = false;
        {
            const std::lock_guard lock(mutex_);
            received = receive();
        }
        if (received)
            pause.restart();
        else
            pause.rest();
    }
}

bool FirstRank::receive() {
    try {
        const auto message = transport_.receive();
        if (!message) return false;
        ByteReader in(message->bytes);
        handle(message->from, in);
        handOut();
    } catch (const Error& error) {
        fail(error);
    } catch (const std::exception& error) {
        fail(Error(ErrorKind::Failed, error.what()));
    }
    return true;
}

void FirstRank::fail(const Error& error) {
    if (!error_) error_ = error;
    failed_ = true;
}

void FirstRank::handle(int from, ByteReader& in) {
    const std::string name = "rank " + std::to_string(from);
    Word word{};
    in(word);
    switch (word) {
        case Word::Ready: {
            ++ready_;
            UnitHeader theirs = decodeHeader(in.left(), name);
            if (header_)
                judge(from, theirs);
            else
                early_.emplace_back(from, std::move(theirs));
            idle_.push_back(from);
            break;
        }
        case Word::Result:
            accept(decodeUnit(in.left(), *header_, name));
            idle_.push_back(from);
            break;
        case Word::Failed: {
            ErrorKind kind{};
            std::string text;
            in(kind, text);
            fail(Error(kind, text));
            break;
        }
        default:
            throw Error(ErrorKind::Failed, name + " sent an unknown message");
    }
}

void FirstRank::judge(int from, const UnitHeader& header) {
    const std::string other = difference(header.identity, header_->identity);
    if (!other.empty())
        fail(Error(ErrorKind::Failed,
                   "rank " + std::to_string(from) + " would render another image: " + other));
}

void FirstRank::accept(const UnitResult& result) {
    take_(result);
    there_[static_cast<size_t>(result.part)] = true;
    while (firstMissing_ <= header_->parts && there_[static_cast<size_t>(firstMissing_)]) ++firstMissing_;
    ++done_;
}

std::optional<int> FirstRank::take() {
    if (next_ > header_->parts || next_ >= firstMissing_ + window_) return std::nullopt;
    return next_++;
}

void FirstRank::handOut() {
    while (header_ && !idle_.empty() && !error_) {
        const auto unit = take();
        if (!unit) break;
        transport_.send(idle_.front(), workMessage(*unit));
        idle_.pop_front();
    }
}

std::optional<int> FirstRank::next(const std::function<void()>& waiting) {
    Pause pause;
    for (Stopwatch watch; !interrupted(); pause.rest()) {
        {
            const std::lock_guard lock(mutex_);
            if (error_) throw Error(*error_);
            if (done_ == header_->parts) break;
            if (const auto unit = take()) return unit;
        }
        if (watch.seconds() < 0.05) continue;
        watch.restart();
        waiting();
    }
    return std::nullopt;
}

void FirstRank::put(const UnitResult& result) {
    const std::lock_guard lock(mutex_);
    accept(result);
    handOut();
}

void FirstRank::end() {
    for (Pause pause; !interrupted(); pause.rest()) {
        const std::lock_guard lock(mutex_);
        if (error_ || ready_ == transport_.size() - 1) break;
    }
    const std::lock_guard lock(mutex_);
    for (int rank = 1; rank < transport_.size(); ++rank) transport_.send(rank, message(Word::End));
}

OtherRank::OtherRank(Transport& transport)
    : transport_(transport), files_(std::make_shared<ReplayedFiles>([this] { return nextPiece(); })) {}

Bytes OtherRank::nextPiece() {
    for (Pause pause; !interrupted(); pause.rest()) {
        const auto message = transport_.receive();
        if (!message) continue;
        ended_ = static_cast<Word>(message->bytes.at(0)) != Word::Piece;
        if (ended_) break;
        sendToChildren(transport_, message->bytes);
        while (transport_.sending() && !interrupted()) pause.rest();
        return {message->bytes.begin() + 1, message->bytes.end()};
    }
    throw Error(ErrorKind::Interrupted, "interrupted while rank 0 read the scene");
}

void OtherRank::begin(const UnitHeader& header) {
    transport_.send(0, message(Word::Ready, encodeHeader(header)));
}

std::optional<int> OtherRank::next() {
    for (Pause pause; !interrupted(); pause.rest()) {
        const auto message = transport_.receive();
        if (!message) continue;
        ByteReader in(message->bytes);
        Word word{};
        int unit = 0;
        in(word);
        if (word == Word::Work) {
            in(unit);
            return unit;
        }
        if (word == Word::End) break;
    }
    return std::nullopt;
}

void OtherRank::put(const UnitResult& result) {
    transport_.send(0, message(Word::Result, encodeUnit(result)));
}

void OtherRank::fail(const Error& error) {
    ByteWriter out;
    out(error.kind(), nameOfRank(transport_.rank()) + ": " + error.what());
    transport_.send(0, message(Word::Failed, out.take()));
    while (!ended_ && next()) {
    }
}

}  // namespace glint::farm

#include "farm/ranks.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "core/interrupt.h"
#include "farm/process_name.h"
#include "farm/rank_messages.h"

namespace glint::farm {

namespace {

constexpr double kBeats = 10;
constexpr double kLook = 0.1;  // seconds between two looks whether processes of this machine have ended
constexpr auto kWait = std::chrono::milliseconds(50);  // and whether somebody has pressed Ctrl-C

}  // namespace

FirstRank::FirstRank(Post& post, double lease)
    : post_(post),
      lease_(lease),
      files_(
          std::make_shared<RecordedFiles>(fileSystem(), [this](Bytes piece) { publish(std::move(piece)); })),
      peers_(static_cast<size_t>(post.size())) {
    for (int rank = 1; rank <= std::min(2, post.size() - 1); ++rank)
        peers_[static_cast<size_t>(rank)].direct = true;
    post_.start(*this);
}

FirstRank::~FirstRank() {
    post_.leave(false);
}

std::string FirstRank::called(int rank) const {
    const std::string& host = peers_[static_cast<size_t>(rank)].host;
    return "rank " + std::to_string(rank) + (host.empty() ? "" : " (" + host + ")");
}

void FirstRank::checkLocked() const {
    if (error_) throw Error(*error_);
}

void FirstRank::check() {
    const std::lock_guard lock(mutex_);
    checkLocked();
}

void FirstRank::publish(Bytes piece) {
    const std::lock_guard lock(mutex_);
    const Bytes message = pieceMessage(static_cast<uint32_t>(pieces_.size()), *piece);
    pieces_.push_back(message);
    for (size_t rank = 1; rank < peers_.size(); ++rank)
        if (peers_[rank].direct && !peers_[rank].lost) post_.send(static_cast<int>(rank), message);
}

void FirstRank::begin(const UnitHeader& header, int window) {
    const std::lock_guard lock(mutex_);
    checkLocked();
    header_ = header;
    handOut_.emplace(header.parts, window);
    for (size_t rank = 1; rank < peers_.size(); ++rank) judge(static_cast<int>(rank));
    checkLocked();
    serve();
}

std::optional<int> FirstRank::next(const std::function<void()>& waiting) {
    std::unique_lock lock(mutex_);
    while (!interrupted()) {
        checkLocked();
        if (handOut_->complete()) break;
        if (const auto unit = handOut_->next(0, now())) return unit;
        changed_.wait_for(lock, kWait);
        lock.unlock();
        waiting();
        lock.lock();
    }
    return std::nullopt;
}

bool FirstRank::isDone(int unit) {
    const std::lock_guard lock(mutex_);
    return error_ || handOut_->isDone(unit);
}

// The unit's other holders may leave it.
void FirstRank::finished(int unit, int by) {
    for (size_t rank = 1; rank < peers_.size(); ++rank)
        if (static_cast<int>(rank) != by && !peers_[rank].lost &&
            handOut_->holds(unit, static_cast<int>(rank)))
            post_.send(static_cast<int>(rank), message(Word::Drop, unit));
}

void FirstRank::put(UnitResult result) {
    const std::lock_guard lock(mutex_);
    const int unit = result.unit.part;
    if (handOut_->isDone(unit)) return;
    finished(unit, 0);
    handOut_->done(unit, 0, now());
    results_.push_back({std::move(result), {}});
    changed_.notify_all();
}

std::optional<UnitResult> FirstRank::take() {
    std::unique_lock lock(mutex_);
    while (results_.empty()) {
        checkLocked();
        if (taken_ == header_->parts || interrupted()) return std::nullopt;
        changed_.wait_for(lock, kWait);
    }
    Arrived arrived = std::move(results_.front());
    results_.pop_front();
    ++taken_;
    lock.unlock();
    if (arrived.own) return std::move(*arrived.own);
    return decodeUnit(arrived.bytes, *header_, "a unit of another rank");
}

void FirstRank::settle(int unit) {
    const std::lock_guard lock(mutex_);
    handOut_->settle(unit);
    serve();
    changed_.notify_all();
}

double FirstRank::share() {
    const std::lock_guard lock(mutex_);
    return handOut_ ? static_cast<double>(handOut_->doneCount()) / header_->parts : 0;
}

void FirstRank::fail(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = error;
    changed_.notify_all();
}

std::vector<std::string> FirstRank::lost() {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    for (size_t rank = 1; rank < peers_.size(); ++rank)
        if (peers_[rank].lost) names.push_back(called(static_cast<int>(rank)));
    return names;
}

bool FirstRank::end(int exitCode) {
    bool together = exitCode == 0;
    {
        std::unique_lock lock(mutex_);
        // One that has ended unnoticed would be waited for where all leave together.
        for (size_t rank = 1; together && rank < peers_.size(); ++rank)
            if (!peers_[rank].lost) post_.send(static_cast<int>(rank), message(Word::Finish));
        changed_.wait(lock, [&] {
            return !together || std::all_of(peers_.begin() + 1, peers_.end(),
                                            [](const Peer& peer) { return peer.bye || peer.lost; });
        });
        for (size_t rank = 1; rank < peers_.size(); ++rank) together = together && !peers_[rank].lost;
        for (size_t rank = 1; rank < peers_.size(); ++rank)
            if (!peers_[rank].lost) post_.send(static_cast<int>(rank), endMessage(exitCode, together));
    }
    post_.leave(together);
    return together;
}

void FirstRank::serve() {
    if (!handOut_ || error_) return;
    for (size_t rank = 1; rank < peers_.size(); ++rank) {
        Peer& peer = peers_[rank];
        if (!peer.wants || peer.lost) continue;
        const auto unit = handOut_->next(static_cast<int>(rank), now());
        if (!unit) continue;  // another may get one: what it lacks may be that it must not help itself
        peer.wants = false;
        post_.send(static_cast<int>(rank), message(Word::Work, *unit));
    }
}

void FirstRank::greet(int from, ByteReader& in) {
    peers_[static_cast<size_t>(from)].header = decodeHeader(in.next(in.left()), called(from));
    judge(from);
    const bool all = std::all_of(peers_.begin() + 1, peers_.end(),
                                 [](const Peer& peer) { return peer.header.has_value(); });
    if (all) pieces_.clear();  // nobody will ask for them
}

// Either may be the first to have read the scene.
void FirstRank::judge(int rank) {
    const auto& theirs = peers_[static_cast<size_t>(rank)].header;
    if (!header_ || !theirs || error_) return;
    const std::string other = difference(theirs->identity, header_->identity);
    if (!other.empty())
        error_.emplace(ErrorKind::Failed, called(rank) + " would draw another picture: " + other);
}

void FirstRank::accept(int from, ByteReader& in) {
    const int unit = in.get<int32_t>();
    if (!header_ || unit < 1 || unit > header_->parts || handOut_->isDone(unit)) return;
    const auto bytes = in.next(in.left());
    finished(unit, from);
    handOut_->done(unit, from, now());
    results_.push_back({std::nullopt, {bytes.begin(), bytes.end()}});
}

void FirstRank::handle(int from, ByteReader& in) {
    Peer& peer = peers_[static_cast<size_t>(from)];
    switch (static_cast<Word>(in.get<uint8_t>())) {
        case Word::Here:
            peer.process = in.text();
            peer.host = in.text();
            break;
        case Word::Ready:
            greet(from, in);
            break;
        case Word::Want:
            peer.wants = true;
            break;
        case Word::Result:
            accept(from, in);
            break;
        case Word::Missing: {
            peer.direct = true;
            for (size_t i = in.get<uint32_t>(); i < pieces_.size(); ++i) post_.send(from, pieces_[i]);
            break;
        }
        case Word::Failed: {
            const auto kind = static_cast<ErrorKind>(in.get<uint32_t>());
            if (!error_) error_.emplace(kind, called(from) + ": " + in.text());
            break;
        }
        case Word::Bye:
            peer.bye = true;
            break;
        default:
            break;
    }
}

void FirstRank::receive(int from, std::vector<uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    Peer& peer = peers_[static_cast<size_t>(from)];
    peer.silent = 0;
    peer.lost = false;
    try {
        ByteReader in(bytes);
        handle(from, in);
    } catch (const std::exception& error) {
        if (!error_) error_.emplace(ErrorKind::Failed, called(from) + " sent nonsense: " + error.what());
    }
    serve();
    changed_.notify_all();
}

void FirstRank::look(double passed) {
    sinceLook_ += passed;
    const bool close = sinceLook_ >= kLook;
    if (close) sinceLook_ = 0;
    for (size_t rank = 1; rank < peers_.size(); ++rank) {
        Peer& peer = peers_[rank];
        peer.silent += passed;
        if (peer.lost || (peer.silent < lease_ && !(close && hasEnded(peer.process)))) continue;
        peer.lost = true;
        if (handOut_) handOut_->lose(static_cast<int>(rank));
        changed_.notify_all();
    }
}

void FirstRank::tick(double passed) {
    files_->flush();  // what others may wait for, though no file was read
    const std::lock_guard lock(mutex_);
    look(passed);
    sinceBeat_ += passed;
    if (sinceBeat_ >= lease_ / kBeats) {
        sinceBeat_ = 0;
        const Bytes beat = message(Word::Beat, static_cast<int32_t>(pieces_.size()));
        for (size_t rank = 1; rank < peers_.size(); ++rank)
            if (!peers_[rank].lost) post_.send(static_cast<int>(rank), beat);
    }
    serve();
}

OtherRank::OtherRank(Post& post, double lease)
    : post_(post), lease_(lease), files_(std::make_shared<ReplayedFiles>([this] { return nextPiece(); })) {
    std::array<char, 256> host{};
    if (::gethostname(host.data(), host.size() - 1) != 0) host = {'?'};
    post_.send(0, hereMessage(nameOfThisProcess(), host.data()));
    post_.start(*this);
}

OtherRank::~OtherRank() {
    post_.leave(false);
}

void OtherRank::checkLocked() const {
    if (finished_ || ended_ || gone_) throw Ended();
}

Bytes OtherRank::nextPiece() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !pieces_.empty() || finished_ || ended_ || gone_; });
    checkLocked();
    Bytes piece = std::move(pieces_.front());
    pieces_.pop_front();
    return piece;
}

void OtherRank::begin(const UnitHeader& header) {
    const std::lock_guard lock(mutex_);
    checkLocked();
    post_.send(0, message(Word::Ready, encodeHeader(header)));
}

std::optional<int> OtherRank::next() {
    std::unique_lock lock(mutex_);
    drawing_ = 0;
    post_.send(0, message(Word::Want));
    while (!unit_) {
        if (finished_ || interrupted()) return std::nullopt;
        checkLocked();
        changed_.wait_for(lock, kWait);
    }
    drawing_ = *unit_;
    dropped_ = false;
    unit_.reset();
    return drawing_;
}

bool OtherRank::isDone(int unit) {
    const std::lock_guard lock(mutex_);
    return finished_ || ended_ || gone_ || (dropped_ && drawing_ == unit);
}

void OtherRank::put(const UnitResult& result) {
    post_.send(0, message(Word::Result, result.unit.part, encodeUnit(result)));
}

void OtherRank::fail(const Error& error) {
    post_.send(0, failedMessage(error));
}

int OtherRank::end() {
    bool together = false;
    int code = 0;
    {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return ended_ || gone_; });
        together = ended_ && together_;
        code = ended_ ? exitCode_ : 1;
    }
    post_.leave(together);
    return code;
}

void OtherRank::receivePiece(const Bytes& piece) {
    ByteReader in(*piece);
    in.get<uint8_t>();
    const auto index = in.get<uint32_t>();
    if (index != received_) return;  // it has come another way already, or will come after what is missing
    ++received_;
    published_ = std::max(published_, received_);
    missing_ = 0;
    for (const int child : {2 * post_.rank() + 1, 2 * post_.rank() + 2})
        if (child < post_.size()) post_.send(child, piece);
    const auto bytes = in.next(in.left());
    pieces_.push_back(std::make_shared<const std::vector<uint8_t>>(bytes.begin(), bytes.end()));
}

void OtherRank::handle(const Bytes& bytes) {
    ByteReader in(*bytes);
    switch (static_cast<Word>(in.get<uint8_t>())) {
        case Word::Piece:
            receivePiece(bytes);
            break;
        case Word::Beat:
            published_ = static_cast<uint32_t>(in.get<int32_t>());
            break;
        case Word::Work:
            unit_ = in.get<int32_t>();
            break;
        case Word::Drop:
            dropped_ = dropped_ || drawing_ == in.get<int32_t>();
            break;
        case Word::Finish:
            finished_ = true;
            post_.send(0, message(Word::Bye));
            break;
        case Word::End:
            ended_ = true;
            exitCode_ = in.get<int32_t>();
            together_ = in.get<uint8_t>() != 0;
            break;
        default:
            break;
    }
}

void OtherRank::receive(int from, std::vector<uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    if (from == 0) silent_ = 0;
    handle(std::make_shared<const std::vector<uint8_t>>(std::move(bytes)));
    changed_.notify_all();
}

void OtherRank::tick(double passed) {
    const std::lock_guard lock(mutex_);
    silent_ += passed;
    // Twice: rank 0 is not replaced, so it is given up later than others.
    if (silent_ >= 2 * lease_ && !ended_) {
        gone_ = true;
        changed_.notify_all();
    }
    missing_ = received_ < published_ ? missing_ + passed : 0;
    if (missing_ >= lease_ / 2) {
        missing_ = 0;
        post_.send(0, message(Word::Missing, static_cast<int32_t>(received_)));
    }
    sinceBeat_ += passed;
    if (sinceBeat_ >= lease_ / kBeats) {
        sinceBeat_ = 0;
        post_.send(0, message(Word::Beat));
    }
}

}  // namespace glint::farm

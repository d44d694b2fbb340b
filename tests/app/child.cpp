#include "child.h"

#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <stdexcept>

#include "core/image_io.h"
#include "core/stopwatch.h"

namespace glint::app::test {

namespace {

// Seconds; other programs may keep the machine busy, and where GPU-assisted validation adds to kernels
// compiling them takes a minute.
constexpr double kPatience = 240;

// Reads what is there; closes and forgets a descriptor at its end. A terminal whose other side is closed
// gives EIO.
void drain(int& fd, std::string& text) {
    char buffer[4096];
    const ssize_t count = ::read(fd, buffer, sizeof(buffer));
    if (count > 0) {
        text.append(buffer, static_cast<size_t>(count));
    } else {
        ::close(fd);
        fd = -1;
    }
}

}  // namespace

Child::Child(Words args, const Environment& environment, bool terminal) {
    std::vector<char*> argv = {const_cast<char*>(GLINT_PROGRAM)};
    for (std::string& arg : args) argv.push_back(arg.data());
    argv.push_back(nullptr);
    int out[2] = {-1, -1}, err[2] = {-1, -1};
    if (terminal) {
        pid_ = forkpty(&errFd_, nullptr, nullptr, nullptr);
    } else {
        if (pipe(out) != 0 || pipe(err) != 0) throw std::runtime_error("pipe");
        pid_ = fork();
    }
    if (pid_ < 0) throw std::runtime_error("fork");
    if (pid_ == 0) {
        if (!terminal) {
            dup2(out[1], STDOUT_FILENO);
            dup2(err[1], STDERR_FILENO);
            for (const int fd : {out[0], out[1], err[0], err[1]}) ::close(fd);
        }
        // CTest runs in the background of some shells, which then have the child ignore Ctrl-C.
        signal(SIGINT, SIG_DFL);
        signal(SIGTERM, SIG_DFL);
        for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
        execv(GLINT_PROGRAM, argv.data());
        _exit(127);
    }
    if (terminal) return;
    ::close(out[1]);
    ::close(err[1]);
    outFd_ = out[0];
    errFd_ = err[0];
}

Child::~Child() {
    if (pid_ > 0) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    for (const int fd : {outFd_, errFd_}) {
        if (fd >= 0) ::close(fd);
    }
}

bool Child::read(int milliseconds) {
    pollfd files[] = {{outFd_, POLLIN, 0}, {errFd_, POLLIN, 0}};  // poll leaves out negative ones
    if (outFd_ < 0 && errFd_ < 0) return false;
    if (poll(files, 2, milliseconds) > 0) {
        if (outFd_ >= 0 && files[0].revents != 0) drain(outFd_, out_);
        if (errFd_ >= 0 && files[1].revents != 0) drain(errFd_, err_);
    }
    return true;
}

bool Child::waitForPercent(int percent, const std::string& label) {
    static const std::regex kPercent("([0-9]+) %");
    const Stopwatch watch;
    do {
        const std::string text = err_.substr(std::min(err_.find(label), err_.size()));
        for (std::sregex_iterator match(text.begin(), text.end(), kPercent), end; match != end; ++match)
            if (std::stoi((*match)[1]) >= percent) return true;
    } while (read(100) && watch.seconds() < kPatience);
    return false;
}

bool Child::waitForWork(double seconds) {
    const Stopwatch watch;
    const double ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
    while (read(20) && watch.seconds() < kPatience) {
        // proc(5): after the name in parentheses, the 12th and 13th fields are the ticks in user and kernel
        // mode.
        std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
        std::string text;
        std::getline(file, text, ')');
        for (int field = 0; field < 11; ++field) file >> text;
        double user = 0, kernel = 0;
        file >> user >> kernel;
        if (file && (user + kernel) / ticks >= seconds) return true;
    }
    return false;
}

bool Child::waitForHandler(int signal) {
    const Stopwatch watch;
    while (read(20) && watch.seconds() < kPatience) {
        std::ifstream file("/proc/" + std::to_string(pid_) + "/status");
        for (std::string line; std::getline(file, line);)
            if (line.starts_with("SigCgt:") &&
                (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) == 1)
                return true;
    }
    return false;
}

void Child::send(int signal) const {
    if (pid_ > 0) kill(pid_, signal);  // -1 would be everybody
}

void Child::type(const std::string& keys) const {
    if (::write(errFd_, keys.data(), keys.size()) < 0) throw std::runtime_error("write to the terminal");
}

int Child::wait() {
    const Stopwatch watch;
    while (read(100)) {
        if (watch.seconds() > kPatience) return -1;
    }
    int status = 0;
    if (waitpid(pid_, &status, 0) != pid_) return -1;
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void ChildTest::expectFinishedPart(Child& child, int signal, int width, int height) const {
    child.send(signal);
    EXPECT_EQ(child.wait(), 130);
    EXPECT_HAS(child.err(), "glint: interrupted: out.png holds the ");
    EXPECT_STARTS(child.out(), "wrote out.png");
    EXPECT_LACKS(child.out(), "%");
    const Image image = readImage("out.png");
    ASSERT_EQ(std::pair(image.width, image.height), std::pair(width, height));
    // The sky above and below the objects is bright: a row is black if and only if it was not reached.
    EXPECT_GT(image.at(0, 0, 2), 0.5f);
    EXPECT_EQ(image.at(width - 1, height - 1, 2), 0.0f);
    EXPECT_EQ(names(), (std::set<std::string>{"a.json", "out.png"}));
}

void ChildTest::expectNothingWritten(Child& child, int signal) const {
    child.send(signal);
    EXPECT_EQ(child.wait(), 130);
    EXPECT_ENDS(child.err(),
                "glint: interrupted before any part of the image was finished; nothing written\n");
    EXPECT_EQ(child.out(), "");
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

}  // namespace glint::app::test

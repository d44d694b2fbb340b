// The program as a child process.
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

#include "support.h"

namespace glint::app::test {

class Child {
  public:
    using Environment = std::vector<std::pair<std::string, std::string>>;

    // Starts glint with its output in pipes or, with `terminal`, on a pseudo-terminal (all of it then is
    // err()).
    explicit Child(Words args, const Environment& environment = {}, bool terminal = false);
    ~Child();  // kills what still runs
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    // Until standard error holds a percentage of at least `percent` ("render   7 %") after `label`. False if
    // the child ends first, or after a minute.
    bool waitForPercent(int percent, const std::string& label = "");
    // Until the child has used so much processor time. False if it ends first, or after a minute.
    bool waitForWork(double seconds);
    // Until the child handles the signal. False if it ends first, or after a minute.
    bool waitForHandler(int signal);

    void send(int signal) const;
    void type(const std::string& keys) const;  // on the terminal

    // Waits for the end, up to a minute; the exit code, or -1 if there is none.
    int wait();

    const std::string& out() const { return out_; }
    const std::string& err() const { return err_; }

  private:
    bool read(int milliseconds);  // what has come on the pipes; false once both are closed

    pid_t pid_ = -1;
    int outFd_ = -1, errFd_ = -1;
    std::string out_, err_;
};

class ChildTest : public SmallSceneTest {
  protected:
    // Interrupts a child that renders out.png: the file must hold the upper rows alone.
    void expectFinishedPart(Child& child, int signal, int width, int height) const;
    // Interrupts a child that has not finished a pixel: it must not write a file.
    void expectNothingWritten(Child& child, int signal) const;
};

}  // namespace glint::app::test

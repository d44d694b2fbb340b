// A file of the units that an unfinished picture has so far.
#pragma once

#include <filesystem>
#include <functional>

#include "farm/unit_file.h"

namespace glint::farm {

class Checkpoint {
  public:
    // Opens the file, or makes it with the header, and calls `found` with what an earlier run finished: each
    // unit once, one at a time in memory, in the order in which they were appended. What stands behind the
    // last whole unit, because a process ended while it wrote, is cut off. Throws Error(Failed) for a file
    // that is damaged, is a checkpoint of another render (states the difference), cannot be written, or is in
    // use by another process.
    Checkpoint(const std::filesystem::path& path, const UnitHeader& header,
               const std::function<void(const UnitResult&)>& found);
    ~Checkpoint();
    Checkpoint(const Checkpoint&) = delete;
    Checkpoint& operator=(const Checkpoint&) = delete;

    // The unit is on the disk when this returns. Throws Error(Failed) if it cannot be written, where the
    // units before it stay, or if the name has come to stand for another file.
    void append(const UnitResult& result);

    // Once the picture is written. Keeps a file of that name that another process has made.
    void remove();

  private:
    void write(const std::vector<uint8_t>& bytes);

    std::filesystem::path path_;
    int file_ = -1;
    uint64_t size_ = 0;
};

}  // namespace glint::farm

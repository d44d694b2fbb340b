// The scenes that windows have shown, remembered from one to the next.
#pragma once

#include <filesystem>
#include <vector>

namespace glint::view {

class RecentFiles {
  public:
    // `file` holds the list, a path a line; empty: nothing is remembered. That it cannot be read or written
    // is no error.
    explicit RecentFiles(std::filesystem::path file = {});

    // Absolute paths, the latest first, each once; files that are gone are left out.
    const std::vector<std::filesystem::path>& list() const { return list_; }
    // Puts it first and writes the list, with what other windows have added meanwhile.
    void add(const std::filesystem::path& scene);

    static constexpr size_t kMost = 12;

  private:
    void read();

    std::filesystem::path file_;
    std::vector<std::filesystem::path> list_;
};

}  // namespace glint::view

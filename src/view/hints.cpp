#include "view/hints.h"

#include <algorithm>
#include <sstream>

#include "view/state_folder.h"

namespace glint::view {

Hints::Hints(std::filesystem::path file) : file_(std::move(file)) {
    std::istringstream words(readState(file_));
    for (std::string word; words >> word;)
        if (const auto hint = named<Hint>(word)) done_[static_cast<size_t>(*hint)] = true;
}

bool Hints::any() const {
    return std::find(done_.begin(), done_.end(), false) != done_.end();
}

bool Hints::done(Hint hint) {
    if (!wanted(hint)) return false;
    done_[static_cast<size_t>(hint)] = true;
    remember();
    return !any();
}

void Hints::close() {
    done_.fill(true);
    remember();
}

void Hints::remember() const {
    std::string text;
    for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
        if (!wanted(entry.value)) text += std::string(entry.name) + '\n';
    writeState(file_, text);
}

}  // namespace glint::view

#include <filesystem>
#include <memory>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/exit_code.h"
#include "app/output_check.h"
#include "app/pages.h"
#include "core/error.h"
#include "core/file_io.h"

namespace glint::app {

namespace {

std::vector<Page> allPages() {
    const std::vector<CommandFacts> facts = commandFacts();
    std::vector<Page> pages = manPages(facts);
    // Folders below /usr/share that each shell reads; bash and fish also read them below ~/.local/share.
    pages.push_back({"bash-completion/completions/glint", bashCompletion(facts)});
    pages.push_back({"zsh/vendor-completions/_glint", zshCompletion(facts)});
    pages.push_back({"fish/vendor_completions.d/glint.fish", fishCompletion(facts)});
    return pages;
}

int writePages(const std::filesystem::path& folder, std::ostream& out) {
    checkOutputFolder(folder);
    std::vector<OutputFile> files;
    for (const Page& page : allPages()) {
        files.push_back({folder / page.path, {page.text.begin(), page.text.end()}});
        const std::filesystem::path parent = files.back().path.parent_path();
        std::error_code failed;
        std::filesystem::create_directories(parent, failed);
        if (failed)
            throw Error(ErrorKind::Failed, parent.string() + ": cannot make the folder: " + failed.message());
    }
    writeFiles(files);
    for (const OutputFile& file : files) out << "wrote " << shown(file.path) << '\n';
    return static_cast<int>(ExitCode::Done);
}

}  // namespace

Run pagesCommand(OptionTable& table) {
    const auto folder = std::make_shared<std::filesystem::path>();
    table.path("FOLDER", "", "where man/, bash-completion/, zsh/ and fish/ go, such as ~/.local/share",
               "the folder's name", *folder, OptionTable::Need::Required);
    return [folder](std::ostream& out, std::ostream&) { return writePages(*folder, out); };
}

}  // namespace glint::app

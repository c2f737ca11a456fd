// photonlab new: a folder with a scene, an experiment on it, and a page of five commands.

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands/commands.h"
#include "app/installed.h"
#include "core/error.h"
#include "core/files/files.h"
#include "core/text/messages.h"

namespace photonlab {

namespace {

constexpr std::string_view program_word = "@photonlab@";  // in the page, for how this program is called

/// The first program of this name on the PATH; empty for none.
std::filesystem::path on_path(const std::string& name) {
    const char* path = std::getenv("PATH");
    for (std::string rest = path ? path : ""; !rest.empty();) {
        const std::size_t colon = rest.find(':');
        const std::filesystem::path file = std::filesystem::path(rest.substr(0, colon)) / name;
        if (::access(file.c_str(), X_OK) == 0) return file;
        rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
    }
    return {};
}

/// What to type for this program: its name where that finds it, else its file.
std::string typed_program() {
    const std::filesystem::path file = program_file();
    std::error_code none;
    if (std::filesystem::equivalent(on_path("photonlab"), file, none)) return "photonlab";
    std::string quoted = file.string();
    if (quoted.find_first_of(" \t'\"$&()<>|;*?#~\\`") == std::string::npos) return quoted;
    for (std::size_t at = 0; (at = quoted.find('\'', at)) != std::string::npos; at += 4) quoted.replace(at, 1, "'\\''");
    return "'" + quoted + "'";
}

std::string with_program(std::string page) {
    const std::string program = typed_program();
    for (std::size_t at = 0; (at = page.find(program_word, at)) != std::string::npos; at += program.size())
        page.replace(at, program_word.size(), program);
    return page;
}

/// Written beside its name and renamed, so that it is whole or not there.
void make_study(std::filesystem::path folder) {
    folder = folder.lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();  // of a name that ends in /
    if (is_there(folder)) throw InputError(folder.string(), "is there already; expected the name of a folder to make");
    if (folder.has_parent_path()) make_folder(folder.parent_path());
    const std::filesystem::path temporary = folder.string() + fmt::format(".new-{}", ::getpid());
    try {
        make_folder(temporary);
        for (const std::filesystem::path& file : entries_of(installed_folder("study")))
            write_text_file(temporary / file.filename(), with_program(read_text_file(file)));
        std::filesystem::rename(temporary, folder);
    } catch (...) {
        remove_if_there(temporary);
        throw;
    }
    print_output("wrote       {}: a scene, an experiment, and in README.md the five commands to an answer\n",
                 folder.string());
}

}  // namespace

void add_new_command(CLI::App& app) {
    auto folder = std::make_shared<std::filesystem::path>();
    CLI::App* command = app.add_subcommand("new", "Begin a study: a scene, an experiment, and a page of five commands");
    command->add_option("FOLDER", *folder, "folder to make")->required();
    command->footer("Example:\n  photonlab new glass && cat glass/README.md");
    command->callback([folder] { make_study(*folder); });
}

}  // namespace photonlab
